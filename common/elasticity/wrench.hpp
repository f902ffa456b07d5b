// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "common/base/types.hpp"

namespace couplet::elastic {

/// Force [N] with its moment about the origin [N m].
struct Wrench {
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  void add(const Vec3& part, const Vec3& place) {
    force += part;
    moment += place.cross(part);
  }
  Vec3 moment_about(const Vec3& centre) const { return moment - centre.cross(force); }
};

}  // namespace couplet::elastic
