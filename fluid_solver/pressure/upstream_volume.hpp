// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/pressure/term.hpp"

namespace couplet::fluid {

/// A volume V_0 at rest behind the inlets, at one pressure: dp/dt = rho c^2 (q - q_out)/V_0, q what the inlets' velocity
/// prescribes, q_out what enters the mesh. Its pressure is that of their faces. By the same rule in time as the cells, in
/// one step with them: the answer y of the cells to its pressure, A y = G with the conductance G of its faces, gives the
/// flux before p is solved for, since A p = b + G p_0 makes G.p = y.(b + G p_0) for the symmetric matrix A.
template <int D>
class UpstreamVolume final : public Term<D> {
 public:
  UpstreamVolume(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction);

  void prepare(const State<D>& from) override;
  /// Solves for y.
  void respond(PressureEquation<D>& equation) override;
  /// No pressure at its faces as long as it is not known.
  void foresee(const State<D>& from, Projected<D>& projected) override;
  /// Its pressure, onto its faces and into b, which lacks them.
  void before(Projected<D>& projected, RightSide& side) override;
  void complete(PressureLevel<D>& level) const override;
  /// At the pressure of its faces.
  void start(const Placement<D>& at, PressureLevel<D>& level) const override;
  using Term<D>::start;
  /// y is where the next one is looked for: of the accepted level.
  void accept() override { accepted_ = response_; }
  void save(io::CheckpointWriter& file) const override {
    file.write(mesh::Entries::cells, "upstream-response", accepted_);
  }
  void load(io::CheckpointReader& file) override;

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  double begin() const;

  bool trapezoidal_;
  double stiffness_;  // rho c^2/V_0 [Pa/m^3]
  double rate_ = 0, past_ = 0, pressure_ = 0;
  std::vector<double> response_, accepted_;  // y per local cell
  double faces_ = 0, answer_ = 0;            // sum G, y.G [m]
};

}  // namespace couplet::fluid
