// SPDX-License-Identifier: Apache-2.0
#include <malloc.h>

#include <algorithm>
#include <tuple>

#include "common/base/error.hpp"
#include "common/mesh/distributed/surroundings.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/partition.hpp"
#include "common/mesh/quality.hpp"
#include "common/mesh/topology.hpp"
#include "common/mesh/touching_faces.hpp"

namespace couplet::mesh {

namespace {

/// Index map of entries `ids` (owned ones first). Owners send their local indices of the ghosts. Collective.
parallel::IndexMap make_index_map(MPI_Comm comm, std::span<const GlobalIndex> ids, Index n_owned,
                                  const std::vector<int>& ghost_owner) {
  std::vector<std::pair<GlobalIndex, Index>> owned;
  std::vector<std::vector<GlobalIndex>> wanted(parallel::comm_size(comm));
  for (std::size_t g = 0; g < ghost_owner.size(); ++g) wanted[ghost_owner[g]].push_back(ids[n_owned + g]);
  std::vector<std::vector<Index>> answers(parallel::comm_size(comm));
  const auto asked = parallel::all_to_all(comm, wanted);
  if (std::ranges::any_of(asked, [](const auto& of_rank) { return !of_rank.empty(); })) {
    for (Index i = 0; i < n_owned; ++i) owned.emplace_back(ids[i], i);
    std::ranges::sort(owned);
  }
  for (std::size_t r = 0; r < asked.size(); ++r)
    for (const GlobalIndex id : asked[r])
      answers[r].push_back(std::ranges::lower_bound(owned, std::pair(id, Index(0)))->second);
  const auto told = parallel::all_to_all(comm, answers);
  std::vector<Index> remote, next(told.size(), 0);
  for (const int r : ghost_owner) remote.push_back(told[r][next[r]++]);
  return {comm, n_owned, ghost_owner, remote};
}

class Part {
 public:
  Part(const PieceSource& source, LocalCells&& local, Piece&& piece, std::vector<int>&& point_owner)
      : source_(source),
        comm_(source.comm),
        rank_(parallel::comm_rank(source.comm)),
        local_(std::move(local)),
        piece_(std::move(piece)),
        point_owner_(std::move(point_owner)) {}

  /// Builds the mesh and its points. Intermediate data are freed as soon as possible.
  std::pair<Mesh, std::vector<Vec3>> build(const std::vector<Index>& wide) {
    mesh_.comm = comm_;
    mesh_.dim = raw_.dim;
    mesh_.zones = raw_.zones;
    on_all(comm_, [&] { find_inner_faces(); });
    find_joined_faces();
    number_cells();
    number_points();
    for (const Index p : wide)
      if (point_local_[p] >= 0) mesh_.wide_points.push_back(point_local_[p]);
    std::ranges::sort(mesh_.wide_points);
    raw_.points = {};
    fill_cells();
    fill_interior_faces();
    raw_.cell_points = {}, raw_.cell_type = {}, raw_.cell_zone = {};
    fill_boundary_faces();
    if (source_.graph.first_bonded >= 0) find_twins();
    return {std::move(mesh_), std::move(points_)};
  }

 private:
  struct Inner {
    Index owner, neighbour;  // cells of the piece
    Index joined;            // 0 without periodic face, else `patch` of its record
    std::int8_t face;        // in the owner's shape
  };

  bool is_own(Index cell) const { return local_.owner[cell] == rank_; }
  const FaceRecord* record_of(const HalfFace& half) const {
    for (const FaceRecord& r : local_.cells.records_of(half.cell))
      if (r.face == half.face) return &r;
    return nullptr;
  }
  std::string place_of(const HalfFaces& halves, const HalfFace& half) const {
    Vec3 sum = Vec3::Zero();
    const FacePoints face = halves.points(half);
    for (const Index p : std::span<const Index>(face)) sum += raw_.points[p] / double(face.n);
    return place(sum, raw_.dim);
  }

  /// Finds faces between two cells of the piece, at least one of which is owned.
  void find_inner_faces() {
    if (parallel::comm_size(comm_) == 1) return take_inner_faces();
    HalfFaces halves(raw_);
    inner_.reserve(halves.size() / 2);
    halves.for_each_face([&](std::span<const HalfFace> cells) {
      const HalfFace& first = cells[0];
      if (cells.size() > 2) throw Error(face_of_many_cells(cells.size(), place_of(halves, first)));
      const FaceRecord* record = record_of(first);
      if (cells.size() == 1) {
        if (is_own(first.cell) && record == nullptr)
          throw Error("The face at {} has lost its other side while the mesh was distributed.",
                      place_of(halves, first));
        return;
      }
      const Index second = cells[1].cell;
      if (record == nullptr) record = record_of(cells[1]);
      if (record != nullptr) {
        const bool is_bonded = record->patch >= Index(source_.block.patches.size());
        if (!is_bonded) throw Error(face_of_many_cells(2, place_of(halves, first)));
        bonded_.emplace_back(first.cell, second);
      } else if (is_own(first.cell) || is_own(second)) {
        inner_.push_back({first.cell, second, 0, static_cast<std::int8_t>(first.face)});
      }
    });
  }

