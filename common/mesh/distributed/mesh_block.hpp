// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/load.hpp"
#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {

/// Even distribution of the numbers 0 .. n - 1 over the first `holders` ranks. It determines where data of an
/// entity are stored before a rank owns it.
struct Shares {
  GlobalIndex n = 0;
  int ranks = 1;
  int holders = ranks;
  GlobalIndex first(int rank) const {
    rank = std::min(rank, holders);
    return n / holders * rank + std::min<GlobalIndex>(rank, n % holders);
  }
  GlobalIndex count(int rank) const { return first(rank + 1) - first(rank); }
  int rank_of(GlobalIndex i) const {
    const GlobalIndex least = n / holders, larger = n % holders, in_larger = (least + 1) * larger;
    return static_cast<int>(i < in_larger ? i / (least + 1) : larger + (i - in_larger) / least);
  }
};

/// Packs `numbers`, which must be ascending, as parcels for the ranks that hold them.
inline parallel::Parcels<GlobalIndex> by_share(const Shares& shares, std::vector<GlobalIndex> numbers) {
  parallel::Parcels<GlobalIndex> parcels;
  for (int r = 0; r <= shares.ranks; ++r)
    parcels.first.push_back(
        std::size_t(std::ranges::lower_bound(numbers, shares.first(r)) - numbers.begin()));
  parcels.items = std::move(numbers);
  return parcels;
}

/// Fetches the values at these ascending numbers. `mine` holds those of this rank's share. Collective.
template <class T>
std::vector<T> fetch(MPI_Comm comm, const Shares& shares, std::span<const T> mine,
                     const std::vector<GlobalIndex>& numbers) {
  const auto asked = parallel::exchange(comm, by_share(shares, numbers));
  const GlobalIndex first = shares.first(parallel::comm_rank(comm));
  parallel::Parcels<T> answers{{}, asked.first};
  answers.items.reserve(asked.items.size());
  for (const GlobalIndex i : asked.items) answers.items.push_back(mine[i - first]);
  return std::move(parallel::exchange(comm, answers).items);
}

/// Face of a cell that no other cell shares, or that is bonded or periodic.
struct FaceRecord {
  std::int8_t face = 0;  ///< position among the faces of the cell's shape
  std::int8_t turn = 0;  ///< bonded: position of the cell's point that comes first on the face
  int patch = 0;
  GlobalIndex number = 0;  ///< number of the boundary face

  // For a periodic face `patch` encodes the pair of patches that it joins and its side. `number` is then the
  // cell across the face.
  static int joined(int pair, int side) { return -1 - 2 * pair - side; }
  bool is_joined() const { return patch < 0; }
  int pair() const { return (-1 - patch) / 2; }
  int side() const { return (-1 - patch) % 2; }
};

/// Cells with mesh numbers, as they are sent from rank to rank.
struct CellList {
  std::vector<GlobalIndex> id;
  std::vector<CellType> type;
  std::vector<int> zone;
  std::vector<GlobalIndex> points;
  std::vector<Index> point_offset{0};
  std::vector<FaceRecord> records;
  std::vector<Index> record_offset{0};

  Index size() const { return static_cast<Index>(type.size()); }
  std::span<const GlobalIndex> points_of(Index c) const {
    return {points.data() + point_offset[c], std::size_t(point_offset[c + 1] - point_offset[c])};
  }
  std::span<const FaceRecord> records_of(Index c) const {
    return {records.data() + record_offset[c], std::size_t(record_offset[c + 1] - record_offset[c])};
  }
  /// Points of a face of a cell in the order of its shape.
  std::vector<GlobalIndex> face_of(Index c, int face) const;
  /// Appends cell `c` of another list under the number `number`.
  void push(const CellList& other, Index c, GlobalIndex number);
};

/// Number of integers in a packed cell.
std::size_t packed_size(const CellList& cells, Index c);
/// Packs a cell under the number `id` and returns the end of the written range.
GlobalIndex* pack(const CellList& cells, Index c, GlobalIndex id, GlobalIndex* to);
/// Appends all packed cells.
void unpack(std::span<const GlobalIndex> packed, CellList& cells);

/// Sorts the cells by number and removes duplicates.
CellList sorted(const CellList& cells);

/// Unique point numbers in ascending order, with the position of each.
class PointNumbers {
 public:
  explicit PointNumbers(std::span<const GlobalIndex> all);
  const std::vector<GlobalIndex>& numbers() const { return numbers_; }
  /// Position of a number, which must be in the list.
  Index place(GlobalIndex number) const;

