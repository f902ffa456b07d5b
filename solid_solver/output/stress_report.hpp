// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/output/probes.hpp"

namespace couplet::solid {

/// An equivalent stress (von Mises) of the accepted state, and what it may err by.
struct ReportedStress {
  std::string where;  ///< "probe 'D'", "largest"
  Vec3 place;         ///< undeformed [m]
  double value;       ///< [Pa]
  double error;       ///< estimated, over it; NaN: not known
};

/// Where the equivalent stress is largest [m], on all ranks. `points`: displacement of all local points. Collective.
Vec3 place_of_largest_stress(const SolidBody& body, const SolidFields& fields,
                             std::span<const double> points);

/// At the probes that watch a stress and, of static runs, where it is largest. The error of the tensor over its norm: the larger of
/// what the fits of the recovery leave there (StressRecovery::left_at_points) and of what the mesh leaves in the displacement
/// (`mesh`, a share), which strains and stresses follow. Where the largest stress grows with each refinement (a clamped or inner corner), the
/// first of them stays large. Within a factor of 3 of the true error in 81 % of 81 readings on 14 bodies, none below a third
/// (scripts/validate solid-accuracy). On rank 0; empty elsewhere, and where nothing is recovered. Collective.
std::vector<ReportedStress> reported_stresses(const SolidBody& body, const SolidFields& fields,
                                              const SolidProbes& probes, double mesh);

/// The same as findings.
void tell_stresses(MPI_Comm comm, const std::vector<ReportedStress>& stresses);

}  // namespace couplet::solid
