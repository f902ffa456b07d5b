// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/surroundings.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <numeric>

#include "common/mesh/topology.hpp"

namespace couplet::mesh {

namespace {

using Shipments = std::vector<std::pair<int, Index>>;  // rank and cell

/// Sends cells under the numbers returned by `number`. Received cells are sorted by rank. Collective.
template <class Number>
parallel::Parcels<GlobalIndex> ship(MPI_Comm comm, const CellList& cells, const Shipments& shipments,
                                    Number&& number) {
  std::vector<std::size_t> size(parallel::comm_size(comm), 0);
  for (const auto& [rank, c] : shipments) size[rank] += packed_size(cells, c);
  auto out = parallel::make_parcels<GlobalIndex>(size);
  std::vector<GlobalIndex*> next;
  for (std::size_t r = 0; r < size.size(); ++r) next.push_back(out.items.data() + out.first[r]);
  for (const auto& [rank, c] : shipments) next[rank] = pack(cells, c, number(c), next[rank]);
  return parallel::exchange(comm, out);
}

void sort_once(Shipments& shipments) {
  std::ranges::sort(shipments);
  shipments.erase(std::ranges::unique(shipments).begin(), shipments.end());
}

/// Sends own cells to other ranks and adds received ones. Collective.
void exchange_cells(MPI_Comm comm, const Shipments& shipments, LocalCells& local) {
  if (parallel::sum(comm, GlobalIndex(shipments.size())) == 0) return;
  const auto come = ship(comm, local.cells, shipments, [&](Index c) { return local.cells.id[c]; });
  CellList all = std::move(local.cells);
  std::vector<std::pair<GlobalIndex, int>> owners;
  for (Index c = 0; c < all.size(); ++c) owners.emplace_back(all.id[c], local.owner[c]);
  for (int r = 0; r < parallel::comm_size(comm); ++r) {
    const Index before = all.size();
    unpack(come.of(r), all);
    for (Index c = before; c < all.size(); ++c) owners.emplace_back(all.id[c], r);
  }
  local.cells = sorted(all);
  std::ranges::sort(owners);
  owners.erase(std::ranges::unique(owners).begin(), owners.end());
  local.owner.clear();
  for (const auto& [id, rank] : owners) local.owner.push_back(rank);
}

}  // namespace

PointDirectory::PointDirectory(MPI_Comm comm, const Shares& shares, const std::vector<GlobalIndex>& points)
    : comm_(comm), shares_(shares), first_(shares.first(parallel::comm_rank(comm))) {
  const auto told = parallel::exchange(comm, by_share(shares, points));
  ranks_.offset.assign(std::size_t(shares.count(parallel::comm_rank(comm))) + 1, 0);
  for (const GlobalIndex p : told.items) ++ranks_.offset[p - first_ + 1];
  std::partial_sum(ranks_.offset.begin(), ranks_.offset.end(), ranks_.offset.begin());
  ranks_.index.resize(told.items.size());
  std::vector<Index> next(ranks_.offset.begin(), ranks_.offset.end() - 1);
  for (int r = 0; r < shares.ranks; ++r)
    for (const GlobalIndex p : told.of(r)) ranks_.index[next[p - first_]++] = r;
}

Csr PointDirectory::ranks_at(const std::vector<GlobalIndex>& points) const {
  const auto asked = parallel::exchange(comm_, by_share(shares_, points));
  std::vector<std::size_t> count;
  for (int r = 0; r < shares_.ranks; ++r) {
    count.push_back(0);
    for (const GlobalIndex p : asked.of(r)) count.back() += 1 + ranks_[Index(p - first_)].size();
  }
  auto answers = parallel::make_parcels<Index>(count);
  auto to = answers.items.begin();
  for (const GlobalIndex p : asked.items) {
    const auto ranks = ranks_[Index(p - first_)];
    *to++ = static_cast<Index>(ranks.size());
    to = std::copy(ranks.begin(), ranks.end(), to);
  }
  const std::vector<Index> told = std::move(parallel::exchange(comm_, answers).items);
  Csr rows;
  rows.offset.reserve(points.size() + 1);
  for (auto at = told.begin(); at != told.end(); at += 1 + *at) rows.push_row({&*at + 1, std::size_t(*at)});
  return rows;
}

CellList send_to_owners(MPI_Comm comm, MeshBlock& block, std::span<const int> part) {
  if (parallel::comm_size(comm) == 1) {
    block.cells.id.resize(block.cells.type.size());
    std::iota(block.cells.id.begin(), block.cells.id.end(), 0);
    return std::move(block.cells);
  }
  Shipments shipments;
  for (Index c = 0; c < block.cells.size(); ++c) shipments.emplace_back(part[c], c);
  const GlobalIndex first = block.cell_shares.first(parallel::comm_rank(comm));
  CellList cells;
  // Blocks have ascending numbers, rank by rank, so received cells are sorted.
  unpack(ship(comm, block.cells, shipments, [&](Index c) { return first + c; }).items, cells);
  block.cells = {};
  return cells;
}

std::vector<CellAcross> cells_across(MPI_Comm comm, const Shares& shares, std::span<const int> part,
                                     const CellList& own) {
  std::vector<GlobalIndex> beyond;
  for (const FaceRecord& r : own.records)
    if (r.is_joined()) beyond.push_back(r.number);
  const PointNumbers numbers(beyond);
  const std::vector<int> rank = fetch(comm, shares, part, numbers.numbers());
  std::vector<CellAcross> across;
  for (Index c = 0; c < own.size(); ++c)
    for (const FaceRecord& r : own.records_of(c))
      if (r.is_joined()) across.push_back({c, rank[numbers.place(r.number)]});
  return across;
}

LocalCells with_one_ring(MPI_Comm comm, CellList own, const std::vector<GlobalIndex>& own_points,
                         const PointDirectory& directory, const std::vector<CellAcross>& across) {
  const int rank = parallel::comm_rank(comm);
  const Csr ranks = directory.ranks_at(own_points);
  std::vector<GlobalIndex> shared;
  Csr sharers;
  for (std::size_t i = 0; i < own_points.size(); ++i)
    if (ranks[Index(i)].size() > 1) {
      shared.push_back(own_points[i]);
      sharers.push_row(ranks[Index(i)]);
    }
  Shipments shipments;
  for (Index c = 0; c < own.size() && !shared.empty(); ++c)
    for (const GlobalIndex p : own.points_of(c)) {
      const auto at = std::ranges::lower_bound(shared, p);
      if (at == shared.end() || *at != p) continue;
      for (const int r : sharers[Index(at - shared.begin())])
        if (r != rank) shipments.emplace_back(r, c);
    }
  // A cell across a periodic face is sent to the rank of the other side.
  for (const CellAcross& a : across)
    if (a.rank != rank) shipments.emplace_back(a.rank, a.cell);
  sort_once(shipments);
  LocalCells local{std::move(own), {}};
  local.owner.assign(local.cells.size(), rank);
  exchange_cells(comm, shipments, local);
  return local;
}

void add_cells_at(MPI_Comm comm, const std::vector<GlobalIndex>& points, const PointDirectory& directory,
                  LocalCells& local) {
  const int rank = parallel::comm_rank(comm);
  const Csr ranks = directory.ranks_at(points);
  std::vector<std::size_t> count(parallel::comm_size(comm), 0);
  for (const Index r : ranks.index) count[r] += r != rank;
  auto wanted = parallel::make_parcels<GlobalIndex>(count);
  std::vector<std::size_t> next(wanted.first.begin(), wanted.first.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Index r : ranks[Index(i)])
      if (r != rank) wanted.items[next[r]++] = points[i];
  const auto asked = parallel::exchange(comm, wanted);
  Shipments shipments;
  for (int r = 0; r < parallel::comm_size(comm); ++r) {
    const auto of_rank = asked.of(r);  // ascending
    if (of_rank.empty()) continue;
    for (Index c = 0; c < local.cells.size(); ++c)
      if (local.owner[c] == rank && std::ranges::any_of(local.cells.points_of(c), [&](GlobalIndex p) {
            return std::ranges::binary_search(of_rank, p);
          }))
        shipments.emplace_back(r, c);
  }
  exchange_cells(comm, shipments, local);
}

namespace {

void fill_cells(const PieceSource& source, const CellList& cells, Piece& piece) {
  RawMesh& raw = piece.raw;
  raw.dim = source.block.dim;
  raw.zones = source.block.zones, raw.patches = source.block.patches;
  if (source.graph.first_bonded >= 0) raw.patches.push_back("(between materials)");
  raw.cell_type = cells.type;
  raw.cell_zone = cells.zone;
  raw.cell_points.offset = cells.point_offset;
  const PointNumbers numbers(cells.points);
  raw.cell_points.index.reserve(cells.points.size());
  for (const GlobalIndex p : cells.points) raw.cell_points.index.push_back(numbers.place(p));
  raw.points = fetch(source.comm, source.block.point_shares, std::span<const Vec3>(source.block.points),
                     numbers.numbers());
  piece.point_number = numbers.numbers();
  const std::vector<int> material = materials_of_zones(source.block);
  for (const int zone : raw.cell_zone)
    if (!material.empty()) piece.cell_material.push_back(material[zone]);
}

void fill_boundary(const CellList& cells, Piece& piece) {
  struct Outer {
    GlobalIndex number;
    Index cell;
    const FaceRecord* record;
  };
  std::vector<Outer> outer;
  for (Index c = 0; c < cells.size(); ++c)
    for (const FaceRecord& r : cells.records_of(c))
      if (!r.is_joined()) outer.push_back({r.number, c, &r});
  std::ranges::sort(outer, {}, &Outer::number);
  for (const Outer& f : outer) {
    piece.raw.boundary_points.push_row(FacePoints(piece.raw, f.cell, f.record->face, f.record->turn));
    piece.raw.boundary_patch.push_back(f.record->patch);
    piece.boundary_cell.push_back(f.cell);
    piece.boundary_number.push_back(f.number);
  }
}

Vec3 mean(const RawMesh& raw, std::span<const Index> points) {
  Vec3 x = Vec3::Zero();
  for (const Index p : points) x += raw.points[p];
  return x / double(points.size());
}

/// Reach n sum w_i^2 of the smallest weights, which are those of the least-squares plane through the nodes: n
/// e^T N^-1 e with the normal matrix N = sum (1, r_i) (1, r_i)^T, the inverse of 1 - s^T M^-1 s / n.
double reach(const std::vector<Vec3>& nodes, const Vec3& point, int dim) {
  Tensor3 m = Tensor3::Zero();
  Vec3 s = Vec3::Zero();
  for (const Vec3& x : nodes) {
    const Vec3 r = point - x;
    m += r * r.transpose();
    s += r;
  }
  if (dim == 2) m(2, 2) = m.trace();
  const double rest = 1 - s.dot(m.fullPivLu().solve(s)) / double(nodes.size());
  return 1 / std::max(rest, 1e-12);
}

}  // namespace

Piece make_piece(const PieceSource& source, const CellList& cells) {
  Piece piece;
  fill_cells(source, cells, piece);
  fill_boundary(cells, piece);
  return piece;
}

std::vector<Index> wide_points(const Piece& piece) {
  const RawMesh& raw = piece.raw;
  const auto n_points = static_cast<Index>(raw.points.size());
  const Csr faces_of_point = transpose(raw.boundary_points, 0, n_points);
  const Csr cells_of_point = transpose(raw.cell_points, 0, n_points);
  const auto material = [&](Index c) { return piece.cell_material.empty() ? 0 : piece.cell_material[c]; };
  std::vector<Index> result;
  std::vector<Vec3> nodes;
  std::vector<int> materials;
  for (Index p = 0; p < n_points; ++p) {
    const auto open = faces_of_point[p];
    if (open.empty()) continue;
    materials.clear();
    for (const Index c : cells_of_point[p])
      if (std::ranges::find(materials, material(c)) == materials.end()) materials.push_back(material(c));
    for (const int here : materials) {
      nodes.clear();
      for (const Index c : cells_of_point[p])
        if (material(c) == here) nodes.push_back(mean(raw, raw.cell_points[c]));
      for (const Index b : open)
        if (material(piece.boundary_cell[b]) == here) nodes.push_back(mean(raw, raw.boundary_points[b]));
      if (reach(nodes, raw.points[p], raw.dim) <= longest_reach) continue;
      result.push_back(p);
      break;
    }
  }
  return result;
}

}  // namespace couplet::mesh
