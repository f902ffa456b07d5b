// SPDX-License-Identifier: Apache-2.0
// A whole structure in a page: masses on springs along a line, m dv/dt + k y = F each, by the trapezoidal
// rule.
#pragma once

#include "common/app/program.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::toy {

struct SpringParameters {
  int vertices = 2;
  double mass = 1, stiffness = 0;  // of each vertex [kg], [N/m]
};

inline void declare(config::Section& s, SpringParameters& p) {
  s.value("vertices", p.vertices).range(2, 1000).doc("masses along the interface, which is 1 m long");
  s.value("mass", p.mass).unit("kg").positive().required().doc("of each");
  s.value("stiffness", p.stiffness).unit("N/m").not_negative().doc("of the spring that holds each");
}

class Spring final : public coupling::Participant {
 public:
  Spring(MPI_Comm comm, const SpringParameters& p) : comm_(comm), p_(p), now_(2 * p.vertices), next_(now_) {}

  coupling::Interface initialise() override {
    const std::vector<coupling::Interface::Datum> motion{
        {"displacement", "m", coupling::Interface::Place::vertices},
        {"velocity", "m/s", coupling::Interface::Place::vertices}};
    coupling::Interface line{2,     {}, {}, {}, {{"pressure-force", "N", coupling::Interface::Place::faces}},
                             motion};
    for (int i = 0; parallel::comm_rank(comm_) == 0 && i < p_.vertices; ++i) {
      const double h = 1. / (p_.vertices - 1);
      line.vertices.emplace_back(i * h, 0, 0);
      if (i > 0) line.face_centres.emplace_back((i - 0.5) * h, 0, 0), line.face_areas.emplace_back(0, h, 0);
      if (i > 0) line.face_vertices.insert(line.face_vertices.end(), {i - 1, i});
      line.face_offset.push_back(2 * i);
    }
    return line;
  }
  void begin_step(const coupling::Step& step) override { dt_ = step.dt; }
  coupling::Exchange solve(const coupling::Exchange& in) override {
    std::vector<double> force(2 * (p_.vertices - 1));  // on rank 0 only, zero without a partner
    if (in.contains("pressure-force")) force = in.at("pressure-force");
    MPI_Bcast(force.data(), int(force.size()), MPI_DOUBLE, 0, comm_);
    std::vector<double> mine;  // (y, v) of this rank's vertices at t^{n+1}
    const int rank = parallel::comm_rank(comm_), ranks = parallel::comm_size(comm_);
    for (int i = p_.vertices * rank / ranks; i < p_.vertices * (rank + 1) / ranks; ++i) {
      const double f = ((i > 0 ? force[2 * i - 1] : 0) + (i + 1 < p_.vertices ? force[2 * i + 1] : 0)) / 2;
      const double y = now_[2 * i], v = now_[2 * i + 1], m = p_.mass, k = p_.stiffness;
      const double v_new = (m / dt_ * v - k * (y + dt_ / 4 * v) + f) / (m / dt_ + k * dt_ / 4);
      mine.insert(mine.end(), {y + dt_ / 2 * (v + v_new), v_new});
    }
    next_ = parallel::all_gather(comm_, mine);
    coupling::Exchange out;
    for (int i = 0; rank == 0 && i < p_.vertices; ++i) {
      out["displacement"].insert(out["displacement"].end(), {0, next_[2 * i]});
      out["velocity"].insert(out["velocity"].end(), {0, next_[2 * i + 1]});
    }
    return out;
  }
  coupling::StepReport accept_step() override {
    now_ = next_;
    return {.dt = dt_};
  }
  void save(io::CheckpointWriter& file) const override { file.write_common("state", now_); }
  void load(io::CheckpointReader& file) override { file.read_common("state", now_); }
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 private:
  MPI_Comm comm_;
  SpringParameters p_;
  double dt_ = 0;
  std::vector<double> now_, next_;  // (y, v) of every vertex at t^n and t^{n+1}
};

}  // namespace couplet::toy
