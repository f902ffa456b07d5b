// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::elastic {

/// The tangent of a deformed body at the last linearise() of its kernel, assembled: for factors of small bodies. As
/// symmetric_matrix(): three-cornered faces as if they shared nothing with their edges, and without the tangent of a
/// pressure that follows the surface. `of_nodes`: on the diagonals of the unknown nodes; empty: none. Collective.
linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes);

}  // namespace couplet::elastic
