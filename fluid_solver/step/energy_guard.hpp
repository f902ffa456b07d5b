// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

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
  const PressureLevel<D>& level;  ///< at t^{n+1/2}
};

/// Change of the kinetic energy in a sub-step.
struct EnergyJudgement {
  EnergyLedger ledger;         ///< after the sub-step
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
class EnergyGuard {
 public:
  /// `pressure_tolerance`: relative tolerance of the pressure solver.
  EnergyGuard(const mesh::Mesh& mesh, const Boundary<D>& boundary, const Properties& fluid,
              double pressure_tolerance)
      : mesh_(mesh),
        boundary_(boundary),
        rho_(fluid.rho),
        mu_(fluid.mu),
        pressure_tolerance_(pressure_tolerance),
        bulk_(fluid.rho * fluid.sound * fluid.sound) {}
  /// Collective.
  EnergyJudgement judge(const EnergyStep<D>& step) const;
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
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  double rho_, mu_, pressure_tolerance_, bulk_;
};

/// Likely cause of a failed step in one cell, as a sentence; local. `cell`: owned. `frame_rate`: |2 omega| of
/// a rotating frame [1/s], 0 without one.
template <int D>
std::string likely_cause(const mesh::Mesh& mesh, const Boundary<D>& boundary, const EnergyStep<D>& step,
                         Index cell, double kinematic_viscosity, bool implicit, double frame_rate);

}  // namespace couplet::fluid
