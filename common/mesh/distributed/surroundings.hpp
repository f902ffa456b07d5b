// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/mesh_block.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::mesh {

/// Face adjacency of the cells of the block.
struct BlockGraph {
  /// Two cells of the block that share a face.
  struct CellPair {
    Index cell, other;
    std::int8_t face;  ///< position in `cell`, which has the smaller number
    bool bonded;
  };
  std::vector<Index> offset;
  std::vector<GlobalIndex> neighbours;
  GlobalIndex first_bonded = -1;  ///< number of the first boundary face that is a side of a bonded one, or -1
  std::vector<CellPair> within;  ///< pairs on one rank, to avoid a second search; `neighbours` is empty there
  std::vector<Vec3> translation;  ///< of each pair of periodic patches, from the first to the second
};

/// Orients inverted cells, matches the faces of all blocks, joins periodic patches and fills the records of
/// the block's cells. The block's boundary elements are removed. Throws Error with the location of a cell
/// without volume, a boundary face in two patches, a boundary element that is not a boundary face, a
/// face of more than two cells, or a periodic face without a partner. Collective.
BlockGraph find_block_faces(MPI_Comm comm, MeshBlock& block);

/// Ranks that have cells at a point. Each rank stores the points of its share.
class PointDirectory {
 public:
  /// Builds the directory. `points` are those of this rank's own cells, ascending. Collective.
  PointDirectory(MPI_Comm comm, const Shares& shares, const std::vector<GlobalIndex>& points);
  /// Ranks at each of these points. Both lists are ascending. Collective.
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

/// Sends the cells of the blocks to the ranks that own them, in ascending order, and removes them from the
/// blocks. `part` holds the rank of each cell of the block. Collective.
CellList send_to_owners(MPI_Comm comm, MeshBlock& block, std::span<const int> part);

/// Own cell and the rank of the cell across its periodic face.
struct CellAcross {
  Index cell;
  int rank;
};
/// Finds the cells across periodic faces. `part` is as for send_to_owners(). Collective.
std::vector<CellAcross> cells_across(MPI_Comm comm, const Shares& shares, std::span<const int> part,
                                     const CellList& own);

/// Own cells and one ring of copies: the cells of other ranks that share a point or a periodic face
/// (`across`) with an own cell. Collective.
LocalCells with_one_ring(MPI_Comm comm, CellList own, const std::vector<GlobalIndex>& own_points,
                         const PointDirectory& directory, const std::vector<CellAcross>& across);

/// Adds the cells of other ranks that have one of these points, given in ascending order. Collective.
void add_cells_at(MPI_Comm comm, const std::vector<GlobalIndex>& points, const PointDirectory& directory,
                  LocalCells& local);

/// Data from which a rank makes its piece.
struct PieceSource {
  MPI_Comm comm;
  const MeshBlock& block;  ///< its cells may have been removed
  const BlockGraph& graph;
};

/// Own cells and the copies around them as a small mesh. Its cells are those of LocalCells; its points are
/// renumbered.
struct Piece {
  RawMesh raw;  ///< with boundary faces of all cells, also between materials, by mesh number
  std::vector<Index> boundary_cell;          ///< per boundary face
  std::vector<GlobalIndex> boundary_number;  ///< per boundary face: number in the mesh, ascending
  std::vector<GlobalIndex> point_number;     ///< per point: number in the mesh, ascending
  std::vector<int> cell_material;            ///< empty with one material
};

/// Makes the piece of this rank. Collective.
Piece make_piece(const PieceSource& source, const CellList& cells);

/// Wide points of the piece (see Mesh::wide_points), ascending. Exact if all cells around a point are there.
std::vector<Index> wide_points(const Piece& piece);

/// Makes this rank's part of the mesh: own cells in reverse Cuthill-McKee order, then copies. `wide` are the
/// wide points of the piece, `point_owner` holds the rank that owns each of its points. Throws Error if cells
/// and boundary do not fit together. Collective.
LoadedMesh make_part(const PieceSource& source, LocalCells local, Piece piece, const std::vector<Index>& wide,
                     std::vector<int> point_owner);

}  // namespace couplet::mesh
