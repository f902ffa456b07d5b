// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Velocity gradient computed last, with the state it belongs to; skewed meshes only.
template <int D>
struct KnownGradient {
  std::vector<Tensor<D>> values;
  std::uint64_t number = 0;  ///< State::number; 0 if it belongs to no state
  const std::vector<Tensor<D>>* of(const State<D>& state) const {
    return number != 0 && number == state.number ? &values : nullptr;
  }
};

/// The first stage of a fractional step:
///   V' u^p = V u^n + dt [(1 + r/2) R^n - r/2 R^{n-1}] + sum dV_f u_f~ - (dt/rho) sum p_f^{n-1/2} (S^{n+1/2} - S^{n+1})
/// Here r = dt/dt_old and u~ = (1 + r/2) u^n - r/2 u^{n-1}. Modified Crank-Nicolson if implicit.
template <int D>
class Predictor {
 public:
  /// `result`: filled here except for w, which is given.
  Predictor(const Scene<D>& scene, const FluidStep<D>& step, const KnownGradient<D>& gradient,
            Prediction<D>& result);

  /// Computes u^p in the owned cells and the viscous force of the walls. `turned`: velocity at t^{n+1/2} on which the forces of a
  /// rotating frame act; empty without one. Collective.
  void predict(const State<D>& from, const Vectors<D>& turned);
  /// Sets R of a state and its viscous force on the boundary faces in the prediction. Collective.
  void set_rates(const State<D>& from, bool implicit);
  RateOperator<D>& rate_operator() { return rate_operator_; }
  int iterations() const { return friction_.iterations(); }
  /// Inverse of the diagonal of the last implicit system, per owned cell.
  const std::vector<double>& inverse_diagonal() const { return friction_.inverse_diagonal(); }

 private:
  void set_explicit_friction(const State<D>& from, double e0, double e1);
  void add_forces(const State<D>& from, const Vectors<D>& turned, double e0, double e1);
  void add_wall_convection(const State<D>& from);
  void add_swept(const State<D>& from, double e0, double e1);
  void add_old_pressure(const State<D>& from, bool implicit);
  void solve_viscous(const State<D>& from, double a);
  void add_to_surroundings(std::span<const Vec<D>> flux, Vectors<D>& force) const;
  void add_back_old_pressure();

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const FluidStep<D>& step_;
  const KnownGradient<D>& gradient_;
  Prediction<D>& out_;
  RateOperator<D> rate_operator_;
  ImplicitFriction<D> friction_;
  Vectors<D> side_;          // right-hand side
  Vectors<D> u_boundary_;    // at the boundary, from u^p
  Vectors<D> old_pressure_;  // dt/rho sum p^{n-1/2} S^{n+1}; implicit predictor on a moving mesh only
};

/// Predicts the volume fluxes phi^p = (mean u^p).S^{n+1} + delta' - (dt/rho) grad p~ . k. Also updates the memory
/// delta = phi - (mean u).S from step to step.
template <int D>
class FaceFlux {
 public:
  /// `gradient`: filled here.
  FaceFlux(const Scene<D>& scene, const FluidStep<D>& step, KnownGradient<D>& gradient)
      : scene_(scene), mesh_(scene.mesh), step_(step), gradient_(gradient) {}

  /// Predicts phi^p without the pressure part, per flux face [m^3/s]. Collective.
  void predict(const State<D>& from, const Vectors<D>& u);
  const std::vector<double>& phi() const { return phi_; }
  /// Sets delta^{n+1} of the state from its u and phi. Collective.
  void remember(State<D>& state);

 private:
  void set_relaxation(const State<D>& from);
  void add_memory(const State<D>& from);
  void split_excess(const Placement<D>& at, std::shared_ptr<const PressureLevel<D>> of);
  const Placement<D>& guess_at(const State<D>& from) const;
  double pressure_excess(const Placement<D>& at, const PressureLevel<D>& level, const Vectors<D>& gradient,
                         Index f) const;

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const FluidStep<D>& step_;
  KnownGradient<D>& gradient_;
  std::vector<double> phi_;
  Vectors<D> u_boundary_;              // from the predicted velocity
  std::vector<double> relaxation_;     // [1/s]
  std::vector<Index> far_;             // faces with a large decay
  std::vector<double> smooth_, rest_;  // parts of e per interior face [m^3/s^2]
  std::shared_ptr<const PressureLevel<D>> smooth_of_;
  std::vector<double> ahead_;  // smooth part in the predicted flux
  Vectors<D> vectors_;         // of the filter, per local cell
};

