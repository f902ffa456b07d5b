// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Throws Error for inverted cells and for bent symmetry planes; warns of vertices whose value cannot be
/// exact for linear fields. Collective.
void check_mesh(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                const fv::VertexInterpolation& vertices);

/// Of a body of revolution: nothing lies behind the axis, whose faces are planes of symmetry like those across it. Throws
/// Error. Collective.
void check_axis(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic);

/// Motions without strain that the supports of one body leave free.
struct FreeMotion {
  Vec3 centre = Vec3::Zero();  ///< of the body [m]
  std::vector<std::string>
      modes;  ///< "translation along y", "rotation about x through (0, 0.5, 0)"; empty: held
};

/// One entry a body: cells that hang together by faces, in the order of their smallest cell_id. The rank of
/// the conditions on the rigid motions (6, in 2-D 3) over all supported faces and vertices counts.
/// Collective, the same on all ranks.
std::vector<FreeMotion> free_motions(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic);

/// Throws Error naming the free motions if the supports do not hold all bodies in place. Collective.
void check_supported(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic);

}  // namespace couplet::solid
