// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/mesh/load.hpp"

namespace couplet::plate {

/// Surface of a rigid body at the start, on rank 0: patches of a mesh of the body or of the fluid around it. The faces point out of
/// the body. Those of a planar body are edges, 1 m deep.
struct BodySurface {
  int dimension = 3;
  std::vector<Vec3> vertices;        ///< [m]
  mesh::Csr faces;                   ///< vertices of each face
  std::vector<Vec3> centres, areas;  ///< [m], [m^2]
  double enclosed = 0;               ///< volume [m^3]

  /// Positions and areas; takes and gives remain empty.
  coupling::Interface describe() const;
};

/// Takes the patches of these names from a mesh. Throws Error with `key` if one is missing or the mesh has another dimension.
BodySurface surface_of(const mesh::RawMesh& raw, const std::vector<std::string>& patches, int dimension,
                       const std::string& key);

}  // namespace couplet::plate