  /// Takes the faces from the block if its cells are those of the piece.
  void take_inner_faces() {
    inner_.reserve(source_.graph.within.size());
    for (const BlockGraph::CellPair& p : source_.graph.within)
      if (p.bonded)
        bonded_.emplace_back(p.cell, p.other);
      else
        inner_.push_back({p.cell, p.other, 0, p.face});
  }

  /// Finds periodic faces of own cells, seen from the cell with the smaller number.
  void find_joined_faces() {
    const CellList& cells = local_.cells;
    for (Index c = 0; c < cells.size(); ++c)
      for (const FaceRecord& r : cells.records_of(c)) {
        if (!r.is_joined() || cells.id[c] > r.number) continue;
        if (cells.id[c] == r.number && r.side() == 1) continue;
        const auto other = std::ranges::lower_bound(cells.id, r.number);
        if (other == cells.id.end() || *other != r.number) continue;
        const auto beyond = static_cast<Index>(other - cells.id.begin());
        if (is_own(c) || is_own(beyond)) inner_.push_back({c, beyond, r.patch, r.face});
      }
  }

  /// Numbers own cells in reverse Cuthill-McKee order, then the copies by rank.
  void number_cells() {
    std::vector<Index> number_of_own(local_.owner.size(), -1), cell, first, second;
    for (Index c = 0; c < local_.cells.size(); ++c) {
      if (!is_own(c)) continue;
      number_of_own[c] = static_cast<Index>(cell.size());
      cell.push_back(c);
    }
    const auto n_owned = static_cast<Index>(cell.size());
    const auto connect = [&](Index a, Index b) {
      if (!is_own(a) || !is_own(b)) return;
      first.push_back(number_of_own[a]);
      second.push_back(number_of_own[b]);
    };
    for (const Inner& f : inner_) connect(f.owner, f.neighbour);
    for (const auto& [a, b] : bonded_) connect(a, b);
    for (const Index i : reverse_cuthill_mckee(make_graph(n_owned, first, second))) cells_.push_back(cell[i]);
    for (Index c = 0; c < local_.cells.size(); ++c)
      if (!is_own(c)) cells_.push_back(c);
    const auto owner = [&](Index c) { return local_.owner[c]; };
    std::ranges::stable_sort(cells_.begin() + n_owned, cells_.end(), {}, owner);
    cell_local_.resize(cells_.size());
    std::vector<int> ghost_owner;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      cell_local_[cells_[i]] = static_cast<Index>(i);
      mesh_.cell_id.push_back(local_.cells.id[cells_[i]]);
      if (Index(i) >= n_owned) ghost_owner.push_back(owner(cells_[i]));
    }
    mesh_.cells = make_index_map(comm_, mesh_.cell_id, n_owned, ghost_owner);
  }

  /// Numbers points in the order of the cells, own ones first.
  void number_points() {
    std::vector<Index> own, ghosts;
    point_local_.assign(raw_.points.size(), -1);
    for (const Index c : cells_)
      for (const Index p : raw_.cell_points[c]) {
        if (point_local_[p] >= 0) continue;
        point_local_[p] = 0;
        (point_owner_[p] == rank_ ? own : ghosts).push_back(p);
      }
    const auto n_owned = static_cast<Index>(own.size());
    std::vector<int> ghost_owner;
    for (const Index p : ghosts) ghost_owner.push_back(point_owner_[p]);
    own.insert(own.end(), ghosts.begin(), ghosts.end());
    points_.reserve(own.size()), mesh_.point_id.reserve(own.size());
    for (const Index p : own) {
      point_local_[p] = static_cast<Index>(points_.size());
      points_.push_back(raw_.points[p]);
      mesh_.point_id.push_back(piece_.point_number[p]);
    }
    mesh_.points = make_index_map(comm_, mesh_.point_id, n_owned, ghost_owner);
  }

  void push_points(Csr& rows, std::span<const Index> of_piece) {
    for (const Index p : of_piece) rows.index.push_back(point_local_[p]);
    rows.offset.push_back(static_cast<Index>(rows.index.size()));
  }

  void fill_cells() {
    mesh_.cell_points.offset.reserve(cells_.size() + 1);
    mesh_.cell_points.index.reserve(raw_.cell_points.index.size());
    mesh_.cell_type.reserve(cells_.size()), mesh_.cell_zone.reserve(cells_.size());
    for (const Index c : cells_) {
      mesh_.cell_type.push_back(raw_.cell_type[c]);
      mesh_.cell_zone.push_back(raw_.cell_zone[c]);
      if (!piece_.cell_material.empty()) mesh_.cell_material.push_back(piece_.cell_material[c]);
      push_points(mesh_.cell_points, raw_.cell_points[c]);
    }
  }

