// SPDX-License-Identifier: Apache-2.0
#include "common/io/probes/place_search.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "common/base/point_tree.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/diagnostics/results.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

namespace {

bool is_flat(mesh::CellType type) { return mesh::shape_of(type).dim == 2; }

// Reference coordinates r, s, t of hexahedron corners in VTK order. A quadrilateral uses the first four.
constexpr int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                              {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

// Products of 1-D hat functions on [0, 1]^n.
ShapeValues brick(const Vec3& x, int n_points, int dim) {
  ShapeValues v;
  for (int i = 0; i < n_points; ++i) {
    std::array<double, 3> hat{1, 1, 1}, slope{0, 0, 0};
    for (int d = 0; d < dim; ++d) {
      hat[d] = corner[i][d] == 1 ? x[d] : 1 - x[d];
      slope[d] = corner[i][d] == 1 ? 1 : -1;
    }
    v.weight[i] = hat[0] * hat[1] * hat[2];
    v.gradient[i] = {slope[0] * hat[1] * hat[2], hat[0] * slope[1] * hat[2], hat[0] * hat[1] * slope[2]};
  }
  return v;
}

ShapeValues simplex(const Vec3& x, int dim) {
  ShapeValues v;
  v.weight[0] = 1;
  v.gradient[0] = Vec3::Zero();
  for (int d = 0; d < dim; ++d) {
    v.weight[0] -= x[d];
    v.gradient[0][d] = -1;
    v.weight[d + 1] = x[d];
    v.gradient[d + 1] = Vec3::Unit(d);
  }
  return v;
}

// Triangle (r, s) times line (t).
ShapeValues prism(const Vec3& x) {
  const ShapeValues triangle = simplex(x, 2);
  ShapeValues v;
  for (int i = 0; i < 6; ++i) {
    const bool top = i >= 3;
    const double hat = top ? x[2] : 1 - x[2], slope = top ? 1 : -1;
    v.weight[i] = triangle.weight[i % 3] * hat;
    v.gradient[i] = triangle.gradient[i % 3] * hat;
    v.gradient[i][2] = triangle.weight[i % 3] * slope;
  }
  return v;
}

// Brick whose upper four corners coincide in the apex.
ShapeValues pyramid(const Vec3& x) {
  const ShapeValues b = brick(x, 8, 3);
  ShapeValues v;
  v.gradient[4] = Vec3::Zero();
  for (int i = 0; i < 8; ++i) {
    const int target = std::min(i, 4);
    if (i < 4) v.gradient[i] = Vec3::Zero();
    v.weight[target] += b.weight[i];
    v.gradient[target] += b.gradient[i];
  }
  return v;
}

bool inside(mesh::CellType type, const Vec3& x, double slack) {
  const bool by_box = type == mesh::CellType::quadrilateral || type == mesh::CellType::hexahedron ||
                      type == mesh::CellType::pyramid;
  const int dim = is_flat(type) ? 2 : 3;
  for (int d = 0; d < dim; ++d)
    if (x[d] < -slack || ((by_box || (type == mesh::CellType::prism && d == 2)) && x[d] > 1 + slack))
      return false;
  if (by_box) return true;
  const double sum = x[0] + x[1] + (type == mesh::CellType::tetrahedron ? x[2] : 0.0);
  return sum <= 1 + slack;
}

}  // namespace

ShapeValues shape_functions(mesh::CellType type, const Vec3& reference) {
  switch (type) {
    case mesh::CellType::triangle:
      return simplex(reference, 2);
    case mesh::CellType::quadrilateral:
      return brick(reference, 4, 2);
    case mesh::CellType::tetrahedron:
      return simplex(reference, 3);
    case mesh::CellType::prism:
      return prism(reference);
    case mesh::CellType::pyramid:
      return pyramid(reference);
    case mesh::CellType::hexahedron:
      return brick(reference, 8, 3);
  }
  return {};
}

std::optional<std::array<double, 8>> weights_in_cell(mesh::CellType type, std::span<const Vec3> points,
                                                     const Vec3& place, double slack) {
  const int n = mesh::shape_of(type).n_points;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const double size = (high - low).norm();
  if (((place - low).array() < -slack * size).any() || ((place - high).array() > slack * size).any())
    return std::nullopt;

  // Newton's method for sum_i N_i(x) (X_i - X_0) = place - X_0, with differences to avoid round-off far from
  // the origin. Simplices need one step, others a few.
  Vec3 x = Vec3::Constant(is_flat(type) ? 1.0 / 3 : 0.25);
  ShapeValues shape;
  for (int iteration = 0; iteration < 30; ++iteration) {
    shape = shape_functions(type, x);
    Vec3 residual = place - points[0];
    Tensor3 jacobian = Tensor3::Zero();
    for (int i = 0; i < n; ++i) {
      const Vec3 edge = points[i] - points[0];
      residual -= shape.weight[i] * edge;
      jacobian += edge * shape.gradient[i].transpose();
    }
    if (is_flat(type)) {
      jacobian.row(2).setZero();
      jacobian.col(2).setZero();
      jacobian(2, 2) = size;
      residual[2] = 0;
    }
    if (residual.norm() <= 1e-13 * size)
      return inside(type, x, slack) ? std::optional(shape.weight) : std::nullopt;
    x += jacobian.fullPivLu().solve(residual);
    if (!x.allFinite() || x.norm() > 10) return std::nullopt;
  }
  return std::nullopt;
}

struct Balls::BallGroup {
  double radius = 0;  // largest
  std::vector<Vec3> centres{};
  std::vector<Index> number{};
  std::unique_ptr<base::PointTree> tree{};
};

Balls::Balls(std::vector<Vec3> centres, std::vector<double> radii) {
  std::map<int, std::unique_ptr<BallGroup>> by_size;
  for (std::size_t i = 0; i < centres.size(); ++i) {
    auto& group = by_size[radii[i] > 0 ? std::ilogb(radii[i]) : -10000];
    if (!group) group = std::make_unique<BallGroup>();
    group->radius = std::max(group->radius, radii[i]);
    group->centres.push_back(centres[i]);
    group->number.push_back(static_cast<Index>(i));
  }
  for (auto& [size, group] : by_size) {
    group->tree = std::make_unique<base::PointTree>(group->centres);
    groups_.push_back(std::move(group));
  }
}
Balls::~Balls() = default;
Balls::Balls(Balls&&) noexcept = default;

std::vector<Index> Balls::near(const Vec3& x, double slack) const {
  std::vector<Index> all;
  for (const auto& group : groups_)
    for (const Index i : group->tree->within(x, group->radius * (1 + 1e-6) + slack))
      all.push_back(group->number[i]);
  std::ranges::sort(all);
  return all;
}

namespace {

/// Adds a ball around the mean of some points.
void add_ball(std::span<const Vec3> places, std::span<const Index> points, std::vector<Vec3>& centres,
              std::vector<double>& radii) {
  Vec3 centre = Vec3::Zero();
  for (const Index p : points) centre += places[p] / double(points.size());
  double radius = 0;
  for (const Index p : points) radius = std::max(radius, (places[p] - centre).norm());
  centres.push_back(centre);
  radii.push_back(radius);
}

Balls point_balls(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  const auto n = mesh.points.n_owned();
  return {{places.begin(), places.begin() + n}, std::vector<double>(n, 0.0)};
}

Balls cell_balls(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  std::vector<Vec3> centres;
  std::vector<double> radii;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) add_ball(places, mesh.cell_points[c], centres, radii);
  return {std::move(centres), std::move(radii)};
}

Balls face_balls(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  std::vector<Vec3> centres;
  std::vector<double> radii;
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    add_ball(places, mesh.face_points[f], centres, radii);
  return {std::move(centres), std::move(radii)};
}

}  // namespace

