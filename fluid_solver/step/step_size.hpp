// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Largest stable steps of the two treatments of the viscous term [s]; infinity for a fluid at rest without
/// viscosity.
struct StepLimits {
  double explicit_viscous = 0;
  double implicit_viscous = 0;
};

/// The cell whose limit is the least, and why.
struct StepLimiter {
  double limit = 0;  ///< [s], before the safety factor
  GlobalIndex cell = -1;
  Vec3 place = Vec3::Zero();  ///< [m]
  bool friction = false;      ///< else convection has the larger share in its rate
};
/// "The velocity in cell 3 at (0.75, 0.75, 0) m allows no longer ones."
std::string in_words(const StepLimiter& limiter);

/// Eigenvalue bounds (Gershgorin) per cell, c = sum |phi - dV/dt| / (2 V) of convection and d = 2 nu sum g /
/// V of diffusion, against the stability regions of AB2 or RK3 (all explicit) and of the modified
/// Crank-Nicolson / AB2 pair. Cells with fewer faces than a box (triangles, tetrahedra, prisms) limit the latter also by
/// friction, to 16 times their explicit limit: what the pressure's filter leaves of a noise from cell to cell comes back
/// through an implicit predictor, and grows there (measured on triangles with angles of 22 to 27 degrees between face
/// and line of cells: 32 hold, 64 end with 50 times the true dissipation; tetrahedra of 51 degrees hold with 16). The same on any
/// number of ranks: rounded to six digits. Collective.
template <int D>
class StepSize {
 public:
  StepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary, double kinematic_viscosity,
           ExplicitScheme scheme = ExplicitScheme::adams_bashforth);
  /// Largest rate of the Coriolis force [1/s]; 0: none.
  void set_frame_rate(double rate) { frame_rate_ = rate; }
  void set_fourth(bool fourth) { fourth_ = fourth; }
  StepLimits limits(const State<D>& state);
  /// The cell that limits one treatment of the viscous term; one more loop over faces and cells. Collective.
  StepLimiter limiter(const State<D>& state, bool implicit);
  /// StepLimits::explicit_viscous < `size`? Where one face is stiff enough to say so nothing else is looked
  /// at. Collective.
  bool explicit_viscous_limit_is_below(double size, const State<D>& state);
  /// Largest cell Peclet number |phi| / (nu g) of the last limits(), all ranks.
  double largest_peclet() const { return peclet_; }

 private:
  double explicit_viscous_limit(const State<D>& state);
  double add_rates(const State<D>& state, bool peclet);
  void add_eddies(const State<D>& state);
  template <class Use>
  void for_rates(const State<D>& state, const Use& use) const;
  double frame_limit() const;
  double friction_limit(Index cell, double angle, double size) const;
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  double nu_, frame_rate_ = 0;
  ExplicitScheme scheme_;
  bool fourth_ = false;                  // operators of fourth order
  std::vector<std::uint8_t> few_faces_;  // of each owned cell: fewer than a box has
  Vectors<2> rates_;                     // of convection and diffusion
  std::vector<double> peclet_of_;
  Index stiff_face_ = -1;  // with the largest g/V of those looked at last
  double peclet_ = 0;
};

/// Largest c dt of AB2 with implicit diffusion when a wave exp(i theta) meets c sin(theta) and q c (1 -
/// cos(theta))/2.
double implicit_convective_limit(double q);
/// Largest |lambda| dt of the scheme at this angle of lambda from the negative real axis [rad].
double explicit_limit(double angle, ExplicitScheme scheme = ExplicitScheme::adams_bashforth);

/// How a coupling step is cut into sub-steps, and which treatment of the viscous term they have.
template <int D>
class SubStepSize {
 public:
  SubStepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary, const FluidParameters& parameters);

  /// Sets whether operators are of fourth order.
  void set_fourth(bool fourth) { size_.set_fourth(fourth); }
  /// Begins a coupling step [s] that starts from `level`; `frame_rate`: see StepSize. Chooses begin.implicit, and begins the
  /// multi-step schemes anew where that changes. Collective.
  void begin_step(const State<D>& level, double time, double dt, double frame_rate, History<D>& begin);
  /// Equal parts of what remains [s], each within the limit of the present flow; `done`: sub-steps so far. Throws
  /// SolveFailure if there would be too many. Collective.
  double next(const State<D>& level, bool implicit, int done, double remaining, bool& last);
  /// At the begin of the last step; left out where nothing depends on them.
  const StepLimits& limits() const { return limits_; }
  /// Largest cell Reynolds number |phi| / (nu g) of a state. Collective.
  double largest_peclet(const State<D>& state);
  /// The cell that limits the steps that follow a state. Collective.
  StepLimiter limiter(const State<D>& state) { return size_.limiter(state, state.implicit); }

 private:
  void choose_viscous_treatment(const State<D>& level, History<D>& begin);
  double implicit_limit(const StepLimits& limits) const;

  const FluidParameters& parameters_;
  StepSize<D> size_;
  double time_ = 0, dt_ = 0;
  StepLimits limits_;
};

}  // namespace couplet::fluid
