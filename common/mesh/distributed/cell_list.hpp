// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <algorithm>
#include <span>
#include <vector>

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

}  // namespace couplet::mesh
