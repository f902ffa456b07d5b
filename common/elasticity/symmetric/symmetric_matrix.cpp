// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/symmetric_matrix.hpp"

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/node_assembly.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {
namespace {

/// V B_i^T C B_j, B_i making a strain of the displacement of a node.
void add_anisotropic(NodeAssembly& to, const std::vector<FaceStencil::Term>& terms, double volume,
                     const ElasticMatrix& matrix) {
  using Strain = Eigen::Matrix<double, 6, 3>;
  std::vector<Strain> of_node;
  for (const FaceStencil::Term& t : terms) {
    Strain b;
    b << t.b[0], 0, 0, 0, t.b[1], 0, 0, 0, t.b[2], t.b[1], t.b[0], 0, 0, t.b[2], t.b[1], t.b[2], 0, t.b[0];
    of_node.push_back(b * t.turn);
  }
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const Eigen::Matrix<double, 3, 6> left = volume * of_node[i].transpose() * matrix;
    for (std::size_t j = 0; j < terms.size(); ++j)
      to.add_block(terms[i].node, terms[j].node, left * of_node[j]);
  }
}

// V [lambda b_i b_j^T + mu (b_i . b_j I + b_j b_i^T)] between each two nodes.
template <int D>
void add_face(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f, NodeAssembly& to) {
  const mesh::Geometry& geometry = rows.geometry();
  const SymmetricFace<D> face = symmetric_face<D>(mesh, rows, f);
  const Tensor3 identity = Tensor3::Identity();
  const std::vector<FaceStencil::Term>& terms = to.stencil().of<D>(face, f);
  const LameConstants whole = face_lame(mesh, rows, f);
  const auto [mu, lambda] = part_of_faces(whole, rows.volume_strain());
  if (rows.volume_by_cells()) {
    const auto [here, there] = pyramids(mesh, geometry, f);
    for (const FaceStencil::Term& t : terms) {
      to.add_volume_term(mesh.owner[f], t.node, here * (t.turn.transpose() * t.b));
      if (f < mesh.n_interior)
        to.add_volume_term(mesh.neighbour[f], t.node, there * (t.turn.transpose() * t.b));
    }
  }
  if (mesh.owner[f] >= mesh.cells.n_owned()) return;  // its owner's rank adds the rest
  if (rows.is_anisotropic()) return add_anisotropic(to, terms, face.volume, face_matrix(mesh, rows, f));
  for (const FaceStencil::Term& i : terms)
    for (const FaceStencil::Term& j : terms) {
      const Tensor3 block =
          lambda * i.b * j.b.transpose() + mu * (i.b.dot(j.b) * identity + j.b * i.b.transpose());
      to.add_block(i.node, j.node, face.volume * (i.turn.transpose() * block * j.turn));
    }
}

/// The same with the hoop strain, V B_i^T C B_j.
void add_ring(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f, NodeAssembly& to) {
  const AxisymmetricFace face = axisymmetric_face(mesh, rows, f);
  const std::vector<FaceStencil::Term>& terms = to.stencil().of_revolution(face, f);
  const LameConstants lame = face_lame(mesh, rows, f);
  const double mu = face.volume * lame.mu, lambda = face.volume * lame.lambda,
               shear = face.has_shear ? mu : 0;
  for (const FaceStencil::Term& i : terms)
    for (const FaceStencil::Term& j : terms) {
      const double r = i.b[0] + i.b[2], z = i.b[1], other = j.b[0] + j.b[2];
      Tensor3 block = Tensor3::Zero();
      block(0, 0) = lambda * r * other + 2 * mu * (i.b[0] * j.b[0] + i.b[2] * j.b[2]) + shear * z * j.b[1];
      block(0, 1) = lambda * r * j.b[1] + shear * z * j.b[0];
      block(1, 0) = lambda * z * other + shear * i.b[0] * j.b[1];
      block(1, 1) = (lambda + 2 * mu) * z * j.b[1] + shear * i.b[0] * j.b[0];
      to.add_block(i.node, j.node, i.turn.transpose() * block * j.turn);
    }
}

template <int D>
void add_mass(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const double> inertia,
              NodeAssembly& to) {
  SymmetricSpace<D> space(mesh, rows);
  space.set_density(inertia);
  to.add_mass(1, space);
}

}  // namespace

linalg::SparseMatrix symmetric_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const double> inertia) {
  const mesh::Geometry& geometry = rows.geometry();
  NodeAssembly assembly(mesh, rows);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned() && !rows.volume_by_cells()) continue;
    if (is_axisymmetric(rows))
      add_ring(mesh, rows, f, assembly);
    else if (mesh.dim == 2)
      add_face<2>(mesh, rows, f, assembly);
    else
      add_face<3>(mesh, rows, f, assembly);
  }
  const std::vector<double> volume = pyramid_volumes(mesh, geometry);
  assembly.finish_volumes(
      [&](Index c) { return bulk_of_cells(rows.lame(c), rows.volume_strain()) / volume[std::size_t(c)]; });
  assembly.add_supports();
  if (!inertia.empty())
    mesh.dim == 2 ? add_mass<2>(mesh, rows, inertia, assembly) : add_mass<3>(mesh, rows, inertia, assembly);
  return assembly.matrix();
}

}  // namespace couplet::elastic
