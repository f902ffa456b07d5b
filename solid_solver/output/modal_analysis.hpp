// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "common/modes/modal_model.hpp"
#include "common/modes/pencil.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// K of free vibrations, with a kernel that has M; none where the kernel has no mass of its own. `body` by reference.
std::optional<SolidProblem> vibration(const SolidBody& body);

/// The n lowest free vibrations of the body as it is held, K x = omega^2 M x with the kernel's own stiffness and
/// mass, shift-inverted with the solution method of a time step; supports and springs count, prescribed motions are
/// held at rest. `problem`: static, with a kernel that has a mass (face-gradient: symmetric, dynamic analysis).
/// `cell_mass`: per owned cell [kg]. Shapes are mass-normalised, on this rank's unknowns. Throws
/// SolveFailure. Collective.
modes::EigenModes solid_modes(const SolidProblem& problem, MethodParameters method,
                              std::span<const double> cell_mass, int n);

/// Relative error of the frequencies due to the mesh, the largest: half that of the strain energies of the mass-normalised
/// shapes where what is held rests. Collective.
double mode_error(const SolidBody& body, const modes::EigenModes& modes);

/// What the surface shows of these modes, on rank 0 (empty elsewhere): vertices by ascending point_id, faces by
/// ascending boundary_id; of a plane body the depth is 1 m and the third component 0. Collective.
modes::ModalModel modal_model(const SolidProblem& problem, const modes::EigenModes& modes);

}  // namespace couplet::solid
