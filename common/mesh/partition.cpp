// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/partition.hpp"

#include <petscmat.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>

extern "C" {
#include <scotch.h>  // needs FILE
}

#include "common/base/error.hpp"
#include "common/linalg/petsc_check.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {

Csr make_graph(Index n, std::span<const Index> first, std::span<const Index> second) {
  Csr graph;
  graph.offset.assign(n + 1, 0);
  for (std::size_t e = 0; e < first.size(); ++e) {
    ++graph.offset[first[e] + 1];
    ++graph.offset[second[e] + 1];
  }
  std::partial_sum(graph.offset.begin(), graph.offset.end(), graph.offset.begin());
  graph.index.resize(graph.offset.back());
  std::vector<Index> next(graph.offset.begin(), graph.offset.end() - 1);
  for (std::size_t e = 0; e < first.size(); ++e) {
    graph.index[next[first[e]]++] = second[e];
    graph.index[next[second[e]]++] = first[e];
  }
  for (Index i = 0; i < n; ++i)
    std::sort(graph.index.begin() + graph.offset[i], graph.index.begin() + graph.offset[i + 1]);
  return graph;
}

namespace {

/// Rows of the graph that this rank has, into `parts` parts.
std::vector<int> apply_ptscotch(MPI_Comm comm, GlobalIndex n_all, std::span<const Index> offset,
                                std::span<const GlobalIndex> neighbours, int parts) {
  // With several threads Scotch 7 gives another partition each time, and a restart would not be bit for bit.
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);
  // Scotch goes on in its row of random numbers: a second mesh of a process would be shared out in another way.
  SCOTCH_randomReset();
  const auto n = static_cast<PetscInt>(offset.size()) - 1;
  // PETSc frees both arrays with the matrix.
  PetscInt *rows = nullptr, *columns = nullptr;
  linalg::petsc_check(PetscMalloc1(n + 1, &rows));
  linalg::petsc_check(PetscMalloc1(std::max<std::size_t>(1, neighbours.size()), &columns));
  std::copy(offset.begin(), offset.end(), rows);
  std::transform(neighbours.begin(), neighbours.end(), columns,
                 [](auto i) { return static_cast<PetscInt>(i); });
  Mat adjacency = nullptr;
  MatPartitioning tool = nullptr;
  IS result = nullptr;
  linalg::petsc_check(
      MatCreateMPIAdj(comm, n, static_cast<PetscInt>(n_all), rows, columns, nullptr, &adjacency));
  linalg::petsc_check(MatPartitioningCreate(comm, &tool));
  linalg::petsc_check(MatPartitioningSetType(tool, MATPARTITIONINGPTSCOTCH));
  linalg::petsc_check(MatPartitioningSetAdjacency(tool, adjacency));
  linalg::petsc_check(MatPartitioningSetNParts(tool, parts));
  linalg::petsc_check(MatPartitioningApply(tool, &result));
  const PetscInt* part = nullptr;
  linalg::petsc_check(ISGetIndices(result, &part));
  std::vector<int> parts_of(part, part + n);
  linalg::petsc_check(ISRestoreIndices(result, &part));
  linalg::petsc_check(ISDestroy(&result));
  linalg::petsc_check(MatPartitioningDestroy(&tool));
  linalg::petsc_check(MatDestroy(&adjacency));
  return parts_of;
}

}  // namespace

std::vector<int> partition(MPI_Comm comm, std::span<const Index> offset,
                           std::span<const GlobalIndex> neighbours, int parts) {
  const auto n = static_cast<Index>(offset.size()) - 1;
  const GlobalIndex n_all = parallel::sum(comm, GlobalIndex(n));
  if (n_all > std::numeric_limits<PetscInt>::max())
    throw Error(
        "The mesh has {} cells, more than this build of PETSc can number ({}). Build with a PETSc of 64-bit "
        "integers.",
        n_all, std::numeric_limits<PetscInt>::max());
  if (parallel::max(comm, GlobalIndex(n)) < n_all)
    return apply_ptscotch(comm, n_all, offset, neighbours, parts);
  return n == 0 ? std::vector<int>() : apply_ptscotch(PETSC_COMM_SELF, n_all, offset, neighbours, parts);
}

namespace {

/// Nodes reachable from `start`, breadth first, neighbours by ascending degree; marks them with `stamp`.
void breadth_first(const Csr& graph, Index start, int stamp, std::vector<int>& mark,
                   std::vector<Index>& order) {
  order.assign(1, start);
  mark[start] = stamp;
  std::vector<Index> next;
  for (std::size_t at = 0; at < order.size(); ++at) {
    next.clear();
    for (const Index n : graph[order[at]]) {
      if (mark[n] == stamp) continue;
      mark[n] = stamp;
      next.push_back(n);
    }
    std::stable_sort(next.begin(), next.end(),
                     [&](Index a, Index b) { return graph[a].size() < graph[b].size(); });
    order.insert(order.end(), next.begin(), next.end());
  }
}

}  // namespace

std::vector<Index> reverse_cuthill_mckee(const Csr& graph) {
  const Index n = graph.size();
  std::vector<Index> result, component;
  result.reserve(n);
  std::vector<int> mark(n, 0);
  for (Index seed = 0; seed < n; ++seed) {
    if (mark[seed] != 0) continue;
    // The last node of a breadth-first walk lies far out; two walks give a start near an end of the graph.
    breadth_first(graph, seed, 1, mark, component);
    breadth_first(graph, component.back(), 2, mark, component);
    breadth_first(graph, component.back(), 3, mark, component);
    result.insert(result.end(), component.begin(), component.end());
  }
  std::reverse(result.begin(), result.end());
  return result;
}

}  // namespace couplet::mesh
