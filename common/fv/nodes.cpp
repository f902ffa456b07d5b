// SPDX-License-Identifier: Apache-2.0
#include "common/fv/nodes.hpp"

#include "common/parallel/collective.hpp"

namespace couplet::fv {

mesh::Csr flux_faces_of_cells(const mesh::Mesh& mesh) {
  const Index n = mesh.cells.n_owned();
  mesh::Csr result;
  result.offset.assign(n + 1, 0);
  const auto visit = [&](auto&& take) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      if (mesh.owner[f] < n) take(mesh.owner[f], f);
      if (f < mesh.n_interior && mesh.neighbour[f] < n) take(mesh.neighbour[f], f);
    }
  };
  visit([&](Index c, Index) { ++result.offset[c + 1]; });
  for (Index c = 0; c < n; ++c) result.offset[c + 1] += result.offset[c];
  result.index.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  visit([&](Index c, Index f) { result.index[next[c]++] = f; });
  return result;
}

std::vector<GlobalIndex> number_nodes(const mesh::Mesh& mesh, std::span<const Index> faces_with_unknown) {
  const Index n_owned = mesh.cells.n_owned();
  const GlobalIndex first =
      parallel::exclusive_scan(mesh.comm, GlobalIndex(n_owned) + std::ssize(faces_with_unknown));
  std::vector<GlobalIndex> number(mesh.cells.n_local(), -1), boundary(mesh.boundary.n_local(), -1);
  for (Index c = 0; c < n_owned; ++c) number[c] = first + c;
  for (std::size_t i = 0; i < faces_with_unknown.size(); ++i)
    boundary[faces_with_unknown[i] - mesh.n_interior] = first + n_owned + static_cast<GlobalIndex>(i);
  mesh.cells.update_ghosts(std::span<GlobalIndex>(number));
  mesh.boundary.update_ghosts(std::span<GlobalIndex>(boundary));
  for (std::size_t b = 0; b < mesh.twin.size(); ++b)
    if (mesh.twin[b] >= 0 && boundary[b] < 0) boundary[b] = boundary[mesh.twin[b]];
  number.insert(number.end(), boundary.begin(), boundary.end());
  return number;
}

}  // namespace couplet::fv
