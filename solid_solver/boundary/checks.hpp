// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Throws Error for inverted cells and curved symmetry planes. Warns of vertices whose interpolation cannot
/// be exact for linear fields. Collective.
void check_mesh(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                const fv::VertexInterpolation& vertices);

/// Throws Error for parts that touch without sharing points, unless the case leaves them apart or both sides
/// have conditions of their own. Collective.
void check_touching(const mesh::LoadedMesh& body, const SolidParameters& parameters);

/// Throws Error if a body of revolution extends beyond the axis. Faces on the axis are symmetry planes like
/// those across it. Collective.
void check_axis(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic);

/// Rigid motions that the supports of one body leave free.
struct FreeMotion {
  Vec3 centre = Vec3::Zero();  ///< of the body [m]
  /// For example "translation along y", "rotation about x through (0, 0.5, 0)"; empty if the body is held.
  std::vector<std::string> modes;
};

/// One entry per body, a set of cells connected by faces, in the order of their lowest cell_id. Based on the
/// rank of the conditions on the rigid motions (6, in 2-D 3) over all supported faces and vertices.
/// Collective, equal on all ranks.
std::vector<FreeMotion> free_motions(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic);

/// Throws Error naming the free motions if the supports do not hold all bodies in place. Collective.
void check_supported(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic);

}  // namespace couplet::solid
