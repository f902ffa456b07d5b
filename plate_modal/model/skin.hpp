// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/modes/modal_model.hpp"
#include "plate_modal/model/plate_model.hpp"

namespace couplet::plate {

/// Which sides of a plate its surface has.
enum class Wetted { both, upper, lower };

/// Where the mid-surface lies in space: its plane's origin and its axes x and y; the normal is x cross y.
struct Placement {
  Vec3 origin = Vec3::Zero(), x = Vec3::UnitX(), y = Vec3::UnitY();
  Vec3 normal() const { return x.cross(y); }
  Vec3 place(const Vec2& p, double height) const {
    return origin + p.x() * x + p.y() * y + height * normal();
  }
};

/// The two-sided surface of a plate and its modes there. A point at height z over the mid-surface moves by
/// w n - z grad w, thesis (4.25). The faces are the cells' upper and lower sides and, between them, one
/// quadrilateral for every edge of the outline whose patch is in `open` (both sides wetted): a clamped edge
/// sits in its wall. The thickness at a point is the mean of the cells around it, by area. Shapes are means
/// over the faces: those of the sides exact for the plate's cubic deflection, those of the rim the mean of
/// the corners.
modes::ModalModel skin_of(const PlateModel& plate, const modes::EigenModes& modes, const Placement& placement,
                          Wetted wetted, const std::vector<bool>& open);

}  // namespace couplet::plate