/// Data of one sub-step for the energy guard: two levels and the fluxes and forces between them.
template <int D>
struct EnergyStep {
  const State<D>& from;              ///< level n
  const Placement<D>& to;            ///< placement at level n+1
  double dt;                         ///< [s]
  const Vectors<D>& u;               ///< u^{n+1} per local cell [m/s]
  const Vectors<D>& w;               ///< given velocities at t^{n+1} per boundary face [m/s]
  const std::vector<double>& phi;    ///< absolute fluxes at t^{n+1} per flux face [m^3/s]
  const std::vector<double>& p;      ///< at t^{n+1/2} per boundary face [Pa]
  const std::vector<double>& swept;  ///< dV_f per flux face [m^3]; empty if the mesh is at rest
  const Vectors<D>& force;        ///< body force at t^{n+1/2} per local cell [m/s^2]; empty if there is none
  const Vectors<D>& friction;     ///< viscous force on the surroundings per boundary face [N]
  const PressureLevel<D>& level;  ///< at t^{n+1/2}
};

/// Change of the kinetic energy in a sub-step.
struct EnergyChange {
  EnergySums ledger;           ///< after the sub-step
  double gain = 0;             ///< of kinetic energy in this sub-step [J]
  double work = 0;             ///< done by boundaries and forces [J]
  bool out_of_bounds = false;  ///< the gain exceeds the work and the error of the scheme
};

/// Compares the change of kinetic energy in each sub-step with the work of boundaries and forces. The energy
/// of a compressible fluid includes the elastic energy, see elastic().
///   E^{n+1} - E^n <= dt sum_b [ -(p_b - p_ref) phi - phi' (s u_b.u_P - |u_P|^2/2) rho
///                               + mu g |u_b| |u_b - u_P| ] + dt sum rho V f.u
/// Here phi' is the flux relative to the mesh and s the share of the backflow. Internal friction only
/// dissipates and skew-symmetric convection conserves energy, so an excess is an error of the scheme. The
/// excess is accumulated by a CUSUM test [page1954], which gives no credit for deficits. A share of the
/// boundary fluxes is subtracted, because their rates have only the accuracy of the scheme. Work that leaves
/// is not offset against work that enters.
template <int D>
class EnergyCheck {
 public:
  /// `pressure_tolerance`: relative tolerance of the pressure solver.
  EnergyCheck(const mesh::Mesh& mesh, const Boundary<D>& boundary, const Properties& fluid,
              double pressure_tolerance)
      : mesh_(mesh),
        boundary_(boundary),
        rho_(fluid.rho),
        mu_(fluid.mu),
        pressure_tolerance_(pressure_tolerance),
        bulk_(fluid.rho * fluid.sound * fluid.sound) {}
  /// Collective.
  EnergyChange evaluate(const EnergyStep<D>& step) const;
  /// Sum of rho V |u|^2 / 2 [J] over the cells of this rank.
  double kinetic(const Placement<D>& at, const Vectors<D>& u) const;
  /// Elastic energy V p^2/(2 rho c^2) [J] at the end of the step of pressure[0], with pressures relative to
  /// `level`. The three-level rule with equal steps uses V (3 p_0^2 + 2 p_1^2 + p_2^2 - 2 p_0 p_2 - 2 p_1
  /// p_2)/(4 rho c^2). With the kinetic energy it loses V (p_0 - p_1 - p_2 + p_3)^2/(4 rho c^2) per step. 0
  /// if incompressible.
  double elastic(const Placement<D>& at, const std::array<const PressureLevel<D>*, 3>& pressure,
                 double level) const;

 private:
  double mean_pressure(const EnergyStep<D>& step) const;
  double level_of(const EnergyStep<D>& step) const;
  double energy_at_rest(const EnergyStep<D>& step) const;
  void add_boundary(const EnergyStep<D>& step, double level, double* sums) const;
  void add_law(const EnergyStep<D>& step, double* sums) const;
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  double rho_, mu_, pressure_tolerance_, bulk_;
};

/// Likely cause of a failed step in one cell, as a sentence; empty if it is none of those known here. Local. `cell`: owned.
template <int D>
std::string likely_cause(const mesh::Mesh& mesh, const Boundary<D>& boundary, const EnergyStep<D>& step,
                         Index cell, double kinematic_viscosity, bool implicit);

}  // namespace couplet::fluid
