// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric_matrix.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/face_stencil.hpp"
#include "common/elasticity/symmetric_faces.hpp"
#include "common/fv/nodes.hpp"

namespace couplet {
namespace {

class Assembly {
 public:
  Assembly(const Mesh& mesh, const ElasticOperator& rows)
      : mesh_(mesh),
        rows_(rows),
        number_(number_nodes(mesh, rows.unknown_faces())),
        stencil_(mesh, rows, number_) {}

  template <int D>
  void add_face(Index f);
  void add_anisotropic(const std::vector<FaceStencil::Term>& terms, double volume,
                       const ElasticMatrix& matrix);
  void add_volumes();
  void add_support(Index f);
  void add_diagonal(Index node, double value) { add_block(node, node, value * Tensor3::Identity()); }
  Index node_of(Index f) const { return mesh_.cells.n_local() + f - mesh_.n_interior; }
  SparseMatrix matrix() const;

 private:
  /// A face of a tetrahedron couples some sixty nodes, and each pair of nodes shares many faces: summed up here, pair by
  /// pair, there is a fiftieth of the entries for PETSc to sort (a tenth of the time on 1000 tetrahedra).
  void add_block(Index i, Index j, const Tensor3& block) {
    const auto [at, is_new] = slot_of_.try_emplace(std::uint64_t(i) << 32 | std::uint32_t(j), pairs_.size());
    if (is_new) {
      pairs_.push_back({i, j});
      blocks_.push_back(block);
    } else {
      blocks_[at->second] += block;
    }
  }

  const Mesh& mesh_;
  const ElasticOperator& rows_;
  std::vector<GlobalIndex> number_;
  FaceStencil stencil_;
  std::unordered_map<std::uint64_t, std::size_t> slot_of_;  // of a pair of nodes
  std::vector<std::pair<Index, Index>> pairs_;
  std::vector<Tensor3> blocks_;
  std::map<Index, std::vector<std::pair<Index, Vec3>>>
      volume_of_;  // of cells: volume strain times V, by nodes
};

// V [lambda b_i b_j^T + mu (b_i . b_j I + b_j b_i^T)] between each two nodes.
template <int D>
void Assembly::add_face(Index f) {
  const SymmetricFace<D> face = symmetric_face<D>(mesh_, rows_, f);
  const Tensor3 identity = Tensor3::Identity();
  const std::vector<FaceStencil::Term>& terms = stencil_.of<D>(face, f);
  const LameConstants whole = face_lame(mesh_, rows_, f);
  const auto [mu, lambda] = rows_.volume_by_cells() ? deviatoric(whole) : whole;
  if (rows_.volume_by_cells()) {
    const auto [here, there] = pyramids(mesh_, f);
    for (const FaceStencil::Term& t : terms) {
      volume_of_[mesh_.owner[f]].push_back({t.node, here * (t.turn.transpose() * t.b)});
      if (f < mesh_.n_interior)
        volume_of_[mesh_.neighbour[f]].push_back({t.node, there * (t.turn.transpose() * t.b)});
    }
  }
  if (rows_.is_anisotropic()) return add_anisotropic(terms, face.volume, face_matrix(mesh_, rows_, f));
  for (const FaceStencil::Term& i : terms)
    for (const FaceStencil::Term& j : terms) {
      const Tensor3 block =
          lambda * i.b * j.b.transpose() + mu * (i.b.dot(j.b) * identity + j.b * i.b.transpose());
      add_block(i.node, j.node, face.volume * (i.turn.transpose() * block * j.turn));
    }
}

/// V B_i^T C B_j, B_i making a strain of the displacement of a node.
void Assembly::add_anisotropic(const std::vector<FaceStencil::Term>& terms, double volume,
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
    for (std::size_t j = 0; j < terms.size(); ++j) add_block(terms[i].node, terms[j].node, left * of_node[j]);
  }
}

/// K / V g g^T with the g of V tr e = g . u, of this rank's faces.
void Assembly::add_volumes() {
  for (auto& [c, terms] : volume_of_) {
    std::ranges::sort(terms, {}, &std::pair<Index, Vec3>::first);
    std::vector<std::pair<Index, Vec3>> merged;
    for (const auto& t : terms)
      if (!merged.empty() && merged.back().first == t.first)
        merged.back().second += t.second;
      else
        merged.push_back(t);
    const double bulk = bulk_modulus(rows_.lame(c)) / mesh_.reference.volume[c];
    for (const auto& [i, g] : merged)
      for (const auto& [j, h] : merged) add_block(i, j, bulk * g * h.transpose());
  }
  volume_of_.clear();
}

/// s P on the rows of supports; springs at the face's node alone, which a preconditioner may.
void Assembly::add_support(Index f) {
  const ElasticSupport& s = rows_.support(f);
  const LameConstants lame = rows_.lame(mesh_.owner[f]);
  const FaceLine line = face_line(mesh_, mesh_.reference, f);
  const Tensor3 open = Tensor3::Identity() - s.known;
  add_block(node_of(f), node_of(f),
            (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn * s.known +
                line.area * open * s.spring * open);
}

SparseMatrix Assembly::matrix() const {
  const int dim = mesh_.dim;
  std::vector<GlobalIndex> row, column;
  std::vector<double> value;
  for (auto* list : {&row, &column}) list->reserve(pairs_.size() * dim * dim);
  value.reserve(pairs_.size() * dim * dim);
  for (std::size_t k = 0; k < pairs_.size(); ++k)
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b) {
        row.push_back(number_[pairs_[k].first] * dim + a);
        column.push_back(number_[pairs_[k].second] * dim + b);
        value.push_back(blocks_[k](a, b));
      }
  SparseMatrix matrix(mesh_.comm, static_cast<GlobalIndex>(rows_.n_unknowns()), std::move(row),
                      std::move(column), dim);
  matrix.fill(value);
  return matrix;
}

}  // namespace

SparseMatrix symmetric_matrix(const Mesh& mesh, const ElasticOperator& rows,
                              std::span<const double> of_nodes) {
  Assembly assembly(mesh, rows);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    if (mesh.dim == 2)
      assembly.add_face<2>(f);
    else
      assembly.add_face<3>(f);
  }
  assembly.add_volumes();
  for (const Index f : rows.known_faces())
    if (rows.condition(f) == ElasticCondition::support) assembly.add_support(f);
  for (Index c = 0; c < mesh.cells.n_owned() && !of_nodes.empty(); ++c) assembly.add_diagonal(c, of_nodes[c]);
  for (std::size_t i = 0; i < rows.unknown_faces().size() && !of_nodes.empty(); ++i)
    assembly.add_diagonal(assembly.node_of(rows.unknown_faces()[i]),
                          of_nodes[std::size_t(mesh.cells.n_owned()) + i]);
  return assembly.matrix();
}

}  // namespace couplet
