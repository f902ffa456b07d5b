// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/modes/modal_model.hpp"

namespace couplet::modes {

/// Reason why sizes or values of a model are invalid, or empty.
std::string problem_of(const ModalModel& model);
/// Reason why a valid model cannot belong to a structure, or empty. Checks for mass above 0, shapes with
/// motion and effective masses within the mass.
std::string impossible_in(const ModalModel& model);
/// Reports two overlapping modes, as far as faces that carry the whole mass show it. Empty if there are none.
std::string overlap_problem_of(const ModalModel& model);
/// Reports shapes that cannot be mass-normalized, or is empty. The tolerance is a factor of about three if
/// `face_density` covers half of the mass or more, and of a hundred otherwise.
std::string scale_problem_of(const ModalModel& model);
/// Reports rows of the shapes in another order than the vertices, because such shapes are rough along the
/// edges. Empty if there are none.
std::string order_problem_of(const ModalModel& model);
/// Reports faces that do not form a surface, or is empty. Each face must have distinct vertices, every vertex
/// a face, and neighbors the same orientation. The vertices of the faces must exist.
std::string surface_problem_of(const ModalModel& model);

/// Volume behind the faces of a two-sided surface, positive if the normals point outwards [m^3]. It follows
/// from the divergence theorem. An open surface (without a plate's clamped rim) is closed by a cone from the
/// center of its rim. Returns nothing for a sheet, whose front and back cannot be distinguished.
std::optional<double> volume_behind(const ModalModel& model);

/// Required direction of the normals: out of a structure, or into the cavity that a wall encloses.
enum class Facing { outward, inward };

/// Reports faces that point to the wrong side or are oriented inconsistently, or is empty. Each connected
/// part is judged by the number of other faces in front of its faces (even for a body) and behind them (odd),
/// so two sheets face away from each other. If this is inconclusive, volume_behind() of the part decides. A
/// single sheet is accepted.
std::string facing_problem_of(const ModalModel& model, Facing wanted = Facing::outward);

}  // namespace couplet::modes
