// SPDX-License-Identifier: Apache-2.0
#include <malloc.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/mesh/distributed/surroundings.hpp"
#include "common/mesh/partition.hpp"
#include "common/mesh/quality.hpp"
#include "common/mesh/touching_faces.hpp"

namespace couplet::mesh {
namespace {

bool holds(const std::vector<GlobalIndex>& numbers, GlobalIndex number) {
  return std::ranges::binary_search(numbers, number);
}

/// Wide points of own cells, whose surroundings are complete after one ring. All points are ascending.
std::vector<GlobalIndex> own_wide_points(const Piece& piece, const std::vector<GlobalIndex>& own_points) {
  std::vector<GlobalIndex> wide;
  for (const Index p : wide_points(piece))
    if (holds(own_points, piece.point_number[p])) wide.push_back(piece.point_number[p]);
  return wide;
}

/// Points of all cells around wide points that own cells do not have. Their cells are the second ring.
std::vector<GlobalIndex> points_around(const std::vector<GlobalIndex>& wide,
                                       const std::vector<GlobalIndex>& own_points, const CellList& cells) {
  std::vector<GlobalIndex> around;
  if (wide.empty()) return around;
  for (Index c = 0; c < cells.size(); ++c) {
    const auto points = cells.points_of(c);
    if (std::ranges::any_of(points, [&](GlobalIndex p) { return holds(wide, p); }))
      std::ranges::copy_if(points, std::back_inserter(around),
                           [&](GlobalIndex p) { return !holds(own_points, p); });
  }
  std::ranges::sort(around);
  around.erase(std::ranges::unique(around).begin(), around.end());
  return around;
}

/// All wide points of the piece, as known by the ranks whose own cells have them. Collective.
std::vector<Index> wide_points_here(MPI_Comm comm, const Shares& shares,
                                    const std::vector<GlobalIndex>& own_wide,
                                    const std::vector<GlobalIndex>& points) {
  const int rank = parallel::comm_rank(comm);
  std::vector<char> is_wide(std::size_t(shares.count(rank)), 0);
  for (const GlobalIndex p : parallel::exchange(comm, by_share(shares, own_wide)).items)
    is_wide[p - shares.first(rank)] = 1;
  const std::vector<char> here = fetch(comm, shares, std::span<const char>(is_wide), points);
  std::vector<Index> result;
  for (std::size_t i = 0; i < here.size(); ++i)
    if (here[i] != 0) result.push_back(static_cast<Index>(i));
  return result;
}

/// Returns freed memory to the system, because MPI's allocator settings keep it. A single rank soon reuses
/// it.
void give_back(MPI_Comm comm) {
  if (parallel::comm_size(comm) > 1) malloc_trim(0);
}

}  // namespace

LoadedMesh distribute(MPI_Comm comm, MeshBlock block, std::span<const int> part) {
  const GlobalIndex n = block.cell_shares.n;
  if (n == 0)
    throw Error(
        "The mesh has no {} cells. Put the {} into a physical group; otherwise gmsh does not save "
        "them.",
        block.dim == 2 ? "triangle or quadrilateral" : "3-D", block.dim == 2 ? "surface" : "volume");
  if (n < parallel::comm_size(comm))
    throw Error("The mesh has {} cells, fewer than the {} ranks that share it. Start fewer processes.", n,
                parallel::comm_size(comm));
  drop_unused_points(comm, block);
  give_back(comm);
  BlockGraph graph = find_block_faces(comm, block);
  give_back(comm);
  std::vector<int> own_part(part.begin(), part.end());
  if (part.empty() && parallel::comm_size(comm) == 1)
    own_part.assign(std::size_t(n), 0);
  else if (part.empty())
    own_part = partition(comm, graph.offset, graph.neighbours, parallel::comm_size(comm));
  graph.offset = {}, graph.neighbours = {};
  CellList own = send_to_owners(comm, block, own_part);
  const std::vector<CellAcross> across = cells_across(comm, block.cell_shares, own_part, own);
  own_part = {};
  give_back(comm);
  const std::vector<GlobalIndex> own_points = PointNumbers(own.points).numbers();
  const PointDirectory directory(comm, block.point_shares, own_points);
  LocalCells local = with_one_ring(comm, std::move(own), own_points, directory, across);
  give_back(comm);
  const PieceSource source{comm, block, graph};
  Piece piece = make_piece(source, local.cells);
  std::vector<Index> wide;
  if (block.find_wide_points) {
    const std::vector<GlobalIndex> own_wide = own_wide_points(piece, own_points);
    const std::vector<GlobalIndex> around = points_around(own_wide, own_points, local.cells);
    if (parallel::sum(comm, GlobalIndex(around.size())) > 0) {
      piece = {};
      add_cells_at(comm, around, directory, local);
      piece = make_piece(source, local.cells);
    }
    wide = wide_points_here(comm, block.point_shares, own_wide, piece.point_number);
  }
  const Csr ranks = directory.ranks_at(piece.point_number);
  std::vector<int> point_owner;
  for (Index p = 0; p < ranks.size(); ++p) point_owner.push_back(ranks[p].front());
  block.points = {};
  return make_part(source, std::move(local), std::move(piece), wide, std::move(point_owner));
}

LoadedMesh distribute(MPI_Comm comm, const RawMesh& raw) { return distribute(comm, block_of(comm, raw)); }

LoadedMesh load_block(MPI_Comm comm, MeshBlock block, const std::filesystem::path& file, double scale) {
  for (Vec3& x : block.points) x *= scale;
  try {
    if (block.tie) tie_touching_faces(comm, block);
    LoadedMesh loaded = distribute(comm, std::move(block));
    give_back(comm);
    check_and_report(loaded.mesh, loaded.geometry);
    return loaded;
  } catch (const Error& e) {
    throw Error("Cannot use the mesh '{}'. {}", file.string(), e.what());
  }
}

}  // namespace couplet::mesh
