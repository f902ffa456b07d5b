// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// The points of a face, ascending; after the last one -1.
using FaceKey = std::array<GlobalIndex, 4>;

/// A fault of a face, as far as the rank that found it knows; its points may be on other ranks.
struct FaceFault {
  enum class Kind { many_cells, inside, two_patches, orphan, unassigned };
  Kind kind;
  FaceKey face;
  int patch = 0, other = 0;  ///< of its boundary elements
  GlobalIndex cells = 0;     ///< that share it
};
/// Throws an Error with the place of the first fault, on all ranks, if any has found one. Collective.
void throw_face_faults(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceFault>& found);

/// Describes the fault of a face that more than two cells share. `where`: its middle.
std::string face_of_many_cells(GlobalIndex cells, const std::string& where);

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

/// A boundary face that is joined with one of the other patch of its pair.
struct JoinedFace {
  GlobalIndex element, cell, other;  ///< boundary element, its cell, the cell beyond
  std::int8_t face;                  ///< position in the cell's shape
  std::int8_t side;                  ///< 0: on the first patch of the pair, 1: on the second
  int pair;                          ///< of MeshBlock::periodic
};

struct PeriodicFaces {
  std::vector<JoinedFace> joined;  ///< of this rank's boundary elements, ascending
  std::vector<Vec3> translation;   ///< of each pair, from its first patch to its second
};

/// Joins the faces of periodic patches by their centers. Each rank sees all faces of these patches, which are few beside the
/// cells. Throws Error naming the place of a face without a partner. `first_element`: of this rank's block. Collective.
PeriodicFaces find_periodic_faces(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<BoundedCell>& bounded, GlobalIndex first_element);

}  // namespace couplet::mesh
