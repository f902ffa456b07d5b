// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Which of the rows [first, size) hold each of `n_entries` entries: numbered from 0 at `first`, ascending.
inline Csr transpose(const Csr& rows, Index first, Index n_entries) {
  Csr result;
  result.offset.assign(n_entries + 1, 0);
  for (Index i = first; i < rows.size(); ++i)
    for (const Index e : rows[i]) ++result.offset[e + 1];
  for (Index e = 0; e < n_entries; ++e) result.offset[e + 1] += result.offset[e];
  result.index.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  for (Index i = first; i < rows.size(); ++i)
    for (const Index e : rows[i]) result.index[next[e]++] = i - first;
  return result;
}

}  // namespace couplet::mesh
