// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::fv {

/// Flux faces of each owned cell.
mesh::Csr flux_faces_of_cells(const mesh::Mesh& mesh);

/// Global number of each local node (cells, then boundary faces) as an unknown, -1: none. A rank numbers its
/// owned cells, then these boundary faces of its own; a bonded face has the number of its twin. Collective.
std::vector<GlobalIndex> number_nodes(const mesh::Mesh& mesh, std::span<const Index> faces_with_unknown);

}  // namespace couplet::fv
