// SPDX-License-Identifier: Apache-2.0
#include "session.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "couplet_precice.h"

namespace couplet::dropin {

void end_the_job(const std::string& text) {
  std::fprintf(stderr, "preCICE interface of Couplet: ERROR: %s\n", text.c_str());
  std::fflush(nullptr);
  int up = 0, down = 0;
  MPI_Initialized(&up);
  MPI_Finalized(&down);
  if (up && !down) MPI_Abort(MPI_COMM_WORLD, 1);
  std::_Exit(1);
}

couplet_client* joined(const std::string& participant, const MPI_Comm* processes) {
  static std::pair<std::string, couplet_client*> one;
  if (one.second == nullptr)
    one = {participant, couplet_join_with(participant.c_str(), "precice",
                                          processes == nullptr ? MPI_COMM_WORLD : *processes)};
  if (one.first != participant)
    end_the_job("This process is \"" + one.first + "\" and cannot be \"" + participant +
                "\" too: start a process for each participant.");
  return one.second;
}

}  // namespace couplet::dropin

extern "C" MPI_Comm couplet_precice_comm(const char* participant) {
  return couplet_comm(couplet::dropin::joined(participant, nullptr));
}

namespace couplet::dropin {

namespace {

/// Participant of this process.
std::string& taken() {
  static std::string name;
  return name;
}

int size_of(MPI_Comm comm) {
  int size = 0;
  MPI_Comm_size(comm, &size);
  return size;
}

/// Number of processes of the whole job; 0 after MPI_Finalize.
int all_processes() {
  int up = 0, down = 0;
  MPI_Initialized(&up);
  MPI_Finalized(&down);
  if (down) return 0;
  if (!up) MPI_Init(nullptr, nullptr);
  const int all = size_of(MPI_COMM_WORLD);
  if (!up) MPI_Finalize();
  return all;
}

}  // namespace

Session::Session(Configuration c, int rank, int size, const MPI_Comm* processes)
    : configuration(std::move(c)), rank_(rank), size_(size) {
  if (!taken().empty())
    throw ::precice::Error("The participant \"" + configuration.participant +
                           "\" cannot be constructed: this process has been \"" + taken() +
                           "\", and a process takes part once. Start a process for each participant.");
  int up = 0;
  MPI_Initialized(&up);
  if (processes != nullptr) processes_ = *processes;
  const int known = processes != nullptr ? size_of(*processes) : up ? size_of(MPI_COMM_WORLD) : size;
  if (processes != nullptr ? size != known : size > known)
    throw ::precice::Error("The participant \"" + configuration.participant + "\" was constructed with " +
                           std::to_string(size) + " processes, but its communicator has " +
                           std::to_string(known) + ".");
  taken() = configuration.participant;
  for (const Configuration::Mesh& m : configuration.meshes)
    if (m.provided) meshes.push_back({m.name, m.dimensions, {}, {}});
  initial_data_due = configuration.writes_initial_data();
  written.resize(configuration.data.size());
}

Session::~Session() {
  if (!finalised && (!initialised || ongoing) && std::uncaught_exceptions() > 0)
    end_the_job("The participant \"" + configuration.participant + "\" ended before the coupling was over." +
                (last_error.empty() ? "" : " Before that: " + last_error));
  if (!finalised) leave();
  if (job == nullptr) taken().clear();
}

void Session::join() {
  job = joined(configuration.participant, processes_ ? &*processes_ : nullptr);
  int its_rank = 0;
  MPI_Comm_rank(couplet_comm(job), &its_rank);
  const int its_size = size_of(couplet_comm(job));
  if (rank_ != its_rank || size_ != its_size)
    end_the_job("The participant \"" + configuration.participant + "\" was constructed as process " +
                std::to_string(rank_) + " of " + std::to_string(size_) + ", but is process " +
                std::to_string(its_rank) + " of " + std::to_string(its_size) +
                " of its participant: MPI_COMM_WORLD holds all programs of the job. Take rank and size from "
                "couplet_precice_comm(\"" +
                configuration.participant + "\") of couplet_precice.h.");
}

void Session::leave() {
  finalised = true;
  const std::string why = "The participant \"" + configuration.participant + "\" ended before ";
  if (job == nullptr) {  // a coupler would wait for it
    if (all_processes() > size_) end_the_job(why + "initialize(): the job cannot start without it.");
    return;
  }
  if (ongoing) {
    couplet_quit(job, (why + "the coupling was over.").c_str());
    while (couplet_next(job) != COUPLET_END) {
    }
  }
  couplet_leave(job);
}

Mesh* Session::mesh(const std::string& name) {
  const auto found =
      std::find_if(meshes.begin(), meshes.end(), [&](const Mesh& m) { return m.name == name; });
  return found == meshes.end() ? nullptr : &*found;
}

std::size_t Session::first_vertex(const std::string& name) const {
  std::size_t first = 0;
  for (const Mesh& m : meshes) {
    if (m.name == name) break;
    first += std::size_t(m.vertices());
  }
  return first;
}

std::size_t Session::components(const Configuration::Data& d) const {
  return d.vector ? std::size_t(configuration.mesh(d.mesh)->dimensions) : 1;
}

const Sample* Session::sample(const Configuration::Data& d) const {
  for (std::size_t w = 0; w < configuration.wires.size(); ++w)
    if (!configuration.wires[w].given && &configuration.data[configuration.wires[w].data] == &d)
      return &samples_[w];
  return nullptr;
}

/// Unit of a datum for the mapping. Only sums of forces and heats are conserved.
static const char* unit_of(const Configuration::Wire& w, const Configuration::Data& d) {
  return !w.conservative ? "1" : d.vector ? "N" : "W";
}

/// Describes all meshes, concatenated, as one surface.
void Session::describe() {
  std::vector<double> xyz, centres, areas;
  std::vector<std::int64_t> first{0}, corners;
  long long mine = 0, before = 0;
  for (const Mesh& m : meshes) mine += m.vertices();
  MPI_Exscan(&mine, &before, 1, MPI_LONG_LONG, MPI_SUM, couplet_comm(job));
  for (const Mesh& m : meshes) {
    const auto offset = before + std::int64_t(xyz.size() / 3);
    for (std::size_t f = 0; f < m.faces.size(); ++f) {
      const auto c = m.centre(f), a = m.area(f);
      centres.insert(centres.end(), c.begin(), c.end());
      areas.insert(areas.end(), a.begin(), a.end());
      for (const std::int64_t v : m.faces[f]) corners.push_back(offset + v);
      first.push_back(std::int64_t(corners.size()));
    }
    xyz.insert(xyz.end(), m.xyz.begin(), m.xyz.end());
  }
  couplet_introduce(job, configuration.introduction.c_str());
  couplet_vertices(job, meshes.front().dimensions, int(xyz.size() / 3), xyz.data());
  if (meshes.size() > 1) {
    std::vector<int> surface;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      surface.insert(surface.end(), std::size_t(meshes[i].vertices()), int(i));
    couplet_surfaces(job, surface.data());
  }
  couplet_faces(job, int(centres.size() / 3), centres.data(), areas.data(), first.data(), corners.data());
  for (const Configuration::Wire& w : configuration.wires) {
    const Configuration::Data& d = configuration.data[w.data];
    const auto own = std::size_t(mesh(d.mesh) - meshes.data());
    const auto place = meshes.size() > 1 ? couplet_place(COUPLET_SURFACE + own) : COUPLET_VERTICES;
    (w.given ? couplet_gives : couplet_takes)(job, w.name.c_str(), unit_of(w, d), place, d.vector ? 0 : 1);
    if (!w.given && w.within) couplet_takes_within(job, w.name.c_str());
  }
}

std::vector<double> Session::surface_of(std::size_t datum, const std::vector<double>& values) const {
  const Configuration::Data& d = configuration.data[datum];
  std::size_t all = 0;
  for (const Mesh& m : meshes) all += std::size_t(m.vertices());
  std::vector<double> surface(components(d) * all);
  std::copy(values.begin(), values.end(),
            surface.begin() + std::ptrdiff_t(components(d) * first_vertex(d.mesh)));
  return surface;
}

/// Sends written values, or zeros. With `initial` (before the first step), only initialized ones.
void Session::hand_over(bool initial) {
  for (const Configuration::Wire& w : configuration.wires) {
    if (!w.given) continue;
    const bool nothing = initial && !w.initialised;
    couplet_write(job, w.name.c_str(),
                  surface_of(w.data, nothing ? std::vector<double>{} : written[w.data]).data());
    if (w.within && !initial)
      for (const auto& [share, then] : sub_steps_)
        couplet_write_within(job, w.name.c_str(), share, surface_of(w.data, then[w.data]).data());
  }
  sub_steps_.clear();
}

void Session::keep_sub_step() {
  for (const Configuration::Wire& w : configuration.wires)
    if (w.given && w.within) {
      sub_steps_.emplace_back(at / window, written);
      return;
    }
}

void Session::begin() {
  join();
  describe();
  samples_.resize(configuration.wires.size());
  std::size_t all = 0;
  for (const Mesh& m : meshes) all += std::size_t(m.vertices());
  const std::vector<double> ends{0, 1};
  for (std::size_t w = 0; w < samples_.size(); ++w) {
    samples_[w].shares = ends;
    samples_[w].waveform.emplace(ends, configuration.wires[w].degree);
    samples_[w].start.assign(all * components(configuration.data[configuration.wires[w].data]), 0);
  }
  for (Sample& s : samples_) s.end = s.start;
  for (std::size_t i = 0; i < written.size(); ++i) {
    const Configuration::Data& d = configuration.data[i];
    written[i].resize(components(d) * std::size_t(mesh(d.mesh)->vertices()));
  }
  hand_over(true);
  bool accepted = false;
  initialised = true;
  ongoing = wait_for_window(accepted);
  if (ongoing) take(true);
  writing_due = ongoing && configuration.implicit;
  for (auto& values : written) std::fill(values.begin(), values.end(), 0.);
}

bool Session::wait_for_window(bool& accepted) {
  for (;;) switch (couplet_next(job)) {
      case COUPLET_SOLVE:
        window = couplet_dt(job);
        at = 0;
        return true;
      case COUPLET_END:
        return false;
      case COUPLET_START:
        for (std::size_t w = 0; w < samples_.size(); ++w)
          if (const auto& wire = configuration.wires[w]; !wire.given)
            if (const double* values = couplet_read(job, wire.name.c_str()))
              std::copy_n(values, samples_[w].end.size(), samples_[w].end.begin());
        break;
      case COUPLET_ACCEPT:
        accepted = true;
        break;
      case COUPLET_LOAD:
        end_the_job(
            "The participant \"" + configuration.participant +
            "\" cannot continue from a checkpoint: a program on preCICE's interface has no file of its state.");
      default:
        break;  // a step begins; the program handles outputs and checkpoints by itself
    }
}

void Session::take(bool new_window) {
  for (std::size_t w = 0; w < samples_.size(); ++w) {
    const Configuration::Wire& wire = configuration.wires[w];
    if (wire.given) continue;
    Sample& s = samples_[w];
    if (new_window) s.start = s.end;
    if (const double* values = couplet_read(job, wire.name.c_str()))
      std::copy_n(values, s.end.size(), s.end.begin());
    else if (ongoing)
      std::fill(s.end.begin(), s.end.end(), 0.);
    // The first pass uses the value at the start of the window for data that are iterated on.
    const bool constant = ongoing && (wire.held || (wire.iterated && new_window));
    if (constant) s.start = s.end;
    if (wire.within) take_within(wire, s, constant);
  }
}

void Session::take_within(const Configuration::Wire& wire, Sample& s, bool constant) {
  const int n = constant ? 0 : couplet_within(job, wire.name.c_str());
  std::vector<double> shares(std::size_t(n) + 2, 0.);
  s.within.resize(std::size_t(n));
  for (int i = 0; i < n; ++i)
    s.within[std::size_t(i)] = couplet_read_within(job, wire.name.c_str(), i, &shares[std::size_t(i) + 1]);
  shares.back() = 1;
  if (shares == s.shares) return;
  s.waveform.emplace(shares, wire.degree);
  s.shares = std::move(shares);
}

Blend Session::at_time(const Sample& s, double reached) const {
  if (!ongoing || window - reached <= 1e-12 * window) return {{1, s.end.data()}};
  if (reached <= 0) return {{1, s.start.data()}};
  const std::vector<double> weights = s.waveform->weights(reached / window);
  Blend blend;
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (weights[i] != 0)
      blend.emplace_back(weights[i], i == 0                    ? s.start.data()
                                     : i + 1 == weights.size() ? s.end.data()
                                                               : s.within[i - 1]);
  return blend;
}

void Session::go_on(double dt) {
  at += dt;
  window_complete = writing_due = reading_due = false;
  if (window - at > 1e-12 * window) return keep_sub_step();
  hand_over(false);
  for (auto& values : written) std::fill(values.begin(), values.end(), 0.);
  bool accepted = false;
  ongoing = wait_for_window(accepted);
  if (ongoing && !accepted && !configuration.implicit)
    end_the_job("The coupler asks the participant \"" + configuration.participant +
                "\" to repeat a step of explicit coupling, which it cannot do: give it `sub-steps: {" +
                configuration.participant + ": 1}` under `coupling`.");
  // The end of the run is an exchange like the start of a window.
  take(accepted || !ongoing);
  window_complete = accepted || !ongoing;
  writing_due = ongoing && accepted && configuration.implicit;
  reading_due = ongoing && !accepted;
}

}  // namespace couplet::dropin
