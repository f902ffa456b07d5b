// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Whether a free face beside a fixed one has moved beyond its plane: a bonded block that is compressed folds onto its
/// platens there from some compression on, the earlier the finer the mesh, and what it would touch is no part of the
/// body. In words with the patch and how far; empty: it has not. `displacement` of a local node (cells, then boundary
/// faces). Collective.
std::string folded_support(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           const std::function<Vec3(Index)>& displacement);

}  // namespace couplet::solid
