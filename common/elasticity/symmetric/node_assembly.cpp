// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/symmetric/node_assembly.hpp"

#include <algorithm>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/fv/nodes.hpp"

namespace couplet {

NodeAssembly::NodeAssembly(const Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh),
      rows_(rows),
      number_(number_nodes(mesh, rows.unknown_faces())),
      stencil_(mesh, rows, number_) {}

/// A face of a tetrahedron couples some sixty nodes, and each pair of nodes shares many faces: summed up here, pair by
/// pair, there is a fiftieth of the entries for PETSc to sort (a tenth of the time on 1000 tetrahedra).
void NodeAssembly::add_block(Index i, Index j, const Tensor3& block) {
  const auto [at, is_new] = slot_of_.try_emplace(std::uint64_t(i) << 32 | std::uint32_t(j), pairs_.size());
  if (is_new) {
    pairs_.push_back({i, j});
    blocks_.push_back(block);
  } else {
    blocks_[at->second] += block;
  }
}

void NodeAssembly::finish_volumes(const std::function<double(Index)>& modulus) {
  for (auto& [c, terms] : volume_of_) {
    std::ranges::sort(terms, {}, &std::pair<Index, Vec3>::first);
    std::vector<std::pair<Index, Vec3>> merged;
    for (const auto& t : terms)
      if (!merged.empty() && merged.back().first == t.first)
        merged.back().second += t.second;
      else
        merged.push_back(t);
    const double bulk = modulus(c);
    for (const auto& [i, g] : merged)
      for (const auto& [j, h] : merged) add_block(i, j, bulk * g * h.transpose());
  }
  volume_of_.clear();
}

void NodeAssembly::add_supports() {
  for (const Index f : rows_.known_faces()) {
    if (rows_.condition(f) != ElasticCondition::support) continue;
    const ElasticSupport& s = rows_.support(f);
    const LameConstants lame = rows_.lame(mesh_.owner[f]);
    const FaceLine line = face_line(mesh_, mesh_.reference, f);
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

SparseMatrix NodeAssembly::matrix() const {
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

}  // namespace couplet
