// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/cell_list.hpp"
#include "common/mesh/distributed/mesh_block.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Which ranks have cells at which points, kept by each rank for the points of its share.
class PointDirectory {
 public:
  /// `points`: of this rank's own cells, ascending. Collective.
  PointDirectory(MPI_Comm comm, const Shares& shares, const std::vector<GlobalIndex>& points);
  /// The ranks at each of these points, ascending both. Collective.
  Csr ranks_at(const std::vector<GlobalIndex>& points) const;

 private:
  MPI_Comm comm_;
  Shares shares_;
  GlobalIndex first_;
  Csr ranks_;
};

/// This rank's cells and copies of those around them.
struct LocalCells {
  CellList cells;          ///< in ascending order of their numbers
  std::vector<int> owner;  ///< rank that owns each
};

/// Sends the cells of the blocks, which are gone then, to the ranks that own them (`part`, of each cell of the block), in ascending
/// order. Collective.
CellList send_to_owners(MPI_Comm comm, MeshBlock& block, std::span<const int> part);

/// Own cell `cell` and the rank of the one beyond its periodic face.
struct CellAcross {
  Index cell;
  int rank;
};
/// `part`: as for send_to_owners(). Collective.
std::vector<CellAcross> cells_across(MPI_Comm comm, const Shares& shares, std::span<const int> part,
                                     const CellList& own);

/// Own cells and one ring of copies: the cells of other ranks that share a point, or a periodic face (`across`), with an own
/// one. Collective.
LocalCells with_one_ring(MPI_Comm comm, CellList own, const std::vector<GlobalIndex>& own_points,
                         const PointDirectory& directory, const std::vector<CellAcross>& across);

/// Adds the cells of other ranks that have one of these points, ascending. Collective.
void add_cells_at(MPI_Comm comm, const std::vector<GlobalIndex>& points, const PointDirectory& directory,
                  LocalCells& local);

}  // namespace couplet::mesh
