// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// The faces of one patch as a mesh, for what is written of them. Its cells are the patch's faces on this rank in their
/// order (edges in 2-D), its points those of these faces, each owned by the rank that owns it in the body.
struct SurfaceMesh {
  mesh::Mesh mesh;            ///< dim: that of the body less 1; cell_id: boundary_id of the body; no faces
  std::vector<Index> points;  ///< per local point: the local point of the body
  std::vector<Vec3> places;   ///< of the points [m]
};

/// `places`: per local point of the body [m]. Collective.
SurfaceMesh make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch);

}  // namespace couplet::io
