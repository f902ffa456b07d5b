// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/piece.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

void fill_cells(const PieceSource& source, const CellList& cells, Piece& piece) {
  RawMesh& raw = piece.raw;
  raw.dim = source.block.dim;
  raw.zones = source.block.zones, raw.patches = source.block.patches;
  raw.materials = source.block.materials;
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
  piece.cell_material = materials_of_cells(raw);
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

/// The least weights are those of the least-squares plane through the nodes, n sum w_i^2 = n e^T N^-1 e with
/// its normal matrix N = sum (1, r_i) (1, r_i)^T: the inverse of 1 - s^T M^-1 s / n.
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

FacePoints::FacePoints(const RawMesh& raw, Index cell, int face, int turn) {
  const CellShape& shape = shape_of(raw.cell_type[cell]);
  n = std::size_t(shape.face_size(face));
  for (std::size_t i = 0; i < n; ++i)
    points[i] = raw.cell_points[cell][shape.faces[face][(i + std::size_t(turn)) % n]];
}

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
