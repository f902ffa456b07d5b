// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/partition.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>

extern "C" {
#include <ptscotch.h>  // needs FILE
}

#include "common/base/error.hpp"
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

// Maximum excess of a part over the mean, as in PETSc's partitioner.
constexpr double imbalance = 0.01;

void check(int failed) {
  if (failed != 0) throw Error("Scotch could not divide the mesh.");
}

/// Partitions this rank's rows of the graph into `parts`. Scotch's functions take arrays without const.
std::vector<int> apply_ptscotch(MPI_Comm comm, GlobalIndex n_all, std::span<const Index> offset,
                                std::span<const GlobalIndex> neighbours, int parts) {
  // With several threads Scotch 7 is not deterministic, so a restart would not be bit for bit.
  setenv("SCOTCH_PTHREAD_NUMBER", "1", 1);
  // Resets Scotch's random numbers, so that a second mesh of a process is partitioned reproducibly.
  SCOTCH_randomReset();
  const auto n = static_cast<SCOTCH_Num>(offset.size()) - 1;
  std::vector<SCOTCH_Num> rows(offset.begin(), offset.end()), columns(neighbours.begin(), neighbours.end());
  columns.resize(std::max<std::size_t>(1, columns.size()));
  std::vector<SCOTCH_Num> part(std::max<SCOTCH_Num>(1, n));
  SCOTCH_Arch parts_of_all;
  SCOTCH_Strat strategy;
  check(SCOTCH_archInit(&parts_of_all));
  check(SCOTCH_archCmplt(&parts_of_all, parts));
  check(SCOTCH_stratInit(&strategy));
  if (n == n_all) {
    SCOTCH_Graph graph;
    check(SCOTCH_graphInit(&graph));
    check(SCOTCH_graphBuild(&graph, 0, n, rows.data(), rows.data() + 1, nullptr, nullptr, rows[n],
                            columns.data(), nullptr));
    check(SCOTCH_stratGraphMapBuild(&strategy, SCOTCH_STRATDEFAULT, parts, imbalance));
    check(SCOTCH_graphMap(&graph, &parts_of_all, &strategy, part.data()));
    SCOTCH_graphExit(&graph);
  } else if (!parallel::any(comm, n == n_all)) {
    MPI_Comm own = MPI_COMM_NULL;  // Scotch stores attributes at its communicator
    MPI_Comm_dup(comm, &own);
    SCOTCH_Dgraph graph;
    check(SCOTCH_dgraphInit(&graph, own));
    check(SCOTCH_dgraphBuild(&graph, 0, n, n, rows.data(), rows.data() + 1, nullptr, nullptr, rows[n],
                             rows[n], columns.data(), nullptr, nullptr));
    check(SCOTCH_stratDgraphMapBuild(&strategy, SCOTCH_STRATDEFAULT, parts, parts, imbalance));
    check(SCOTCH_dgraphMap(&graph, &parts_of_all, &strategy, part.data()));
    SCOTCH_dgraphExit(&graph);
    MPI_Comm_free(&own);
  }
  SCOTCH_stratExit(&strategy);
  SCOTCH_archExit(&parts_of_all);
  return {part.begin(), part.begin() + n};
}

}  // namespace

std::vector<int> partition(MPI_Comm comm, std::span<const Index> offset,
                           std::span<const GlobalIndex> neighbours, int parts) {
  const auto n = static_cast<Index>(offset.size()) - 1;
  const GlobalIndex n_all = parallel::sum(comm, GlobalIndex(n));
  if (n_all > std::numeric_limits<SCOTCH_Num>::max())
    throw Error(
        "The mesh has {} cells, more than this build of Scotch can number ({}). Build with a Scotch of 64-bit "
        "integers.",
        n_all, std::numeric_limits<SCOTCH_Num>::max());
  if (parallel::max(comm, GlobalIndex(n)) < n_all)
    return apply_ptscotch(comm, n_all, offset, neighbours, parts);
  return n == 0 ? std::vector<int>() : apply_ptscotch(MPI_COMM_SELF, n_all, offset, neighbours, parts);
}

namespace {

/// Nodes reachable from `start`, breadth first, neighbors by ascending degree. Marks them with `stamp`.
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
    // The last node of a breadth-first search is far out. Two searches give a start near an end of the graph.
    breadth_first(graph, seed, 1, mark, component);
    breadth_first(graph, component.back(), 2, mark, component);
    breadth_first(graph, component.back(), 3, mark, component);
    result.insert(result.end(), component.begin(), component.end());
  }
  std::reverse(result.begin(), result.end());
  return result;
}

}  // namespace couplet::mesh
