// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/motion/step_work.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

/// A volume V_0 at rest behind the inlets, at one pressure: dp/dt = rho c^2 (q - q_out)/V_0, q what the inlets' velocity
/// prescribes, q_out what enters the mesh. Its pressure is that of their faces. By the same rule in time as the cells, in
/// one step with them: the answer y of the cells to its pressure, A y = G with the conductance G of its faces, gives the
/// flux before p is solved for, since A p = b + G p_0 makes G.p = y.(b + G p_0) for the symmetric matrix A.
template <int D>
class UpstreamVolume {
 public:
  explicit UpstreamVolume(StepWork<D>& work);

  /// y, of a new matrix. Collective.
  void respond(PressureEquation<D>& equation);
  /// For the work's step, whose rule has the `rate`. Collective.
  void prepare(const State<D>& from, double rate);
  /// No pressure at its faces as long as it is not known.
  void foresee();
  /// Its pressure, onto its faces and into b, per owned cell, which lacks them. Gives the size of what its change
  /// puts into b. Collective.
  double add_to(std::vector<double>& b);
  /// At the pressure of its faces. Collective.
  void start(const Placement<D>& at, PressureLevel<D>& level) const;
  void complete(PressureLevel<D>& level) const;
  /// y is where the next one is looked for: of the accepted level.
  void accept() { accepted_ = response_; }
  void save(io::CheckpointWriter& file) const {
    file.write(mesh::Entries::cells, "upstream-response", accepted_);
  }
  void load(io::CheckpointReader& file);

 private:
  double begin() const;

  StepWork<D>& k_;
  bool trapezoidal_;
  double stiffness_;  // rho c^2/V_0 [Pa/m^3]
  double rate_ = 0, past_ = 0, pressure_ = 0;
  std::vector<double> response_, accepted_;  // y per local cell
  double faces_ = 0, answer_ = 0;            // sum G, y.G [m]
};

}  // namespace couplet::fluid
