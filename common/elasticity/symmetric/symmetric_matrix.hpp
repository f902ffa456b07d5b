// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/elasticity/elasticity.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::elastic {

/// The rows of the symmetric operator assembled, without shares of edges: V_f B_f^T C B_f over the faces,
/// springs, the rows of supports, and the kernel's mass of `inertia`, mass factor times density of the owned cells
/// [N/m^4]; empty: none. Where no face shares it is the kernel's K + factor M; else a preconditioner of it. In
/// space some 90 nodes a row on hexahedra and 200 on tetrahedra: for small bodies. Collective.
linalg::SparseMatrix symmetric_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> inertia);

}  // namespace couplet::elastic
