// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Blocks between the nodes of a body, added up pair by pair. A face of a tetrahedron couples some sixty nodes, and each pair of nodes
/// shares many faces: summed up here there is a fiftieth of the entries for PETSc to sort (a tenth of the time on 1000
/// tetrahedra). `Id`: how nodes are counted, below 2^32.
template <class Id>
class BlockPairs {
 public:
  void reserve(std::size_t pairs) { slot_of_.reserve(pairs); }

  void add(Id i, Id j, const Tensor3& block) {
    const auto [at, is_new] = slot_of_.try_emplace(std::uint64_t(i) << 32 | std::uint32_t(j), pairs_.size());
    if (is_new) {
      pairs_.push_back({i, j});
      blocks_.push_back(block);
    } else {
      blocks_[at->second] += block;
    }
  }

  /// modulus g g^T, g by nodes, of which one may stand there several times.
  void add_squares(std::vector<std::pair<Id, Vec3>>& terms, double modulus) {
    std::ranges::sort(terms, {}, &std::pair<Id, Vec3>::first);
    std::vector<std::pair<Id, Vec3>> merged;
    for (const auto& t : terms)
      if (!merged.empty() && merged.back().first == t.first)
        merged.back().second += t.second;
      else
        merged.push_back(t);
    for (const auto& [i, g] : merged)
      for (const auto& [j, h] : merged) add(i, j, modulus * g * h.transpose());
  }

  std::size_t size() const { return pairs_.size(); }
  const std::pair<Id, Id>& pair(std::size_t k) const { return pairs_[k]; }
  const Tensor3& block(std::size_t k) const { return blocks_[k]; }

  /// With `dim` rows a node, number(node) among all; `n_rows`: of this rank. Collective.
  template <class Number>
  linalg::SparseMatrix matrix(MPI_Comm comm, GlobalIndex n_rows, int dim, const Number& number) const {
    std::vector<GlobalIndex> row, column;
    std::vector<double> value;
    for (auto* list : {&row, &column}) list->reserve(size() * std::size_t(dim * dim));
    value.reserve(size() * std::size_t(dim * dim));
    for (std::size_t k = 0; k < size(); ++k)
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b) {
          row.push_back(number(pairs_[k].first) * dim + a);
          column.push_back(number(pairs_[k].second) * dim + b);
          value.push_back(blocks_[k](a, b));
        }
    linalg::SparseMatrix result(comm, n_rows, std::move(row), std::move(column), dim);
    result.fill(value);
    return result;
  }

 private:
  std::unordered_map<std::uint64_t, std::size_t> slot_of_;  // of a pair
  std::vector<std::pair<Id, Id>> pairs_;
  std::vector<Tensor3> blocks_;
};

}  // namespace couplet::elastic