  /// Translation from the neighbor's position to that seen by the owner.
  Vec3 shift_of(const Inner& f) const {
    if (f.joined == 0) return Vec3::Zero();
    const FaceRecord record{f.face, 0, f.joined, 0};
    const Vec3& translation = source_.graph.translation[record.pair()];
    return record.side() == 0 ? Vec3(-translation) : translation;
  }

  void fill_interior_faces() {
    std::ranges::sort(inner_, {}, [&](const Inner& f) {
      return std::tuple(cell_local_[f.owner], cell_local_[f.neighbour], f.joined != 0, f.face);
    });
    const std::size_t n = inner_.size() + piece_.boundary_cell.size();
    mesh_.owner.reserve(n), mesh_.neighbour.reserve(inner_.size());
    mesh_.face_points.offset.reserve(n + 1);
    mesh_.face_points.index.reserve(n * (raw_.dim == 2 ? 2 : 4));
    for (const Inner& f : inner_) {
      mesh_.owner.push_back(cell_local_[f.owner]);
      mesh_.neighbour.push_back(cell_local_[f.neighbour]);
      push_points(mesh_.face_points, FacePoints(raw_, f.owner, f.face, 0));
      if (!source_.graph.translation.empty()) mesh_.neighbour_shift.push_back(shift_of(f));
    }
    mesh_.n_interior = static_cast<Index>(inner_.size());
    inner_ = {};
    mesh_.face_points.index.shrink_to_fit();  // triangles need less memory
  }

  void fill_boundary_faces() {
    struct ChosenFace {
      bool ghost;
      int patch;
      Index cell, face;
      auto operator<=>(const ChosenFace&) const = default;
    };
    std::vector<ChosenFace> chosen;
    for (std::size_t b = 0; b < piece_.boundary_cell.size(); ++b) {
      const Index cell = cell_local_[piece_.boundary_cell[b]];
      chosen.push_back({cell >= mesh_.cells.n_owned(), raw_.boundary_patch[b], cell, static_cast<Index>(b)});
    }
    std::ranges::sort(chosen);
    for (const std::string& name : raw_.patches) mesh_.patches.push_back({name});
    Index n_owned = 0;
    std::vector<int> ghost_owner;
    for (const ChosenFace& f : chosen) {
      Patch& patch = mesh_.patches[f.patch];
      ++(f.ghost ? patch.ghost_count : patch.count);
      if (f.ghost)
        ghost_owner.push_back(local_.owner[piece_.boundary_cell[f.face]]);
      else
        ++n_owned;
      mesh_.owner.push_back(f.cell);
      mesh_.boundary_id.push_back(piece_.boundary_number[f.face]);
      push_points(mesh_.face_points, raw_.boundary_points[f.face]);
    }
    Index at = mesh_.n_interior;
    for (Patch& p : mesh_.patches) at = (p.first = at) + p.count;
    for (Patch& p : mesh_.patches) at = (p.ghost_first = at) + p.ghost_count;
    mesh_.boundary = make_index_map(comm_, mesh_.boundary_id, n_owned, ghost_owner);
  }

  void find_twins() {
    mesh_.patches.back().bonded = true;
    std::vector<std::pair<GlobalIndex, Index>> bonded;  // number, entry
    for (std::size_t b = 0; b < mesh_.boundary_id.size(); ++b)
      if (mesh_.boundary_id[b] >= source_.graph.first_bonded)
        bonded.emplace_back(mesh_.boundary_id[b] - source_.graph.first_bonded, static_cast<Index>(b));
    std::ranges::sort(bonded);
    mesh_.twin.assign(mesh_.boundary_id.size(), -1);
    for (std::size_t i = 1; i < bonded.size(); ++i) {
      if (bonded[i].first != bonded[i - 1].first + 1 || bonded[i].first % 2 == 0) continue;
      mesh_.twin[bonded[i].second] = bonded[i - 1].second;
      mesh_.twin[bonded[i - 1].second] = bonded[i].second;
    }
  }

  const PieceSource& source_;
  MPI_Comm comm_;
  int rank_;
  LocalCells local_;
  Piece piece_;
  RawMesh& raw_ = piece_.raw;
  std::vector<int> point_owner_;
  std::vector<Inner> inner_;
  std::vector<std::pair<Index, Index>> bonded_;  // cells that share a face between materials
  std::vector<Index> cells_;                     // cells of the piece in the order of the part
  std::vector<Index> cell_local_, point_local_;  // local number of each cell and point of the piece
  Mesh mesh_;
  std::vector<Vec3> points_;  // per local point, as read
};

}  // namespace

LoadedMesh make_part(const PieceSource& source, LocalCells local, Piece piece, const std::vector<Index>& wide,
                     std::vector<int> point_owner) {
  auto [mesh, points] = Part(source, std::move(local), std::move(piece), std::move(point_owner)).build(wide);
  malloc_trim(0);  // with MPI, freed memory would stay with the process
  Geometry geometry = compute_geometry(mesh, std::move(points));
  return {std::move(mesh), std::move(geometry)};
}

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
