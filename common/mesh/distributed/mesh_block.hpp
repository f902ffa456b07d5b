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

/// Numbers 0 .. n - 1 in even shares, rank by rank, of the first `holders` ranks: where what has a number stands while
/// no rank owns it.
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

/// `numbers`, ascending, as parcels to the ranks in whose shares they are.
inline parallel::Parcels<GlobalIndex> by_share(const Shares& shares, std::vector<GlobalIndex> numbers) {
  parallel::Parcels<GlobalIndex> parcels;
  for (int r = 0; r <= shares.ranks; ++r)
    parcels.first.push_back(
        std::size_t(std::ranges::lower_bound(numbers, shares.first(r)) - numbers.begin()));
  parcels.items = std::move(numbers);
  return parcels;
}

/// The values at these numbers, ascending, of which each rank has those of its share. Collective.
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

/// A face of a cell that no other cell shares, or that is bonded or periodic.
struct FaceRecord {
  std::int8_t face = 0;  ///< position among the faces of the cell's shape
  std::int8_t turn = 0;  ///< bonded: which of the cell's points of the face comes first
  int patch = 0;
  GlobalIndex number = 0;  ///< of the boundary face

  // A periodic face has, in place of a patch, the pair of patches that it joins and which of the two it was on; its number is that
  // of the cell beyond.
  static int joined(int pair, int side) { return -1 - 2 * pair - side; }
  bool is_joined() const { return patch < 0; }
  int pair() const { return (-1 - patch) / 2; }
  int side() const { return (-1 - patch) % 2; }
};

/// Cells with numbers of the mesh, as they travel from rank to rank.
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
  /// Cell `c` of another list, under the number `number`.
  void push(const CellList& other, Index c, GlobalIndex number);
};

/// Numbers that a packed cell takes.
std::size_t packed_size(const CellList& cells, Index c);
/// Writes a cell under the number `id`; gives the end of what is written.
GlobalIndex* pack(const CellList& cells, Index c, GlobalIndex id, GlobalIndex* to);
/// Appends all cells that are packed there.
void unpack(std::span<const GlobalIndex> packed, CellList& cells);

/// The cells in ascending order of their numbers, each once.
CellList sorted(const CellList& cells);

/// Numbers of points in ascending order, each once, and the place of each there.
class PointNumbers {
 public:
  explicit PointNumbers(std::span<const GlobalIndex> all);
  const std::vector<GlobalIndex>& numbers() const { return numbers_; }
  /// Of a number that is among them.
  Index place(GlobalIndex number) const;

 private:
  std::vector<GlobalIndex> numbers_;
  std::vector<Index>
      table_;  // by number, from the smallest; empty where there would be many more than there are numbers
};

/// This rank's block of a mesh, as a file or a generator gives it: its share of the points and of the cells by their
/// numbers, and some boundary elements, those of rank 0 first. A small mesh is a block of rank 0 with empty ones beside it; of
/// a large one no rank has the whole.
struct MeshBlock {
  int dim = 3;
  Shares point_shares, cell_shares;
  std::vector<Vec3> points;  ///< of this rank's share
  CellList cells;            ///< of this rank's share; without `id`
  std::vector<GlobalIndex> element_points;
  std::vector<Index> element_offset{0};
  std::vector<int> element_patch;
  // These agree on all ranks, as in RawMesh:
  std::vector<std::string> zones, patches;
  std::vector<std::array<std::string, 2>> periodic;
  std::vector<std::vector<std::string>> materials;
  bool find_wide_points = true;

  Index n_elements() const { return static_cast<Index>(element_patch.size()); }
  std::span<const GlobalIndex> element(Index e) const {
    return {element_points.data() + element_offset[e],
            std::size_t(element_offset[e + 1] - element_offset[e])};
  }
  void push_cell(CellType type, int zone, std::span<const GlobalIndex> cell_points);
  void push_element(int patch, std::span<const GlobalIndex> points_of_element);
};

/// This rank's block of a mesh that the first `holders` ranks share out evenly, each of which has it as a whole. `raw` is
/// that of rank 0 elsewhere only in `periodic`, `materials` and `find_wide_points`. Collective.
MeshBlock block_of(MPI_Comm comm, const RawMesh& raw, int holders = 1);

/// Size and number of cells of a mesh, for estimates before a run.
struct MeshFacts {
  int dim = 3;               ///< 2: cells in the plane only
  Vec3 size = Vec3::Zero();  ///< of the box around the points [m]
  double shortest_edge = 0;  ///< of any cell, diagonals included [m]
  double mean_cell = 0;      ///< (volume of the box over the number of cells)^(1/dim) [m]
  std::size_t cells = 0;
  std::vector<std::string> patches;
  double smallest_side() const;  ///< of the box, in the directions that the mesh has [m]
  double largest_side() const { return size.maxCoeff(); }
  /// Sets mean_cell from the others.
  void find_mean_cell();
  void scale(double factor);
};
/// Facts of a whole mesh; needs no MPI.
MeshFacts facts_of(const RawMesh& raw);
/// Collective.
MeshFacts facts_of(MPI_Comm comm, const MeshBlock& block);

/// The same mesh as one piece, of a block that is all of it.
RawMesh raw_of(MeshBlock block);

/// The material of each zone; empty with fewer than two materials. Throws Error for a zone without material or a material
/// without zone.
std::vector<int> materials_of_zones(const MeshBlock& block);

/// Takes out the points that no cell and no boundary element has (a .msh may carry centers of circles); the order of the others
/// stays, and they are shared out anew. Collective.
void drop_unused_points(MPI_Comm comm, MeshBlock& block);

/// From blocks to this rank's part: faces are matched, cells shared out by PT-Scotch and sent to their ranks, and what
/// surrounds them fetched, all in parallel: no rank holds more than its block and its part with its surroundings.
/// `part`: the rank of each cell of the block, in place of PT-Scotch's. Every boundary face must belong to exactly one patch;
/// errors name the place. Collective.
LoadedMesh distribute(MPI_Comm comm, MeshBlock block, std::span<const int> part = {});

/// The same of a block of this file, all lengths times `scale`, checked and reported. Throws Error with the name of the
/// file. Collective.
LoadedMesh load_block(MPI_Comm comm, MeshBlock block, const std::filesystem::path& file, double scale);

/// A box of hexahedra, or of each cut into six tetrahedra: cells, points, patches and their order as make_box() has them.
struct BlockedBox {
  bool tetrahedra = false;
  std::array<GlobalIndex, 3> n{1, 1, 1};  ///< hexahedra a side
  Vec3 lower = Vec3::Zero(), upper = Vec3::Ones();
};

/// This rank's block of it; each rank makes its own, without a word to the others. Throws Error for no box.
MeshBlock box_block(MPI_Comm comm, const BlockedBox& box);

}  // namespace couplet::mesh
