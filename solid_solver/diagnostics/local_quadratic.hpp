// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// The displacement at a place in or beside an owned cell by a quadratic fitted to the cells that share a vertex with it, of its material,
/// and to their boundary faces; at planes of symmetry the patch continues as its mirror image. A vertex at a surface gets its displacement
/// by weights that are exact for linear fields alone: this is what curvature adds. `cell_u`, `face_u`: of all local cells and boundary
/// faces, `dim` values each.
Vec3 quadratic_displacement(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, Index cell,
                            const Vec3& place, std::span<const double> cell_u,
                            std::span<const double> face_u);

}  // namespace couplet::solid
