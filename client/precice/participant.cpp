// SPDX-License-Identifier: Apache-2.0
// Calls of precice::Participant. Each checks its arguments and reports errors by its name.
#include <cmath>

#include "checks.hpp"

namespace precice {

using namespace couplet::dropin;

std::string getVersionInformation() {
  return std::string(PRECICE_VERSION) + ";Couplet's library on preCICE's interface (docs/precice.md)";
}

Participant::Participant(string_view name, string_view file, int rank, int size) {
  construct(name, file, rank, size, nullptr);
}

Participant::Participant(string_view name, string_view file, int rank, int size, void* communicator) {
  if (communicator == nullptr)
    throw Error("The communicator given for the participant \"" + name.str() + "\" is null.");
  construct(name, file, rank, size, communicator);
}

void Participant::construct(string_view name, string_view file, int rank, int size, void* communicator) {
  try {
    if (rank < 0 || size < 1 || rank >= size)
      throw Error("The process index is " + std::to_string(rank) + " and the number of processes " +
                  std::to_string(size) + ": the index must be from 0 to below the number.");
    session_ = std::make_unique<Session>(read_configuration(file.str(), name.str()), rank, size,
                                         static_cast<const MPI_Comm*>(communicator));
  } catch (const Error& error) {
    std::fprintf(stderr, "preCICE interface of Couplet: ERROR: %s\n", error.what());
    throw;
  }
}

Participant::~Participant() = default;

void Participant::initialize() {
  Session& s = *session_;
  check(s, !s.finalised, "initialize() cannot be called after finalize().");
  check(s, !s.initialised, "initialize() may only be called once.");
  check(s, s.profiling_sections == 0,
        "initialize() cannot be called before all profiling sections are stopped.");
  if (s.initial_data_due)
    fail(s,
         "Initial data has to be written before initialize(): requiresInitialData() was not called, but the "
         "configuration has an exchange with initialize=\"true\" from \"" +
             s.configuration.participant + "\".");
  s.begin();
}

void Participant::advance(double dt) {
  Session& s = *session_;
  check(s, s.initialised, "initialize() has to be called before advance().");
  check(s, !s.finalised, "advance() cannot be called after finalize().");
  check(s, s.ongoing, "advance() cannot be called when isCouplingOngoing() returns false.");
  check(s, s.profiling_sections == 0,
        "advance() cannot be called before all profiling sections are stopped.");
  if (!std::isfinite(dt) || dt <= 0)
    fail(s, "advance() cannot be called with a time step size of " + text(dt) + ": it must be positive.");
  if (dt > s.remaining() + 1e-12 * s.window)
    fail(s, "The time step size given to advance(), " + text(dt) +
                ", exceeds the maximum allowed time step size " + text(s.remaining()) +
                " in the remainder of this time window. Call getMaxTimeStepSize() before each step.");
  check(
      s, !s.writing_due,
      "A checkpoint must be written before advance(): requiresWritingCheckpoint() was not called, which implicit "
      "coupling needs.");
  check(
      s, !s.reading_due,
      "A checkpoint must be read before advance(): requiresReadingCheckpoint() was not called, which implicit "
      "coupling needs.");
  s.go_on(dt);
}

void Participant::finalize() {
  Session& s = *session_;
  check(s, !s.finalised, "finalize() may only be called once.");
  s.leave();
}

int Participant::getMeshDimensions(string_view mesh) const { return known_mesh(*session_, mesh).dimensions; }

int Participant::getDataDimensions(string_view mesh, string_view data) const {
  const Session& s = *session_;
  const Configuration::Mesh& m = known_mesh(s, mesh);
  const auto* found = s.configuration.find(m.name, data.str(), true);
  if (!found) found = s.configuration.find(m.name, data.str(), false);
  if (!found) fail(s, unknown_data(s, m.name, data.str()));
  return int(s.components(*found));
}

bool Participant::isCouplingOngoing() const {
  const Session& s = *session_;
  check(s, s.initialised, "initialize() has to be called before isCouplingOngoing().");
  check(s, !s.finalised, "isCouplingOngoing() cannot be called after finalize().");
  return s.ongoing;
}

bool Participant::isTimeWindowComplete() const {
  const Session& s = *session_;
  check(s, s.initialised, "initialize() has to be called before isTimeWindowComplete().");
  check(s, !s.finalised, "isTimeWindowComplete() cannot be called after finalize().");
  return s.window_complete;
}

double Participant::getMaxTimeStepSize() const {
  const Session& s = *session_;
  check(s, s.initialised, "initialize() has to be called before getMaxTimeStepSize().");
  check(s, !s.finalised, "getMaxTimeStepSize() cannot be called after finalize().");
  return s.remaining();
}

bool Participant::requiresInitialData() {
  Session& s = *session_;
  check(s, !s.initialised, "requiresInitialData() has to be called before initialize().");
  s.initial_data_due = false;
  return s.configuration.writes_initial_data();
}

bool Participant::requiresWritingCheckpoint() {
  Session& s = *session_;
  check(s, s.initialised, "initialize() has to be called before requiresWritingCheckpoint().");
  return std::exchange(s.writing_due, false);
}

bool Participant::requiresReadingCheckpoint() {
  Session& s = *session_;
  check(s, s.initialised, "initialize() has to be called before requiresReadingCheckpoint().");
  return std::exchange(s.reading_due, false);
}

void Participant::writeData(string_view mesh, string_view data, span<const VertexID> ids,
                            span<const double> values) {
  Session& s = *session_;
  check(s, !s.finalised, "writeData(...) cannot be called after finalize().");
  check(s, !s.initialised || s.ongoing,
        "writeData(...) cannot be called when isCouplingOngoing() returns false.");
  const Configuration::Data& d = used_data(s, mesh, data, true);
  check_values(s, "writeData", d, ids, values.size());
  const std::size_t n = s.components(d);
  std::vector<double>& to = s.written[std::size_t(&d - s.configuration.data.data())];
  if (!s.initialised) to.resize(n * std::size_t(s.mesh(d.mesh)->vertices()));
  double zero = 0;
  for (const double value : values) zero += 0 * value;
  if (zero != 0) fail(s, "writeData(...) was given a value of \"" + d.name + "\" that is not finite.");
  for (std::size_t i = 0; i < ids.size(); ++i)
    for (std::size_t k = 0; k < n; ++k) to[n * std::size_t(ids[i]) + k] = values[n * i + k];
}

void Participant::readData(string_view mesh, string_view data, span<const VertexID> ids, double time,
                           span<double> values) const {
  const Session& s = *session_;
  check(s, s.initialised, "readData(...) cannot be called before initialize().");
  check(s, !s.finalised, "readData(...) cannot be called after finalize().");
  if (!(time >= 0))
    fail(s, "readData(...) was given the relative read time " + text(time) + ", which is negative.");
  if (time > s.remaining() + 1e-12 * s.window)
    fail(s, "readData(...) was given the relative read time " + text(time) +
                ", which is after the end of the time window (" + text(s.remaining()) + ").");
  check(s, s.ongoing || time == 0,
        "After the end of the coupling readData(...) can only read at relative time 0.");
  const Configuration::Data& d = used_data(s, mesh, data, false);
  check_values(s, "readData", d, ids, values.size());
  const Sample* sample = s.sample(d);
  const std::size_t n = s.components(d), first = n * s.first_vertex(d.mesh);
  if (sample == nullptr) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0;
    return;
  }
  bool one = true;  // the first one replaces the previous values
  for (const auto& [weight, from] : s.at_time(*sample, s.at + time)) {
    for (std::size_t i = 0; i < ids.size(); ++i)
      for (std::size_t k = 0; k < n; ++k) {
        const double part = weight * from[first + n * std::size_t(ids[i]) + k];
        values[n * i + k] = one ? part : values[n * i + k] + part;
      }
    one = false;
  }
}

}  // namespace precice
