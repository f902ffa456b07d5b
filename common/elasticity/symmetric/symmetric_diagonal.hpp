// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"

namespace couplet::elastic {

/// What stands on the diagonal of the symmetric operator K = sum_f V_f B_f^T C B_f [N/m], for preconditioners: the
/// vertices' parts with it, which are most of it, and which two-point fluxes know nothing of.
///
/// Exact where no face shares with its edges, the volume strain is the faces' own and no condition turns the motion of
/// vertices. Shares are left out, which makes it larger, and so are the projectors of vertices (a few parts in a hundred
/// beside planes of symmetry), springs and inertia.
struct SymmetricDiagonal {
  std::vector<double> cells;   ///< K_cc of the owned cells, `dim` values a cell
  std::vector<Tensor3> faces;  ///< blocks K_BB of rows.unknown_faces()
};

/// `without`: whose bulk modulus the operator lacks (VolumeStrain::faces: none). Collective.
SymmetricDiagonal symmetric_diagonal(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                     VolumeStrain without);

}  // namespace couplet::elastic
