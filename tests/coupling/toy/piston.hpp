// SPDX-License-Identifier: Apache-2.0
// A fluid of no more than its added mass: each face pushes back with F = F_0 - m_a dw/dt, where w is the mean
// velocity of its two ends. It can be told to fail in several ways.
#pragma once

#include <limits>

#include "common/app/program.hpp"
#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/series.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::toy {

struct PistonParameters {
  int vertices = 2;
  double added_mass = 1;                                    // of each face [kg]
  double driving_force = 0;                                 // on each face [N]
  double shift = 0;                                         // of all its points [m]
  double fails_above = std::numeric_limits<double>::max();  // dt [s]
  int throws_in_step = -1;
  bool throws_at_start = false;
};

inline void declare(config::Section& s, PistonParameters& p) {
  s.value("vertices", p.vertices).range(2, 1000).doc("along the interface, which is 1 m long");
  s.value("added-mass", p.added_mass).unit("kg").not_negative().required().doc("of each face");
  s.value("driving-force", p.driving_force).unit("N").doc("on each face");
  s.value("shift", p.shift).unit("m").doc("of all its points, so that they do not match");
  s.value("fails-above", p.fails_above).unit("s").positive().doc("steps longer than this fail");
  s.value("throws-in-step", p.throws_in_step).doc("an exception leaves solve in the step of this number");
  s.value("throws-at-start", p.throws_at_start).doc("an exception leaves the set-up");
}

class Piston final : public coupling::Participant {
 public:
  Piston(const app::ParticipantContext& context, const PistonParameters& p)
      : comm_(context.comm), p_(p), now_(2 * p.vertices), next_(now_) {
    if (p.throws_at_start) throw Error("The piston was told not to start.");
    if (!context.output_folder.empty() && parallel::comm_rank(comm_) == 0)
      series_.emplace(context.output_folder / "motion.csv",
                      std::vector<std::string>{"time [s]", "velocity [m/s]"}, context.restart_time);
  }
  coupling::Interface initialise() override {
    const std::vector<coupling::Interface::Datum> motion{
        {"displacement", "m", coupling::Interface::Place::vertices},
        {"velocity", "m/s", coupling::Interface::Place::vertices}};
    coupling::Interface line{2,  {},     {},
                             {}, motion, {{"pressure-force", "N", coupling::Interface::Place::faces}}};
    const double h = 1. / (p_.vertices - 1);
    // From right to left: the mapping has something to do.
    for (int i = p_.vertices - 1; parallel::comm_rank(comm_) == 0 && i >= 0; --i) {
      line.vertices.emplace_back(i * h, p_.shift, 0);
      line.face_offset.push_back(2 * (p_.vertices - 1 - i));
      if (i == 0) continue;
      line.face_centres.emplace_back((i - 0.5) * h, p_.shift, 0);
      line.face_areas.emplace_back(0, -h, 0);
      line.face_vertices.insert(line.face_vertices.end(), {p_.vertices - 1 - i, p_.vertices - i});
    }
    return line;
  }
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::Exchange solve(const coupling::Exchange& in) override {
    if (step_.number == p_.throws_in_step) throw std::runtime_error("The piston broke, as it was told to.");
    if (step_.dt > p_.fails_above * (1 + 1e-12))
      throw SolveFailure("dt = {:g} s is above {:g} s, the largest this piston can do.", step_.dt,
                         p_.fails_above);
    next_ = now_;
    if (in.contains("velocity")) next_ = in.at("velocity");
    MPI_Bcast(next_.data(), int(next_.size()), MPI_DOUBLE, 0, comm_);
    std::vector<double> mine;
    const int faces = p_.vertices - 1, rank = parallel::comm_rank(comm_), ranks = parallel::comm_size(comm_);
    for (int f = faces * rank / ranks; f < faces * (rank + 1) / ranks; ++f) {
      const double change = (next_[2 * f + 1] + next_[2 * f + 3] - now_[2 * f + 1] - now_[2 * f + 3]) / 2;
      mine.insert(mine.end(), {0, p_.driving_force - p_.added_mass * change / step_.dt});
    }
    const std::vector<double> force = parallel::all_gather(comm_, mine);
    return rank == 0 ? coupling::Exchange{{"pressure-force", force}} : coupling::Exchange{};
  }
  coupling::StepReport accept_step() override {
    now_ = next_;
    return {.dt = step_.dt};
  }
  void save(io::CheckpointWriter& file) const override { file.write("velocity", now_); }
  void load(io::CheckpointReader& file) override { file.read("velocity", now_); }
  void write_output(double, int) override {}
  void write_monitors(double time) override {
    if (series_) series_->row(std::vector<double>{time, now_[1]});
  }

 private:
  MPI_Comm comm_;
  PistonParameters p_;
  coupling::Step step_;
  std::vector<double> now_, next_;  // velocity of every vertex (x, y) at t^n and t^{n+1}
  std::optional<io::Series> series_;
};

}  // namespace couplet::toy
