// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/mesh/distributed/mesh_block.hpp"

namespace couplet::mesh {

/// Points of a face in ascending order, padded with -1.
using FaceKey = std::array<GlobalIndex, 4>;

/// Fault of a face, as known by the rank that found it. Its points may be on other ranks.
struct FaceFault {
  enum class Kind { many_cells, inside, two_patches, orphan };
  Kind kind;
  FaceKey face;
  int patch = 0, other = 0;  ///< patches of its boundary elements
};
/// Throws an Error on all ranks with the location of the first fault, if any rank found one. Collective.
void throw_face_faults(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceFault>& found);

/// Describes the fault of a face that more than two cells share. `where` is its center.
std::string face_of_many_cells(GlobalIndex cells, const std::string& where);

/// One side of a face, seen from a cell or from a boundary element (then `cell` is -1 - element).
struct FaceSide {
  FaceKey key;
  GlobalIndex cell;
  int group;           ///< zone of the cell or patch of the element
  std::int8_t face;    ///< position in the cell's shape
  std::int8_t n = 0;   ///< number of points
  std::uint8_t order;  ///< positions in the key of the first four points of the face, two bits each
  bool is_element() const { return cell < 0; }
};
FaceSide make_side(std::span<const GlobalIndex> points, GlobalIndex cell, int group, int face);

/// Two cells that share a face, as reported to each of them.
struct FacePair {
  GlobalIndex cell, other;
  int other_zone;
  std::int8_t face, other_face;
  /// Point of the other side that is first on the owner's side (the cell with the smaller number).
  std::int8_t turn;
};
FacePair make_pair(const FaceSide& cell, const FaceSide& other);

/// Boundary element and the cell that it bounds.
struct BoundedCell {
  GlobalIndex element, cell;
  std::int8_t face;
};

struct MatchedFaces {
  std::vector<FacePair> pairs;       ///< for cells of this rank's share
  std::vector<BoundedCell> bounded;  ///< for elements of this rank's block, ascending
  /// Sides of boundary faces without an element, of cells of this rank's share, by cell and face.
  std::vector<FaceSide> unnamed;
};

/// Matches sides. Those without a partner in their own block are matched on the rank of their smallest point.
/// `first_element` holds the first element of each rank's block and the total number. Collective.
MatchedFaces match_faces(MPI_Comm comm, const MeshBlock& block, const std::vector<FaceSide>& sides,
                         const std::vector<GlobalIndex>& first_element);

/// Boundary face that is joined with one of the other patch of its pair.
struct JoinedFace {
  GlobalIndex element, cell, other;  ///< boundary element, its cell, the cell across
  std::int8_t face;                  ///< position in the cell's shape
  std::int8_t side;                  ///< 0 on the first patch of the pair, 1 on the second
  int pair;                          ///< index into MeshBlock::periodic
};

struct PeriodicFaces {
  std::vector<JoinedFace> joined;  ///< for this rank's boundary elements, ascending
  std::vector<Vec3> translation;   ///< of each pair, from its first patch to its second
};

/// Joins the faces of periodic patches by their centers. Each rank sees all of these faces. Throws Error with
/// the location of a face without a partner. `first_element` is that of this rank's block. Collective.
PeriodicFaces find_periodic_faces(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<BoundedCell>& bounded, GlobalIndex first_element);

}  // namespace couplet::mesh
