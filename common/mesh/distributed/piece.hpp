// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/distributed/block_faces.hpp"
#include "common/mesh/distributed/surroundings.hpp"

namespace couplet::mesh {

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

/// Points of face `face` of a cell in the order of its shape, the one at position `turn` first.
struct FacePoints {
  std::array<Index, 4> points{};
  std::size_t n;
  FacePoints(const RawMesh& raw, Index cell, int face, int turn);
  operator std::span<const Index>() const { return {points.data(), n}; }
};

/// From the piece to this rank's part of the mesh: cells in the order of reverse Cuthill-McKee, copies behind them. `wide`: wide
/// points of the piece; `point_owner`: the rank that owns each of its points. Throws Error if cells and boundary do not fit
/// together. Collective.
LoadedMesh make_part(const PieceSource& source, LocalCells local, Piece piece, const std::vector<Index>& wide,
                     std::vector<int> point_owner);

}  // namespace couplet::mesh
