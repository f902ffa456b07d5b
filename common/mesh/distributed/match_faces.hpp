// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// The points of a face, ascending; after the last one -1.
using FaceKey = std::array<GlobalIndex, 4>;

/// Faults of the faces that this rank has compared, told with their places, which other ranks may have.
struct FaceFaults {
  struct Fault {
    FaceKey face;
    std::function<std::string(const std::string& place)> text;
  };
  std::vector<Fault> faults;
  std::vector<FaceKey> unassigned;               ///< boundary faces without an element
  std::vector<std::pair<FaceKey, int>> orphans;  ///< boundary elements without a cell, and their patches
};

/// Throws the Error that build_faces() throws of such a mesh, on all ranks, if any has found something. Collective.
void throw_face_faults(MPI_Comm comm, const MeshBlock& block, const FaceFaults& found);

/// Describes the fault of a face that more than two cells share. `where`: its middle.
std::string face_of_many_cells(std::size_t cells, const std::string& where);

/// One side of a face: seen from a cell, or from a boundary element (then `cell` is -1 - element).
struct FaceSide {
  FaceKey key;
  GlobalIndex cell;
  int group;           ///< zone of the cell, patch of the element
  std::int8_t face;    ///< position in the cell's shape
  std::int8_t n = 0;   ///< points
  std::uint8_t order;  ///< place in the key of the first four points of the face, two bits each
  bool is_element() const { return cell < 0; }
};
FaceSide make_side(std::span<const GlobalIndex> points, GlobalIndex cell, int group, int face);

/// Two cells that share a face, as each of them is told.
struct FacePair {
  GlobalIndex cell, other;
  int other_zone;
  std::int8_t face, other_face;
  /// Which point of the other's side of the face is the first of the owner's, the cell with the smaller number.
  std::int8_t turn;
};
FacePair make_pair(const FaceSide& cell, const FaceSide& other);

/// A boundary element and the cell that it bounds.
struct BoundedCell {
  GlobalIndex element, cell;
  std::int8_t face;
};

struct MatchedFaces {
  std::vector<FacePair> pairs;       ///< of cells of this rank's share
  std::vector<BoundedCell> bounded;  ///< by elements of this rank's block, ascending
};

/// Sides that have not found their other side in their own block find it at the rank of their smallest point.
/// `first_element`: of each rank's block, and their number. Collective.
MatchedFaces match_faces(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceSide>& sides,
                         const std::vector<GlobalIndex>& first_element);

}  // namespace couplet::mesh
