// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {

/// The box around a mesh [m], over all ranks.
struct Extent {
  Vec3 lower, upper;
  double diagonal() const { return (upper - lower).norm(); }
};

/// Collective.
inline Extent extent_of(const Mesh& mesh, const Geometry& geometry) {
  Extent box{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  for (const Vec3& x : geometry.points) box.lower = box.lower.cwiseMin(x), box.upper = box.upper.cwiseMax(x);
  for (int a = 0; a < 3; ++a)
    box.lower[a] = parallel::min(mesh.comm, box.lower[a]),
    box.upper[a] = parallel::max(mesh.comm, box.upper[a]);
  return box;
}

}  // namespace couplet::mesh
