// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace couplet::solid
