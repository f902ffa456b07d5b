// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Boundary faces of one patch that lie on faces of another, or of the same, without sharing their points.
struct TouchingFaces {
  std::string patch, other;
  GlobalIndex count = 0;      ///< number of these faces of `patch`
  Vec3 where = Vec3::Zero();  ///< center of the first one
  bool alike = true;          ///< each lies on one face with the same center, so that they can be tied
};

/// Finds the pairs of patches that touch. Faces are compared where their centers are, so that meshes of
/// another size on the other side are found, too. The same on all ranks. Collective.
std::vector<TouchingFaces> find_touching_faces(const Mesh& mesh, const Geometry& geometry);

/// Joins the points of coincident boundary elements and removes these elements, so that their
/// cells become neighbors. Elements on one with other corners stay. Collective.
void tie_touching_faces(MPI_Comm comm, MeshBlock& block);

}  // namespace couplet::mesh
