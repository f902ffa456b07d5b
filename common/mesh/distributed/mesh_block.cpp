// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/mesh_block.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {

std::vector<GlobalIndex> CellList::face_of(Index c, int face) const {
  const CellShape& shape = shape_of(type[c]);
  std::vector<GlobalIndex> result;
  for (int i = 0; i < shape.face_size(face); ++i) result.push_back(points_of(c)[shape.faces[face][i]]);
  return result;
}

void CellList::push(const CellList& other, Index c, GlobalIndex number) {
  id.push_back(number);
  type.push_back(other.type[c]);
  zone.push_back(other.zone[c]);
  const auto cell_points = other.points_of(c);
  points.insert(points.end(), cell_points.begin(), cell_points.end());
  point_offset.push_back(static_cast<Index>(points.size()));
  const auto cell_records = other.records_of(c);
  records.insert(records.end(), cell_records.begin(), cell_records.end());
  record_offset.push_back(static_cast<Index>(records.size()));
}

std::size_t packed_size(const CellList& cells, Index c) {
  return 2 + cells.points_of(c).size() + 2 * cells.records_of(c).size();
}

// Layout: number; type, number of records, zone; points; for each record: face, turn, patch; number.
GlobalIndex* pack(const CellList& cells, Index c, GlobalIndex id, GlobalIndex* to) {
  const auto records = cells.records_of(c);
  *to++ = id;
  *to++ = GlobalIndex(cells.type[c]) | GlobalIndex(records.size()) << 8 | GlobalIndex(cells.zone[c]) << 32;
  to = std::ranges::copy(cells.points_of(c), to).out;
  for (const FaceRecord& r : records) {
    *to++ = GlobalIndex(r.face) | GlobalIndex(r.turn) << 8 | GlobalIndex(r.patch) * (GlobalIndex(1) << 32);
    *to++ = r.number;
  }
  return to;
}

void unpack(std::span<const GlobalIndex> packed, CellList& cells) {
  for (auto at = packed.begin(); at != packed.end();) {
    cells.id.push_back(*at++);
    cells.type.push_back(static_cast<CellType>(*at & 0xff));
    const auto n_records = std::size_t(*at >> 8 & 0xff);
    cells.zone.push_back(static_cast<int>(*at++ >> 32));
    const auto n_points = shape_of(cells.type.back()).n_points;
    cells.points.insert(cells.points.end(), at, at + n_points);
    at += n_points;
    for (std::size_t i = 0; i < n_records; ++i, at += 2)
      cells.records.push_back({static_cast<std::int8_t>(at[0] & 0xff),
                               static_cast<std::int8_t>(at[0] >> 8 & 0xff), static_cast<int>(at[0] >> 32),
                               at[1]});
    cells.point_offset.push_back(static_cast<Index>(cells.points.size()));
    cells.record_offset.push_back(static_cast<Index>(cells.records.size()));
  }
}

CellList sorted(const CellList& cells) {
  std::vector<Index> order(cells.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&](Index a, Index b) { return cells.id[a] < cells.id[b]; });
  const auto repeated =
      std::ranges::unique(order, [&](Index a, Index b) { return cells.id[a] == cells.id[b]; });
  order.erase(repeated.begin(), repeated.end());
  CellList result;
  result.id.reserve(order.size()), result.type.reserve(order.size()), result.zone.reserve(order.size());
  result.points.reserve(cells.points.size()), result.records.reserve(cells.records.size());
  result.point_offset.reserve(order.size() + 1), result.record_offset.reserve(order.size() + 1);
  for (const Index c : order) result.push(cells, c, cells.id[c]);
  return result;
}

int rest_of(std::vector<std::string>& patches) {
  const auto found = std::ranges::find(patches, "rest");
  const auto number = static_cast<int>(found - patches.begin());
  if (found == patches.end()) patches.emplace_back("rest");
  return number;
}