 private:
  std::vector<GlobalIndex> numbers_;
  // Index from the smallest number; empty if it would be much longer than the list.
  std::vector<Index> table_;
};

/// This rank's block of a mesh from a file or a generator: its share of points and cells by number, and some
/// boundary elements, those of rank 0 first. A small mesh is entirely on rank 0. No rank holds a large mesh
/// as a whole.
struct MeshBlock {
  int dim = 3;
  Shares point_shares, cell_shares;
  std::vector<Vec3> points;  ///< of this rank's share
  CellList cells;            ///< of this rank's share, without `id`
  std::vector<GlobalIndex> element_points;
  std::vector<Index> element_offset{0};
  std::vector<int> element_patch;
  // The following agree on all ranks, as in RawMesh:
  std::vector<std::string> zones, patches;
  std::vector<std::array<std::string, 2>> periodic;
  std::vector<std::vector<std::string>> materials;
  bool find_wide_points = true;
  bool tie = false;  ///< for load_block(): see tie_touching_faces()

  Index n_elements() const { return static_cast<Index>(element_patch.size()); }
  std::span<const GlobalIndex> element(Index e) const {
    return {element_points.data() + element_offset[e],
            std::size_t(element_offset[e + 1] - element_offset[e])};
  }
  void push_cell(CellType type, int zone, std::span<const GlobalIndex> cell_points);
  void push_element(int patch, std::span<const GlobalIndex> points_of_element);
};

/// Block of this rank for a mesh that each of the first `holders` ranks holds as a whole. On the other ranks
/// `raw` must match rank 0 only in `periodic`, `materials` and `find_wide_points`. Collective.
MeshBlock block_of(MPI_Comm comm, const RawMesh& raw, int holders = 1);

/// Size and number of cells of a mesh, for estimates before a run.
struct MeshFacts {
  int dim = 3;               ///< 2 if there are only 2-D cells
  Vec3 size = Vec3::Zero();  ///< of the box around the points [m]
  double shortest_edge = 0;  ///< of any cell, including diagonals [m]
  double mean_cell = 0;      ///< (volume of the box over the number of cells)^(1/dim) [m]
  std::size_t cells = 0;
  std::vector<std::string> patches;
  double smallest_side() const;  ///< of the box, in the dimensions of the mesh [m]
  double largest_side() const { return size.maxCoeff(); }
  /// Computes mean_cell from the other members.
  void find_mean_cell();
  void scale(double factor);
};
/// Computes the facts of a whole mesh. Needs no MPI.
MeshFacts facts_of(const RawMesh& raw);
/// Computes the facts over all ranks. Collective.
MeshFacts facts_of(MPI_Comm comm, const MeshBlock& block);

/// Converts a block that contains the whole mesh.
RawMesh raw_of(MeshBlock block);

/// Material of each zone. Empty with fewer than two materials. Throws Error for a zone without material or a
/// material without zone.
std::vector<int> materials_of_zones(const MeshBlock& block);

/// Removes points without a cell or boundary element (a .msh may contain centers of circles). The others keep
/// their order and are redistributed. Collective.
void drop_unused_points(MPI_Comm comm, MeshBlock& block);

/// Distributes a mesh: matches faces, partitions the cells by PT-Scotch and sends them with their
/// surroundings to their ranks. No rank holds more than its block and its part with surroundings. `part`
/// replaces PT-Scotch with a rank per cell of the block. Every boundary face belongs to one patch, "rest" if
/// none is given; errors state the location. Collective.
LoadedMesh distribute(MPI_Comm comm, MeshBlock block, std::span<const int> part = {});

/// Scales, distributes, checks and reports a block of this file. Throws Error with the name of the file.
/// Collective.
LoadedMesh load_block(MPI_Comm comm, MeshBlock block, const std::filesystem::path& file, double scale);

/// Box of hexahedra, or of six tetrahedra per hexahedron, numbered as by make_box().
struct BlockedBox {
  bool tetrahedra = false;
  std::array<GlobalIndex, 3> n{1, 1, 1};  ///< hexahedra per side
  Vec3 lower = Vec3::Zero(), upper = Vec3::Ones();
};

/// Block of this rank, generated without communication. Throws Error for an invalid box.
MeshBlock box_block(MPI_Comm comm, const BlockedBox& box);

}  // namespace couplet::mesh
