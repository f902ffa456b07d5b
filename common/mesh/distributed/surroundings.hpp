// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/block_faces.hpp"
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

/// Part of a mesh from which a rank makes its piece.
struct PieceSource {
  MPI_Comm comm;
  const MeshBlock& block;  ///< its cells may be gone
  const BlockGraph& graph;
};

/// Own cells and the copies around them as a small mesh: its cells are those of LocalCells, its points have numbers
/// of their own.
struct Piece {
  RawMesh raw;  ///< boundary faces of all cells, also those between materials, by their number in the mesh
  std::vector<Index> boundary_cell;          ///< per boundary face
  std::vector<GlobalIndex> boundary_number;  ///< per boundary face: number in the mesh, ascending
  std::vector<GlobalIndex> point_number;     ///< per point: number in the mesh, ascending
  std::vector<int> cell_material;            ///< empty with one material
};

/// Collective.
Piece make_piece(const PieceSource& source, const CellList& cells);

/// Points of the piece after the rule of Mesh::wide_points, ascending; right where all cells around a point are there.
std::vector<Index> wide_points(const Piece& piece);

/// From the piece to this rank's part of the mesh: cells in the order of reverse Cuthill-McKee, copies behind them. `wide`: wide
/// points of the piece; `point_owner`: the rank that owns each of its points. Throws Error if cells and boundary do not fit
/// together. Collective.
LoadedMesh make_part(const PieceSource& source, LocalCells local, Piece piece, const std::vector<Index>& wide,
                     std::vector<int> point_owner);

}  // namespace couplet::mesh