PointNumbers::PointNumbers(std::span<const GlobalIndex> all) {
  if (all.empty()) return;
  const auto [least, most] = std::ranges::minmax(all);
  // Points of a part mostly have close numbers, for which a table is faster than a search.
  if (std::size_t(most - least) > all.size()) {
    numbers_.assign(all.begin(), all.end());
    std::ranges::sort(numbers_);
    numbers_.erase(std::ranges::unique(numbers_).begin(), numbers_.end());
    numbers_.shrink_to_fit();
    return;
  }
  table_.assign(std::size_t(most - least) + 1, 0);
  for (const GlobalIndex number : all) table_[number - least] = 1;
  numbers_.reserve(std::accumulate(table_.begin(), table_.end(), std::size_t(0)));
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (table_[i] != 0) {
      table_[i] = static_cast<Index>(numbers_.size());
      numbers_.push_back(least + GlobalIndex(i));
    }
}

Index PointNumbers::place(GlobalIndex number) const {
  if (!table_.empty()) return table_[number - numbers_.front()];
  return static_cast<Index>(std::ranges::lower_bound(numbers_, number) - numbers_.begin());
}

void MeshBlock::push_cell(CellType type, int zone, std::span<const GlobalIndex> cell_points) {
  cells.type.push_back(type);
  cells.zone.push_back(zone);
  cells.points.insert(cells.points.end(), cell_points.begin(), cell_points.end());
  cells.point_offset.push_back(static_cast<Index>(cells.points.size()));
}

void MeshBlock::push_element(int patch, std::span<const GlobalIndex> points_of_element) {
  element_patch.push_back(patch);
  element_points.insert(element_points.end(), points_of_element.begin(), points_of_element.end());
  element_offset.push_back(static_cast<Index>(element_points.size()));
}

MeshBlock block_of(MPI_Comm comm, const RawMesh& raw, int holders) {
  const int ranks = parallel::comm_size(comm), rank = parallel::comm_rank(comm);
  std::array<GlobalIndex, 7> counts{raw.dim,
                                    GlobalIndex(raw.points.size()),
                                    GlobalIndex(raw.cell_type.size()),
                                    GlobalIndex(raw.boundary_patch.size()),
                                    GlobalIndex(raw.periodic.size()),
                                    GlobalIndex(raw.materials.size()),
                                    raw.find_wide_points ? 1 : 0};
  MPI_Bcast(counts.data(), int(counts.size()), MPI_INT64_T, 0, comm);
  MeshBlock block;
  block.dim = static_cast<int>(counts[0]);
  block.point_shares = {counts[1], ranks, holders};
  block.cell_shares = {counts[2], ranks, holders};
  block.zones = raw.zones, block.patches = raw.patches;
  broadcast(comm, block.zones), broadcast(comm, block.patches);
  block.periodic = raw.periodic, block.materials = raw.materials;
  block.periodic.resize(std::size_t(counts[4])), block.materials.resize(std::size_t(counts[5]));
  for (auto& [side, other] : block.periodic)
    parallel::broadcast(comm, side), parallel::broadcast(comm, other);
  for (auto& material : block.materials) broadcast(comm, material);
  block.find_wide_points = counts[6] != 0;
  if (rank >= holders) return block;
  block.points.assign(raw.points.begin() + block.point_shares.first(rank),
                      raw.points.begin() + block.point_shares.first(rank + 1));
  std::vector<GlobalIndex> points;
  for (GlobalIndex c = block.cell_shares.first(rank); c < block.cell_shares.first(rank + 1); ++c) {
    const auto row = raw.cell_points[Index(c)];
    points.assign(row.begin(), row.end());
    block.push_cell(raw.cell_type[c], raw.cell_zone[c], points);
  }
  const Shares elements{counts[3], ranks, holders};
  for (GlobalIndex e = elements.first(rank); e < elements.first(rank + 1); ++e) {
    const auto row = raw.boundary_points[Index(e)];
    points.assign(row.begin(), row.end());
    block.push_element(raw.boundary_patch[e], points);
  }
  return block;
}

double MeshFacts::smallest_side() const { return dim == 2 ? std::min(size[0], size[1]) : size.minCoeff(); }

void MeshFacts::find_mean_cell() {
  double volume = 1;
  for (int a = 0; a < dim; ++a) volume *= size[a];
  mean_cell = cells == 0 ? 0 : std::pow(volume / double(cells), 1.0 / dim);
}

void MeshFacts::scale(double factor) {
  size *= factor;
  shortest_edge *= factor;
  mean_cell *= factor;
}

