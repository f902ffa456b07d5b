// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/base/constants.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Largest stable steps of the two treatments of the viscous term [s]; infinity for an inviscid fluid at
/// rest.
struct StepLimits {
  double explicit_viscous = 0;
  double implicit_viscous = 0;
};

/// Cell with the smallest limit, and the reason.
struct StepLimiter {
  double limit = 0;  ///< [s], before the safety factor
  GlobalIndex cell = -1;
  Vec3 place = Vec3::Zero();  ///< [m]
  bool friction = false;      ///< true if friction has the larger share in its rate, else convection
  bool frame = false;         ///< true if the Coriolis force or buoyancy limits the step in all cells
  double share = 1;           ///< of the cells whose limit is less than twice this one
  const char* cause() const {
    return frame ? "the Coriolis force or buoyancy" : friction ? "viscosity" : "convection";
  }
};
/// For example: "In cell 3 at (0.75, 0.75, 0) m, convection limits them to this size."
std::string in_words(const StepLimiter& limiter);

/// Compares Gershgorin bounds of the eigenvalues per cell with the stability regions of the schemes (AB2,
/// RK3, or the modified Crank-Nicolson/AB2 pair). The bounds are c = sum |phi - dV/dt|/(2 V) for convection
/// and d = 2 nu sum g/V for diffusion. Cells with fewer faces than a box also limit the implicit step by
/// friction, to 16 times their explicit limit. Otherwise cell-to-cell noise left by the pressure filter grows
/// through an implicit predictor. On triangles with angles of 22 to 27 degrees, a factor of 32 is stable and
/// 64 gives 50 times the true dissipation; tetrahedra at 51 degrees are stable with 16. Rounded to six
/// digits, so independent of the number of ranks. Collective.
template <int D>
class StepSize {
 public:
  /// `terms`: must outlive this.
  StepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary, double kinematic_viscosity,
           const MomentumTerms<D>& terms);
  /// Largest rate of the Coriolis force and of buoyancy [1/s]; 0 if there is none.
  void set_frame_rate(double rate) { frame_rate_ = rate; }
  void set_fourth(bool fourth) { fourth_ = fourth; }
  /// Lets implicit convection replace explicit one up to this Courant number.
  void set_courant(double courant) { courant_ = courant; }
  /// Marks cells in which explicit convection is unstable with steps of this size, see SubStep. Collective.
  std::vector<double> fast_cells(const State<D>& state, double size);
  StepLimits limits(const State<D>& state);
  /// Largest stable step of a scalar that the flow carries explicitly, with implicit diffusion [s]. Collective.
  double scalar_limit(const State<D>& state);
  /// Cell that limits one treatment of the viscous term. Loops over faces and cells. Collective.
  StepLimiter limiter(const State<D>& state, bool implicit);

 private:
  void add_rates(const State<D>& state, bool peclet);
  template <class Use>
  void for_rates(const State<D>& state, const Use& use) const;
  double frame_limit() const;
  double friction_limit(Index cell, double angle, double size) const;
  double convective_limit(Index cell) const;
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  const MomentumTerms<D>& terms_;
  double nu_, frame_rate_ = 0;
  bool fourth_ = false;                  // the operators are of fourth order
  double courant_ = 0;                   // largest Courant number of implicit convection; 0 if there is none
  std::vector<std::uint8_t> few_faces_;  // per owned cell: it has fewer faces than a box
  Vectors<2> rates_;                     // rates of convection and diffusion
  std::vector<double> peclet_of_;
};

/// Largest c dt of AB2 with implicit diffusion if a wave exp(i theta) sees c sin(theta) and q c (1 -
/// cos(theta))/2.
double implicit_convective_limit(double q);
/// Largest |lambda| dt of the scheme at this angle of lambda from the negative real axis [rad].
double explicit_limit(double angle);

/// Chooses the sub-steps of a coupling step and their treatment of the viscous term.
template <int D>
class SubStepSize {
 public:
  SubStepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary, const FluidParameters& parameters,
              const MomentumTerms<D>& terms);

  /// Sets whether operators are of fourth order.
  void set_fourth(bool fourth) { size_.set_fourth(fourth); }
  /// Begins a coupling step [s] from `level`; `frame_rate`: see StepSize. Chooses begin.implicit and restarts
  /// the multi-step schemes if it changes. `starts`: `level` is what a flow at rest is expected to become, so that its
  /// limits hold to the end of the step. Collective.
  void begin_step(const State<D>& level, double time, double dt, double frame_rate, bool starts,
                  FlowHistory<D>& begin);
  /// Returns an equal part of the remaining time [s] within the limit of the present flow. `done`: sub-steps
  /// so far. Throws SolveFailure if there would be too many. Collective.
  double next(const State<D>& level, bool implicit, int done, double remaining, bool& last);
  /// See StepSize; for a sub-step [s]. Collective.
  std::vector<double> fast_cells(const State<D>& level, bool implicit, double dt) {
    if (!parameters_.courant || !implicit) return {};
    return size_.fast_cells(level, dt / parameters_.safety_factor);
  }
  /// Limits at the start of the last step; not computed if nothing depends on them.
  const StepLimits& limits() const { return limits_; }
  /// Cell that limits the steps after a state. Collective.
  StepLimiter limiter(const State<D>& state) { return size_.limiter(state, state.implicit); }

 private:
  void choose_viscous_treatment(const State<D>& level, FlowHistory<D>& begin);
  StepLimits limits_of(const State<D>& level);
  double implicit_limit(const StepLimits& limits) const;

  const FluidParameters& parameters_;
  StepSize<D> size_;
  const MomentumTerms<D> no_terms_;
  std::optional<StepSize<D>> heat_size_;  // of the temperature
  double time_ = 0, dt_ = 0;
  StepLimits limits_;
  bool starts_ = false;
};

}  // namespace couplet::fluid
