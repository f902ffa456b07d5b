// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_matrix.hpp"

#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "common/fv/nodes.hpp"

namespace couplet::elastic {

/// V B_i^T (dP/dF) B_j, and what the nodes change of the cells' volumes.
linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes) {
  const Numbering number{fv::number_nodes(mesh, rows.unknown_faces()), {}};
  Assembly assembly(mesh, rows, number);
  kernel.visit_tangents([&](const FiniteKernel::FaceTangent& tangent) {
    const FaceRows face = face_rows(mesh, rows, tangent.face);
    const FaceTermList& terms = assembly.terms().of_face(face);
    if (rows.volume_by_cells()) assembly.add_volume_terms(tangent.face, terms, tangent.cofactors);
    if (mesh.owner[tangent.face] < mesh.cells.n_owned()) assembly.add(terms, face.volume * tangent.stiffness);
  });
  assembly.finish_volumes([&](Index c) { return kernel.modulus(c); });
  assembly.add_supports();
  assembly.add_diagonals(of_nodes);
  return assembly.matrix(rows.n_unknowns() / std::size_t(mesh.dim));
}

}  // namespace couplet::elastic