MeshFacts facts_of(MPI_Comm comm, const MeshBlock& block) {
  MeshFacts facts{.dim = block.dim, .cells = std::size_t(block.cell_shares.n), .patches = block.patches};
  if (block.point_shares.n == 0 || facts.cells == 0) return facts;
  facts.size = extent_of(comm, block.points).size();
  facts.find_mean_cell();
  const PointNumbers numbers(block.cells.points);
  const std::vector<Vec3> x =
      fetch(comm, block.point_shares, std::span<const Vec3>(block.points), numbers.numbers());
  double shortest = std::numeric_limits<double>::infinity();
  for (Index c = 0; c < block.cells.size(); ++c) {
    const auto points = block.cells.points_of(c);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = i + 1; j < points.size(); ++j)
        shortest =
            std::min(shortest, (x[numbers.place(points[i])] - x[numbers.place(points[j])]).squaredNorm());
  }
  facts.shortest_edge = std::sqrt(parallel::min(comm, shortest));
  return facts;
}

RawMesh raw_of(MeshBlock block) {
  RawMesh raw;
  raw.dim = block.dim;
  raw.points = std::move(block.points);
  raw.cell_type = std::move(block.cells.type);
  raw.cell_points = {std::move(block.cells.point_offset),
                     {block.cells.points.begin(), block.cells.points.end()}};
  raw.cell_zone = std::move(block.cells.zone);
  raw.boundary_points = {std::move(block.element_offset),
                         {block.element_points.begin(), block.element_points.end()}};
  raw.boundary_patch = std::move(block.element_patch);
  raw.zones = std::move(block.zones), raw.patches = std::move(block.patches);
  raw.periodic = std::move(block.periodic), raw.materials = std::move(block.materials);
  raw.find_wide_points = block.find_wide_points;
  return raw;
}

void drop_unused_points(MPI_Comm comm, MeshBlock& block) {
  std::vector<GlobalIndex> all = block.cells.points;
  all.insert(all.end(), block.element_points.begin(), block.element_points.end());
  const PointNumbers here(all);
  all = {};
  const int rank = parallel::comm_rank(comm);
  const GlobalIndex first = block.point_shares.first(rank);
  std::vector<char> used(block.points.size(), 0);
  for (const GlobalIndex p : parallel::exchange(comm, by_share(block.point_shares, here.numbers())).items)
    used[std::size_t(p - first)] = 1;
  const auto kept = GlobalIndex(std::ranges::count(used, 1));
  const GlobalIndex total = parallel::sum(comm, kept);
  if (total == block.point_shares.n) return;
  std::vector<GlobalIndex> number(used.size(), -1);
  std::vector<Vec3> points;
  GlobalIndex next = parallel::exclusive_scan(comm, kept);
  const GlobalIndex first_kept = next;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] == 0) continue;
    number[i] = next++;
    points.push_back(block.points[i]);
  }
  const std::vector<GlobalIndex> renumbered =
      fetch(comm, block.point_shares, std::span<const GlobalIndex>(number), here.numbers());
  for (auto* of : {&block.cells.points, &block.element_points})
    for (GlobalIndex& p : *of) p = renumbered[std::size_t(here.place(p))];
  block.point_shares.n = total;
  parallel::Parcels<Vec3> parcels;
  for (int r = 0; r <= block.point_shares.ranks; ++r)
    parcels.first.push_back(
        std::size_t(std::clamp(block.point_shares.first(r), first_kept, next) - first_kept));
  parcels.items = std::move(points);
  block.points = std::move(parallel::exchange(comm, parcels).items);
}

std::vector<int> materials_of_zones(const MeshBlock& block) {
  if (block.materials.empty()) return {};
  std::vector<int> of_zone(block.zones.size(), -1);
  for (std::size_t m = 0; m < block.materials.size(); ++m)
    for (const std::string& name : block.materials[m]) {
      const auto zone = std::ranges::find(block.zones, name);
      if (zone == block.zones.end())
        throw Error("It has no zone '{}' for a material. {} The zones (physical {} of gmsh) are {}.", name,
                    base::did_you_mean(name, block.zones, "zones"), block.dim == 2 ? "surfaces" : "volumes",
                    base::join(block.zones));
      int& material = of_zone[zone - block.zones.begin()];
      if (material >= 0)
        throw Error("Its zone '{}' is assigned to two materials; each zone has exactly one.", name);
      material = static_cast<int>(m);
    }
  for (std::size_t z = 0; z < of_zone.size(); ++z)
    if (of_zone[z] < 0)
      throw Error("Its zone '{}' has no material; add it to the zones of a material. The zones are {}.",
                  block.zones[z], base::join(block.zones));
  return block.materials.size() == 1 ? std::vector<int>() : of_zone;
}

