// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/topology.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::mesh {

namespace {

constexpr CellShape triangle{2, 3, 3, {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}}}, {0, 2, 1}};
constexpr CellShape quadrilateral{
    2, 4, 4, {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}}}, {0, 3, 2, 1}};
constexpr CellShape tetrahedron{
    3, 4, 4, {{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}}}, {0, 2, 1, 3}};
constexpr CellShape hexahedron{
    3,
    8,
    6,
    {{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
    {0, 3, 2, 1, 4, 7, 6, 5}};
constexpr CellShape prism{
    3, 6, 5, {{{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}}, {0, 2, 1, 3, 5, 4}};
constexpr CellShape pyramid{
    3, 5, 5, {{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}}, {0, 3, 2, 1, 4}};

}  // namespace

const CellShape& shape_of(CellType type) {
  static constexpr std::array<const CellShape*, 6> shapes{&triangle,   &quadrilateral, &tetrahedron,
                                                          &hexahedron, &prism,         &pyramid};
  return *shapes[static_cast<std::size_t>(type)];
}

const char* name_of(CellType type) {
  static constexpr std::array<const char*, 6> names{"triangle",   "quadrilateral", "tetrahedron",
                                                    "hexahedron", "prism",         "pyramid"};
  return names[static_cast<std::size_t>(type)];
}

namespace {

/// Signed volume of a cell. Quadrilateral faces are split at their first point, which suffices for the sign.
double signed_volume(const RawMesh& raw, Index cell) {
  const CellShape& shape = shape_of(raw.cell_type[cell]);
  const auto points = raw.cell_points[cell];
  const Vec3& origin = raw.points[points[0]];
  double volume = 0;
  for (int f = 0; f < shape.n_faces; ++f) {
    const auto x = [&](int i) -> Vec3 { return raw.points[points[shape.faces[f][i]]] - origin; };
    if (shape.dim == 2) {
      const Vec3 a = x(0), b = x(1);
      volume += 0.5 * (a[0] * b[1] - a[1] * b[0]);
      continue;
    }
    for (int i = 2; i < shape.face_size(f); ++i) volume += x(0).dot(x(i - 1).cross(x(i))) / 6;
  }
  return volume;
}

/// Diameter of the cell's bounding box, relative to which a volume counts as zero.
double extent(const RawMesh& raw, Index cell) {
  Vec3 low = raw.points[raw.cell_points[cell][0]], high = low;
  for (const Index p : raw.cell_points[cell]) {
    low = low.cwiseMin(raw.points[p]);
    high = high.cwiseMax(raw.points[p]);
  }
  return (high - low).norm();
}

}  // namespace

FacePoints::FacePoints(const RawMesh& raw, Index cell, int face, int turn) {
  const CellShape& shape = shape_of(raw.cell_type[cell]);
  n = std::size_t(shape.face_size(face));
  for (std::size_t i = 0; i < n; ++i)
    points[i] = raw.cell_points[cell][shape.faces[face][(i + std::size_t(turn)) % n]];
}

std::string place(const Vec3& x, int dim) {
  // Adding 0.0 converts -0 to 0.
  return dim == 2 ? fmt::format("({:.6g}, {:.6g})", x[0] + 0.0, x[1] + 0.0)
                  : fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0] + 0.0, x[1] + 0.0, x[2] + 0.0);
}

Csr outer_faces(const RawMesh& raw) {
  HalfFaces halves(raw);
  std::vector<HalfFace> outer;
  halves.for_each_face([&](std::span<const HalfFace> cells) {
    if (cells.size() == 1) outer.push_back(cells[0]);
  });
  std::sort(outer.begin(), outer.end(), [](const HalfFace& a, const HalfFace& b) {
    return std::pair(a.cell, a.face) < std::pair(b.cell, b.face);
  });
  Csr result;
  for (const HalfFace& h : outer) result.push_row(halves.points(h));
  return result;
}

void orient_cells(RawMesh& raw, GlobalIndex first) {
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    const CellShape& shape = shape_of(raw.cell_type[c]);
    Index* points = raw.cell_points.index.data() + raw.cell_points.offset[c];
    if (shape.dim != raw.dim)
      throw Error("Cell {} at {} is a {}, which does not fit a {}-D mesh.", first + c,
                  place(raw.points[points[0]], 3), name_of(raw.cell_type[c]), raw.dim);
    const double volume = signed_volume(raw, c);
    if (!(std::abs(volume) > 1e-13 * std::pow(extent(raw, c), raw.dim)))
      throw Error(
          "Cell {} at {} has zero volume: its points lie in one {}, or some coincide. Repair the mesh there.",
          first + c, place(raw.points[points[0]], raw.dim), raw.dim == 2 ? "line" : "plane");
    if (volume > 0) continue;
    std::array<Index, 8> as_read{};
    std::copy_n(points, shape.n_points, as_read.begin());
    for (int i = 0; i < shape.n_points; ++i) points[i] = as_read[shape.mirrored[i]];
  }
}

void check_plane(std::span<const Vec3> points, double diagonal) {
  for (const Vec3& x : points)
    if (std::abs(x[2]) > 1e-12 * diagonal)
      throw Error(
          "The 2-D mesh has a point at {}. A 2-D mesh must lie in the plane z = 0; rotate or shift it there.",
          place(x, 3));
}

}  // namespace couplet::mesh
