// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/elasticity.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::elastic {

/// The rows of the symmetric operator assembled, without shares of edges: V_f B_f^T C B_f over the faces,
/// springs, the rows of supports, and the inertia `of_nodes` (owned cells, then unknown faces) [N/m] on the
/// diagonal. Where no face shares, and without inertia, it is the kernel's K; else a preconditioner of it. In
/// space some 90 nodes a row on hexahedra and 200 on tetrahedra: for small bodies. Collective.
linalg::SparseMatrix symmetric_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> of_nodes);

}  // namespace couplet::elastic