namespace {

using GridPlace = std::array<GlobalIndex, 3>;

/// Numbers on a grid with `n` entries per direction, the first direction fastest.
struct GridNumbers {
  GridPlace n;
  GlobalIndex count() const { return n[0] * n[1] * n[2]; }
  GridPlace place(GlobalIndex number) const {
    return {number % n[0], number / n[0] % n[1], number / n[0] / n[1]};
  }
  GlobalIndex number(const GridPlace& at) const { return at[0] + n[0] * (at[1] + n[1] * at[2]); }
};

class BoxBlock {
 public:
  BoxBlock(const BlockedBox& box, int rank, int ranks)
      : box_(box), points_{{box.n[0] + 1, box.n[1] + 1, box.n[2] + 1}}, grid_{box.n} {
    block_.zones = {"default"};
    block_.patches = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
    block_.point_shares = {points_.count(), ranks};
    block_.cell_shares = {grid_.count() * (box.tetrahedra ? 6 : 1), ranks};
    for (GlobalIndex p = block_.point_shares.first(rank); p < block_.point_shares.first(rank + 1); ++p)
      block_.points.push_back(position(points_.place(p)));
    for (GlobalIndex c = block_.cell_shares.first(rank); c < block_.cell_shares.first(rank + 1); ++c)
      add_cell(c);
  }
  MeshBlock take() { return std::move(block_); }

 private:
  Vec3 position(const GridPlace& at) const {
    const Vec3 s(double(at[0]) / double(box_.n[0]), double(at[1]) / double(box_.n[1]),
                 double(at[2]) / double(box_.n[2]));
    return box_.lower + s.cwiseProduct(box_.upper - box_.lower);
  }

  void add_cell(GlobalIndex cell) {
    const GridPlace at = grid_.place(box_.tetrahedra ? cell / 6 : cell);
    std::array<GlobalIndex, 8> corners{};
    constexpr std::array<std::array<int, 3>, 8> steps{
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
    for (int i = 0; i < 8; ++i)
      corners[i] = points_.number({at[0] + steps[i][0], at[1] + steps[i][1], at[2] + steps[i][2]});
    if (!box_.tetrahedra) return push(CellType::hexahedron, corners);
    // Kuhn's subdivision along the diagonal 0-6, as in make_box().
    constexpr std::array<int, 7> ring{1, 2, 3, 7, 4, 5, 1};
    const auto t = cell % 6;
    push(CellType::tetrahedron, std::array{corners[0], corners[ring[t]], corners[ring[t + 1]], corners[6]});
  }

  void push(CellType type, std::span<const GlobalIndex> points) {
    block_.push_cell(type, 0, points);
    const CellShape& shape = shape_of(type);
    for (int f = 0; f < shape.n_faces; ++f) {
      std::array<GlobalIndex, 4> face{};
      const auto n = std::size_t(shape.face_size(f));
      for (std::size_t i = 0; i < n; ++i) face[i] = points[shape.faces[f][i]];
      const int side = side_of({face.data(), n});
      if (side >= 0) block_.push_element(side, {face.data(), n});
    }
  }

  /// Side of the box that contains these points, or -1.
  int side_of(std::span<const GlobalIndex> face) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int upper : {0, 1}) {
        bool all = true;
        for (const GlobalIndex p : face)
          all = all && points_.place(p)[axis] == (upper != 0 ? box_.n[axis] : 0);
        if (all) return 2 * axis + upper;
      }
    return -1;
  }

  const BlockedBox& box_;
  GridNumbers points_, grid_;
  MeshBlock block_;
};

}  // namespace

MeshBlock box_block(MPI_Comm comm, const BlockedBox& box) {
  for (int a = 0; a < 3; ++a)
    if (box.n[a] < 1 || box.n[a] > 1000000 || !(box.upper[a] > box.lower[a]))
      throw Error("A box needs 1 to 1000000 cells and a length above zero along each side.");
  return BoxBlock(box, parallel::comm_rank(comm), parallel::comm_size(comm)).take();
}

}  // namespace couplet::mesh
