// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <span>

#include "common/mesh/mesh.hpp"

namespace couplet::fv {

/// Means over a boundary face of a function and of its products with the hat functions of the corners. A hat is 1 at
/// its corner, 0 at the other corners and at the face center, and linear on the triangles (in 2-D the halves) between.
struct FaceMean {
  Vec3 whole = Vec3::Zero();
  std::array<Vec3, 4> corner{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
};

/// Computes the means of f(x) exactly for a linear function, and otherwise by subdivision until they no longer change.
/// It finds what is at least a tenth of a face wide.
FaceMean mean_over_face(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index face,
                        const std::function<Vec3(const Vec3&)>& f);
/// Does so for a face with these corners, two in 2-D.
FaceMean mean_over_face(std::span<const Vec3> corners, const Vec3& center,
                        const std::function<Vec3(const Vec3&)>& f);

}  // namespace couplet::fv
