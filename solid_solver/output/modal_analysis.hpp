// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "common/modes/modal_model.hpp"
#include "common/modes/pencil.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// K of free vibrations; empty if the kernel has no mass. Keeps a reference to `body`.
std::optional<SolidProblem> vibration(const SolidBody& body);

/// Lowest n free vibrations of the supported body, K x = omega^2 M x with stiffness and mass of the kernel.
/// Uses shift-invert with the solution method of a time step. Supports and springs count, prescribed motions
/// are held at rest. `problem`: static, with a kernel that has mass (face-gradient: symmetric, dynamic
/// analysis). `cell_mass`: per owned cell [kg]. Shapes are mass-normalized, on this rank's unknowns. Throws
/// SolveFailure. Collective.
modes::EigenModes solid_modes(const SolidProblem& problem, MethodParameters method,
                              std::span<const double> cell_mass, int n);

/// Bound of the relative error of a shape's strain energy due to the mesh. Two gradients differ by a strain g and by the
/// energy g^2, which falls faster with the cell size than the error: the larger of this energy, with that of recovered
/// strains, and of a share of g counts. Collective.
double energy_error(const SolidBody& body, const std::vector<double>& shape);

/// Bound of the relative errors of the frequencies due to the mesh: half that of the strain energies of the
/// mass-normalised shapes. Collective.
double mode_error(const SolidBody& body, const modes::EigenModes& modes);

/// Surface values of these modes on rank 0 (empty elsewhere), vertices by ascending point_id and faces by
/// ascending boundary_id. A plane body has a depth of 1 m and a third component of 0. Collective.
modes::ModalModel modal_model(const SolidProblem& problem, const modes::EigenModes& modes);

}  // namespace couplet::solid
