// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/sparse_map.hpp"

#include <cassert>

namespace couplet::coupler {

void SparseMap::push_row(std::span<const Index> sources, std::span<const double> weights) {
  assert(sources.size() == weights.size());
  source.insert(source.end(), sources.begin(), sources.end());
  weight.insert(weight.end(), weights.begin(), weights.end());
  offset.push_back(source.size());
}

std::vector<double> SparseMap::apply(std::span<const double> values, int components) const {
  assert(values.size() == n_from * std::size_t(components));
  const auto n = std::size_t(components);
  std::vector<double> result(n_to() * n, 0.);
  for (std::size_t i = 0; i < n_to(); ++i)
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k)
      for (std::size_t c = 0; c < n; ++c)
        result[i * n + c] += weight[k] * values[std::size_t(source[k]) * n + c];
  return result;
}

SparseMap SparseMap::transposed() const {
  SparseMap t;
  t.n_from = n_to();
  t.offset.assign(n_from + 1, 0);
  for (const Index s : source) ++t.offset[std::size_t(s) + 1];
  for (std::size_t i = 0; i < n_from; ++i) t.offset[i + 1] += t.offset[i];
  t.source.resize(source.size());
  t.weight.resize(source.size());
  std::vector<std::size_t> next(t.offset.begin(), t.offset.end() - 1);
  for (std::size_t i = 0; i < n_to(); ++i)
    for (std::size_t k = offset[i]; k < offset[i + 1]; ++k) {
      const std::size_t place = next[source[k]]++;
      t.source[place] = Index(i);
      t.weight[place] = weight[k];
    }
  return t;
}

}  // namespace couplet::coupler