double mesh_size(const mesh::Mesh& mesh, std::span<const Vec3> places) {
  return mesh::extent_of(mesh.comm, places).diagonal();
}

PlaceSearch::PlaceSearch(const mesh::Mesh& mesh, std::span<const Vec3> places)
    : mesh_(mesh),
      places_(places),
      size_(mesh_size(mesh, places)),
      points_(point_balls(mesh, places)),
      cells_(cell_balls(mesh, places)),
      faces_(face_balls(mesh, places)) {}

std::vector<Index> PlaceSearch::faces(const Vec3& x, double slack) const {
  std::vector<Index> faces = faces_.near(x, slack);
  for (Index& f : faces) f += mesh_.n_interior;
  return faces;
}

void check_mesh_scale(const mesh::Mesh& mesh, std::span<const Vec3> points, std::span<const Vec3> places,
                      double mesh_scale) {
  constexpr double largest = 2e3;       // [m]
  constexpr double smallest = 1e-6;     // [m]
  constexpr double corner = 1.0 / 300;  // between sizes in one case and a confusion of mm and m
  const double size = mesh_size(mesh, points);
  const Vec3 extent = mesh::extent_of(mesh.comm, points).size();
  if (parallel::comm_rank(mesh.comm) == 0) diagnostics::set_mesh_size(extent, mesh.dim, mesh_scale);
  if (size < smallest || extent.maxCoeff() > largest)
    diagnostics::finding(
        parallel::comm_rank(mesh.comm),
        {.id = "questionable-mesh-scale",
         .number = size,
         .limit = size < smallest ? smallest : largest,
         .sentence =
             fmt::format("mesh size: {:.3g} x {:.3g} x {:.3g} m (usual: {:g} to {:g} m): questionable",
                         extent[0], extent[1], extent[2], smallest, largest),
         .advice =
             "if it was drawn in millimeters, set 'mesh-scale: 0.001'; if it is right, accept this finding"});
  double farthest = 0;
  for (const Vec3& place : places) farthest = std::max(farthest, place.norm());
  if (farthest > 0 && farthest < corner * size)
    diagnostics::finding(
        parallel::comm_rank(mesh.comm),
        {.id = "questionable-mesh-scale",
         .number = farthest,
         .limit = corner * size,
         .sentence =
             fmt::format("probe positions: all within {:.3g} m of the origin in a mesh of {:.3g} m (usual: "
                         "over {:.3g} m): implausible",
                         farthest, size, corner * size),
         .advice = "is the mesh in millimeters? Then set 'mesh-scale: 0.001'"});
}

}  // namespace couplet::io
