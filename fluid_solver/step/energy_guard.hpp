// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// One sub-step as the energy guard sees it: two levels and what acted between them.
template <int D>
struct EnergyStep {
  const State<D>& from;              ///< level n
  const Placement<D>& to;            ///< of level n+1
  double dt;                         ///< [s]
  const Vectors<D>& u;               ///< u^{n+1} per local cell [m/s]
  const Vectors<D>& w;               ///< given velocities at t^{n+1} per boundary face [m/s]
  const std::vector<double>& phi;    ///< absolute fluxes at t^{n+1} per flux face [m^3/s]
  const std::vector<double>& p;      ///< at t^{n+1/2} per boundary face [Pa]
  const std::vector<double>& swept;  ///< dV_f per flux face [m^3]; empty: the mesh rests
  const Vectors<D>& force;           ///< body force at t^{n+1/2} per local cell [m/s^2]; empty: none
  const PressureLevel<D>& level;     ///< at t^{n+1/2}
};

/// Change of the kinetic energy in a sub-step.
struct EnergyJudgement {
  EnergyLedger ledger;         ///< after it
  double gain = 0;             ///< of the kinetic energy in this sub-step [J]
  double work = 0;             ///< brought in through boundaries and by forces [J]
  bool out_of_bounds = false;  ///< more was gained than any work and the scheme's error explain
};

/// Closes the kinetic energy of each sub-step (of a compressible fluid with the elastic one, see elastic()) against
/// the work that boundaries and forces can have done:
///   E^{n+1} - E^n <= dt sum_b [ -(p_b - p_ref) phi - phi' (s u_b.u_P - |u_P|^2/2) rho
///                               + mu g |u_b| |u_b - u_P| ] + dt sum rho V f.u,
/// phi' relative to the mesh, s the backflow's share.
/// Friction inside only takes, the skew-symmetric convection gives nothing: an excess is the scheme's own. It
/// is summed over the steps (a CUSUM test [page1954]: what is missing is not counted as credit), less a share
/// of what went through the boundaries, whose rates are known to the order of the scheme only; work taken out
/// is not counted against what comes in. One loop over the cells that is needed for the largest speed anyway,
/// one over the boundary.
template <int D>
class EnergyGuard {
 public:
  /// `pressure_tolerance`: relative one of the pressure's solver.
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
  /// Elastic energy V p^2/(2 rho c^2) [J] at the end of the step of pressure[0], pressures about `level`; 0 of an
  /// incompressible fluid. Of the three-level rule with equal steps V (3 p_0^2 + 2 p_1^2 + p_2^2 - 2 p_0 p_2 - 2 p_1 p_2) /
  /// (4 rho c^2), which with the kinetic energy loses V (p_0 - p_1 - p_2 + p_3)^2/(4 rho c^2) a step, whatever its size.
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

/// Why a step may have gone wrong in one cell, as a sentence; local. `cell`: owned. `frame_rate`: |2 omega| of a frame
/// that turns [1/s], 0 without.
template <int D>
std::string likely_cause(const mesh::Mesh& mesh, const Boundary<D>& boundary, const EnergyStep<D>& step,
                         Index cell, double kinematic_viscosity, bool implicit, double frame_rate);

}  // namespace couplet::fluid
