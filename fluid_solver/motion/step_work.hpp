// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/lines/fourth_order.hpp"
#include "fluid_solver/motion/gap_pockets.hpp"
#include "fluid_solver/motion/gaps.hpp"
#include "fluid_solver/motion/immersed.hpp"
#include "fluid_solver/motion/rotating_frame.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Where one sub-step goes.
template <int D>
struct SubStep {
  double dt = 0;                           ///< [s]
  std::shared_ptr<const Placement<D>> to;  ///< of the points at t^{n+1}
  std::vector<double> swept;               ///< dV_f per flux face [m^3]; empty: the mesh rests
  std::vector<Vec3> points;                ///< at t^{n+1}; empty: the mesh rests
  Vectors<D> rate{};                       ///< mean of R over the step; empty: by Adams-Bashforth
  Vectors<D> shear{};   ///< with `rate`: mean of the viscous force on the boundary faces [N]
  bool yields = false;  ///< walls of a known mass answer to the pressure (Robin condition)
};

struct StepStatistics {
  int pressure_iterations = 0, viscous_iterations = 0;
};

/// What the parts of a fractional step have in common: the scene, the step under way, and the fields that go
/// from one part to the next.
template <int D>
struct StepWork {
  const mesh::Mesh& mesh;
  const std::vector<Vec3>& points_at_rest;  ///< as read, per local point [m]
  const Boundary<D>& boundary;
  const FluidParameters& parameters;
  double rho, nu;             ///< [kg/m^3], [m^2/s]
  double sound = 0;           ///< [m/s]; 0: incompressible
  bool oblique = false;       ///< the non-orthogonal parts are needed
  bool very_oblique = false;  ///< an implicit predictor needs them converged
  double degrees = 0;         ///< largest angle between a face's normal and the line of its cells

  std::unique_ptr<ImmersedBodies<D>> bodies{};          ///< null: none
  std::shared_ptr<const Placement<D>> around_bodies{};  ///< with bodies only
  std::shared_ptr<const Placement<D>> bodies_at{};      ///< the placement that it was made from
  std::unique_ptr<Gaps<D>> gaps{};                      ///< null: none
  std::unique_ptr<GapPockets<D>> pockets{};             ///< with gaps only
  bool gap_changed = false;  ///< in this step cells are blocked or freed: an impulse, as in a first step
  std::shared_ptr<const Placement<D>> around_gaps{};  ///< with blocked cells only
  std::shared_ptr<const Placement<D>> assembled{};    ///< placement of the pressure matrix

  std::optional<RotatingFrame<D>> frame{};   ///< empty: none
  std::unique_ptr<FourthOrder<D>> fourth{};  ///< null: second order everywhere

  SubStep<D> step{};
  History<D> by{};                  ///< how the step sees its begin
  std::vector<double> wall_load{};  ///< pressure that gave w of walls that yield, per boundary face [Pa]
  Vectors<D> w{};                   ///< given velocities at t^{n+1} per boundary face [m/s]
  Vectors<D> right_side{};          ///< of the predictor; u^{n+1} once that is made
  Vectors<D> u_p{};                 ///< predicted velocity per local cell [m/s]
  Vectors<D> u_boundary{};          ///< closed boundary velocity of what is looked at [m/s]
  Vectors<D> force{};               ///< f at t^{n+1/2} per local cell [m/s^2]; empty: none
  std::vector<double> phi_orthogonal{}, phi_p{};  ///< phi^p without and with -(dt/rho) grad p~ . k [m^3/s]
  std::vector<double> p{}, p_boundary{};          ///< p^{n+1/2} per local cell, boundary face [Pa]
  Vectors<D> gradient_start{}, gradient_guess{};  ///< of p for the non-orthogonal part: first, of this pass
  Vectors<D> viscous_flux{};                      ///< of momentum, per boundary face, on what is outside [N]
  std::vector<Tensor<D>> velocity_gradient{};     ///< skewed meshes only
  std::uint64_t gradient_of = 0;                  ///< State::number whose gradient that is; 0: none's
  StepStatistics statistics{};

  /// The placement as the pressure equation sees it: blocked faces conduct nothing.
  const Placement<D>& pressure_placement() const {
    return around_bodies ? *around_bodies : around_gaps ? *around_gaps : *step.to;
  }
  /// The open share of a face, and what bodies displace through the rest of it [m^3/s].
  double open_flux(Index f, double flux) const {
    return bodies->open(f) * flux + bodies->carried(f, *step.to);
  }
  /// Whose means at the faces are the fluxes of u. Collective.
  const Vectors<D>& flux_velocity(const Placement<D>& at, const Vectors<D>& u) const {
    return fourth ? fourth->flux_velocity(at, u) : u;
  }
  bool gap_closed() const { return gaps && gaps->active(); }
  /// What a value linear between the cells lacks at a face of a skewed mesh.
  double skew_part(const Placement<D>& at, const Vectors<D>& gradient, Index f) const {
    const double weight = at.weight[f];
    return (weight * gradient[mesh.owner[f]] + (1 - weight) * gradient[mesh.neighbour[f]]).dot(at.skew[f]);
  }
};

}  // namespace couplet::fluid
