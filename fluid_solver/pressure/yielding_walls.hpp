// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/pressure/opposite_faces.hpp"
#include "fluid_solver/pressure/term.hpp"

namespace couplet::fluid {

/// The interface as a Robin condition: what the structure would answer to the pressure that the equation finds, w is
/// moved off the velocity w^k that the structure gave for p_b^k. A side of its own, with its mass per area m, Z = m/dt:
///   Z (w - w^k) = p_b - p_b^k,   p_b = p_P + s - D (w - w^n),  D = rho S/(g dt),  normal to the wall
/// so that its flux S w is that of w^k and S (p_P + q)/(Z + D), q = s - D (w^k - w^n) - p_b^k [badia2008]. Where the
/// iteration stands p_b = p_b^k and w = w^k, whatever Z. Faces that lie opposite each other through a thin body, of the
/// common area S', are driven by the difference of their pressures and have both masses:
///   +- S' [(p_P + q) - (p_P + q)']/(Z + Z' + D + D')
/// which couples the cells of the two sides in the matrix, symmetric and positive as before.
template <int D>
class YieldingWalls final : public Term<D> {
 public:
  /// Collective.
  YieldingWalls(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction);

  bool sets_level() const override { return step_.yields; }
  double version() const override { return step_.yields; }
  const Couplings* couplings() const override { return &couplings_; }
  void add_to_diagonal(Diagonal& diagonal) override;
  void foresee(const State<D>& from, Projected<D>& projected) override;
  void after(Projected<D>& projected) override;

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  using Term<D>::prediction_;
  struct Side {
    double resistance = 0, pressure = 0;  // Z + D [kg/(m^2 s)], [Pa]
  };
  void set_resistances();
  void share();
  double answer_of(const OppositeFaces::Pair& pair) const;
  void add_answers(Projected<D>& projected);

  OppositeFaces opposite_;
  std::vector<double> alone_;  // area that has nothing opposite, over that of the face, per boundary face
  std::vector<Side> sides_;    // per entry of the map
  std::vector<double> flux_;   // of answers, per boundary face [m^3/s]
  Couplings couplings_;
};

}  // namespace couplet::fluid
