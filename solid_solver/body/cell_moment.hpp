// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Mean of (x - x_c) (x - x_c)^T over a local cell [m^2], from its vertices: exact for simplices and boxes.
Tensor3 cell_moment(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index cell);
/// Appends the local cells that share a vertex with `cell` and have its material, itself among them. `mark`: per local cell for which
/// cell it was last gathered, at first -1.
void gather_cells(const mesh::Mesh& mesh, const mesh::Csr& cells_of_point, Index cell,
                  std::vector<Index>& mark, std::vector<Index>& cells);
/// Boundary faces of each local cell, counted among all faces.
mesh::Csr boundary_faces_of_cells(const mesh::Mesh& mesh);

}  // namespace couplet::solid
