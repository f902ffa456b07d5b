// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/elasticity.hpp"

namespace couplet::elastic {

/// Diagonal of the symmetric operator K = sum_f V_f B_f^T C B_f [N/m] for preconditioners. It includes the
/// contributions of the vertices, which dominate and are missing in two-point fluxes.
///
/// Exact if no face shares with edges, the volume strain is that of the faces, and no condition constrains
/// vertices. It neglects sharing, which overestimates it, as well as vertex projectors (a few percent beside
/// symmetry planes), springs and inertia.
struct SymmetricDiagonal {
  std::vector<double> cells;   ///< K_cc of the owned cells, `dim` values each
  std::vector<Tensor3> faces;  ///< blocks K_BB of rows.unknown_faces()
};

/// `without` selects the bulk modulus that the operator lacks (VolumeStrain::faces: none). Collective.
SymmetricDiagonal symmetric_diagonal(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                     VolumeStrain without);

}  // namespace couplet::elastic
