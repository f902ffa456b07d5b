// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/mesh/cell_shapes.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

/// Volume of a cell as its points stand, quadrilateral faces cut at their first point: good enough for a
/// sign.
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

/// Diameter of the cell's bounding box: the scale below which a volume counts as none.
double extent(const RawMesh& raw, Index cell) {
  Vec3 low = raw.points[raw.cell_points[cell][0]], high = low;
  for (const Index p : raw.cell_points[cell]) {
    low = low.cwiseMin(raw.points[p]);
    high = high.cwiseMax(raw.points[p]);
  }
  return (high - low).norm();
}

}  // namespace

void orient_cells(RawMesh& raw, GlobalIndex first) {
  if (raw.cell_points.size() == 0)
    throw Error(
        "The mesh has no {} cells. Put the {} into a physical group; otherwise gmsh does not save "
        "them.",
        raw.dim == 2 ? "triangle or quadrilateral" : "3-D", raw.dim == 2 ? "surface" : "volume");
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

void drop_unused_points(RawMesh& raw) {
  std::vector<Index> number(raw.points.size(), -1);
  for (const Index p : raw.cell_points.index) number[p] = 0;
  // A boundary element with points that no cell has is an error of its own, reported with its place later.
  for (const Index p : raw.boundary_points.index) number[p] = 0;
  Index n = 0;
  for (std::size_t p = 0; p < raw.points.size(); ++p) {
    if (number[p] < 0) continue;
    raw.points[n] = raw.points[p];
    number[p] = n++;
  }
  raw.points.resize(n);
  for (Index& p : raw.cell_points.index) p = number[p];
  for (Index& p : raw.boundary_points.index) p = number[p];
}

}  // namespace couplet::mesh
