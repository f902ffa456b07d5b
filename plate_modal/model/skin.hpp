// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/modes/modal_model.hpp"
#include "plate_modal/model/plate_model.hpp"

namespace couplet::plate {

/// Sides of a plate included in its surface.
enum class Wetted { both, upper, lower };

/// Position of the mid-surface in space: origin and axes x and y of its plane; the normal is x cross y.
struct Placement {
  Vec3 origin = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY();
  Vec3 normal() const { return x.cross(y); }
  Vec3 place(const Vec2& p, double height) const {
    return origin + p.x() * x + p.y() * y + height * normal();
  }
};

/// Two-sided surface of a plate and its modes there. A point at height z above the mid-surface moves by w n -
/// z grad w, thesis (4.25). The faces are the upper and lower sides of the cells, and between them one
/// quadrilateral per outline edge whose patch is in `open` (both sides wetted); a clamped edge is inside its
/// wall. The thickness at a point is the area-weighted mean of its cells. Shapes are means over the faces:
/// exact for the cubic deflection on the sides, means of the corners on the rim.
modes::ModalModel skin_of(const PlateModel& plate, const modes::EigenModes& modes, const Placement& placement,
                          Wetted wetted, const std::vector<bool>& open);

}  // namespace couplet::plate
