// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/modes/modal_model.hpp"

namespace couplet::modes {

/// Volume behind the faces of a surface that has two sides, above 0 where the normals point out of it [m^3]: of a closed
/// one by the divergence theorem, of an open one (a plate's clamped rim is not part of its surface) closed by the cone
/// from the middle of its rim. None: a sheet, of which nothing tells the front from the back.
std::optional<double> volume_behind(const ModalModel& model);

/// Where the normals of a structure's surface must point: out of it, or, of the wall of a cavity, into what it encloses.
enum class Facing { outward, inward };

/// Whether the faces of a surface point to the wrong side: neighbours that do not turn alike, and every part that hangs
/// together (vertices of its own or not) by what lies before and behind its faces: an even number of other faces lies
/// before a face of a body, an odd one behind it, so of two sheets each looks away from the other. Where these do not
/// tell, volume_behind() of the part. Empty: all are right, or nothing tells (a sheet alone).
std::string facing_problem_of(const ModalModel& model, Facing wanted = Facing::outward);

}  // namespace couplet::modes
