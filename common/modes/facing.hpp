// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "common/modes/modal_model.hpp"

namespace couplet {

/// Volume behind the faces of a surface that has two sides, above 0 where the normals point out of it [m^3]: of a closed
/// one by the divergence theorem, of an open one (a plate's clamped rim is not part of its surface) closed by the cone
/// from the middle of its rim. None: a sheet, of which nothing tells the front from the back.
std::optional<double> volume_behind(const ModalModel& model);

/// Whether the faces of a body's surface are turned inside out. Empty: they are not, or nothing tells.
std::string facing_problem_of(const ModalModel& model);

}  // namespace couplet
