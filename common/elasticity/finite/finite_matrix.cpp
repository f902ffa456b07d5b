// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/finite/finite_matrix.hpp"

#include "common/elasticity/symmetric/node_assembly.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {
namespace {

/// V B_i^T (dP/dF) B_j, and what the nodes change of the cells' volumes.
template <int D>
void add_face(const mesh::Mesh& mesh, const ElasticOperator& rows, const FiniteKernel::FaceTangent& tangent,
              NodeAssembly& to) {
  const mesh::Geometry& geometry = rows.geometry();
  const Index f = tangent.face;
  const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
  const std::vector<FaceStencil::Term>& terms = to.stencil().of<D>(face, f);
  if (rows.volume_by_cells()) {
    const auto [here, there] = pyramids(mesh, geometry, f);
    for (const FaceStencil::Term& t : terms) {
      const Vec3 g = t.turn.transpose() * (tangent.cofactors * t.b);
      to.add_volume_term(mesh.owner[f], t.node, here * g);
      if (f < mesh.n_interior) to.add_volume_term(mesh.neighbour[f], t.node, there * g);
    }
  }
  if (mesh.owner[f] >= mesh.cells.n_owned()) return;  // its owner's rank adds the rest
  for (const FaceStencil::Term& i : terms) {
    Eigen::Matrix<double, 3, 9> left = Eigen::Matrix<double, 3, 9>::Zero();
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < D; ++a) left.row(k) += face.volume * i.b[a] * tangent.stiffness.row(k * 3 + a);
    left = (i.turn.transpose() * left).eval();
    for (const FaceStencil::Term& j : terms) {
      Tensor3 block = Tensor3::Zero();
      for (int m = 0; m < 3; ++m)
        for (int a = 0; a < D; ++a) block.col(m) += j.b[a] * left.col(m * 3 + a);
      to.add_block(i.node, j.node, block * j.turn);
    }
  }
}

}  // namespace

linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes) {
  NodeAssembly assembly(mesh, rows);
  kernel.visit_tangents([&](const FiniteKernel::FaceTangent& tangent) {
    if (mesh.dim == 2)
      add_face<2>(mesh, rows, tangent, assembly);
    else
      add_face<3>(mesh, rows, tangent, assembly);
  });
  assembly.finish_volumes([&](Index c) { return kernel.modulus(c); });
  assembly.add_supports();
  assembly.add_diagonals(of_nodes);
  return assembly.matrix();
}

}  // namespace couplet::elastic
