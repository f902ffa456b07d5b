// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/node_assembly.hpp"

#include <algorithm>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/fv/nodes.hpp"

namespace couplet::elastic {

NodeAssembly::NodeAssembly(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      number_(fv::number_nodes(mesh, rows.unknown_faces())),
      stencil_(mesh, rows, number_) {}

void NodeAssembly::finish_volumes(const std::function<double(Index)>& modulus) {
  for (auto& [c, terms] : volume_of_) pairs_.add_squares(terms, modulus(c));
  volume_of_.clear();
}

void NodeAssembly::add_supports() {
  for (const Index f : rows_.known_faces()) {
    const BoundaryRow& s = rows_.at(f);
    if (s.fixed) continue;
    const LameConstants lame = rows_.lame(mesh_.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh_, geometry_, f);
    const Tensor3 open = Tensor3::Identity() - s.known;
    add_block(node_of(f), node_of(f),
              (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * s.known +
                  line.area * open * s.spring * open);
  }
}

void NodeAssembly::add_diagonals(std::span<const double> of_nodes) {
  if (of_nodes.empty()) return;
  const Index n_cells = mesh_.cells.n_owned();
  for (Index c = 0; c < n_cells; ++c) add_diagonal(c, of_nodes[c]);
  for (std::size_t i = 0; i < rows_.unknown_faces().size(); ++i)
    add_diagonal(node_of(rows_.unknown_faces()[i]), of_nodes[std::size_t(n_cells) + i]);
}

template <int D>
void NodeAssembly::add_mass(double factor, const SymmetricSpace<D>& space) {
  for (Index i = 0; i < Index(number_.size()); ++i) {
    const double mass = factor * space.node_mass()[std::size_t(i)];
    if (number_[i] < 0 || mass == 0) continue;
    Tensor3 open = Tensor3::Identity();
    if (i >= mesh_.cells.n_local()) open -= rows_.at(i - mesh_.cells.n_local() + mesh_.n_interior).known;
    add_block(i, i, mass * open);
  }
  for (Index v = 0; v < mesh_.points.n_local(); ++v) {
    const double mass = factor * space.point_mass()[std::size_t(v)];
    if (mass == 0) continue;
    const std::vector<FaceStencil::Term>& terms = stencil_.of_point(v);
    for (const FaceStencil::Term& i : terms)
      for (const FaceStencil::Term& j : terms)
        add_block(i.node, j.node, mass * i.b[0] * j.b[0] * (i.turn.transpose() * j.turn));
  }
}

template void NodeAssembly::add_mass<2>(double, const SymmetricSpace<2>&);
template void NodeAssembly::add_mass<3>(double, const SymmetricSpace<3>&);

linalg::SparseMatrix NodeAssembly::matrix() const {
  return pairs_.matrix(mesh_.comm, static_cast<GlobalIndex>(rows_.n_unknowns()), mesh_.dim,
                       [this](Index node) { return number_[node]; });
}

}  // namespace couplet::elastic
