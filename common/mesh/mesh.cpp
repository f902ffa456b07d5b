// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/mesh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {

namespace {

/// Points of a grid, and the corners of each grid cell in hexahedron (or quadrilateral) order.
class Grid {
 public:
  Grid(const std::array<int, 3>& n, const Vec3& lower, const Vec3& upper, int dim) : n_(n), dim_(dim) {
    mesh.dim = dim;
    mesh.zones = {"default"};
    for (int k = 0; k <= (dim == 3 ? n[2] : 0); ++k)
      for (int j = 0; j <= n[1]; ++j)
        for (int i = 0; i <= n[0]; ++i) {
          const Vec3 s(double(i) / n[0], double(j) / n[1], dim == 3 ? double(k) / n[2] : 0);
          Vec3 x = lower + s.cwiseProduct(upper - lower);
          if (dim == 2) x[2] = 0;
          mesh.points.push_back(x);
        }
  }

  std::array<Index, 8> corners(int i, int j, int k) const {
    const auto at = [&](int a, int b, int c) {
      return static_cast<Index>((i + a) + (n_[0] + 1) * ((j + b) + (n_[1] + 1) * (k + c)));
    };
    const int up = dim_ == 3 ? 1 : 0;
    return {at(0, 0, 0),  at(1, 0, 0),  at(1, 1, 0),  at(0, 1, 0),
            at(0, 0, up), at(1, 0, up), at(1, 1, up), at(0, 1, up)};
  }

  void add(CellType type, std::span<const Index> points) {
    mesh.cell_type.push_back(type);
    mesh.cell_zone.push_back(0);
    mesh.cell_points.push_row(points);
  }

  RawMesh mesh;

 private:
  std::array<int, 3> n_;
  int dim_;
};

/// Cell within a grid cell. Its points are corners in hexahedron or quadrilateral order, or 8 for the center.
struct Cut {
  CellType type;
  std::array<int, 8> points;
};
using Cuts = std::span<const Cut>;
constexpr int center = 8;

constexpr Cut whole_quadrilateral[]{{CellType::quadrilateral, {0, 1, 2, 3}}};
constexpr Cut two_triangles[]{{CellType::triangle, {0, 1, 2}}, {CellType::triangle, {0, 2, 3}}};
constexpr Cut whole_hexahedron[]{{CellType::hexahedron, {0, 1, 2, 3, 4, 5, 6, 7}}};
constexpr Cut two_prisms[]{{CellType::prism, {0, 1, 2, 4, 5, 6}}, {CellType::prism, {0, 2, 3, 4, 6, 7}}};
// Kuhn's subdivision along the diagonal 0-6 is the same in every grid cell, so neighbors agree.
constexpr Cut six_tetrahedra[]{{CellType::tetrahedron, {0, 1, 2, 6}}, {CellType::tetrahedron, {0, 2, 3, 6}},
                               {CellType::tetrahedron, {0, 3, 7, 6}}, {CellType::tetrahedron, {0, 7, 4, 6}},
                               {CellType::tetrahedron, {0, 4, 5, 6}}, {CellType::tetrahedron, {0, 5, 1, 6}}};
// Cells around the center: pyramids on the sides; pyramids at top and bottom or, beside prisms, two
// tetrahedra each.
constexpr Cut star_sides[]{{CellType::pyramid, {0, 4, 5, 1, center}},
                           {CellType::pyramid, {1, 5, 6, 2, center}},
                           {CellType::pyramid, {2, 6, 7, 3, center}},
                           {CellType::pyramid, {3, 7, 4, 0, center}}};
constexpr Cut star_ends[]{{CellType::pyramid, {0, 1, 2, 3, center}},
                          {CellType::pyramid, {7, 6, 5, 4, center}}};
constexpr Cut cut_star_ends[]{{CellType::tetrahedron, {0, 1, 2, center}},
                              {CellType::tetrahedron, {0, 2, 3, center}},
                              {CellType::tetrahedron, {4, 6, 5, center}},
                              {CellType::tetrahedron, {4, 7, 6, center}}};

/// Cells of a grid cell; the second part is that of a star. `mixed` has columns of hexahedra, of prisms with
/// stars in every second layer, and of stars, so that it contains all four types and is conforming.
std::array<Cuts, 2> cuts_of(BoxCells cells, int i, int j, int k) {
  switch (cells) {
    case BoxCells::quadrilaterals:
      return {whole_quadrilateral};
    case BoxCells::triangles:
      return {two_triangles};
    case BoxCells::hexahedra:
      return {whole_hexahedron};
    case BoxCells::tetrahedra:
      return {six_tetrahedra};
    case BoxCells::prisms:
      return {two_prisms};
    case BoxCells::mixed:
      break;
  }
  if ((i + j) % 3 == 0) return {whole_hexahedron};
  if ((i + j) % 3 == 2) return {star_sides, star_ends};
  if (k % 2 == 0) return {two_prisms};
  return {star_sides, cut_star_ends};
}

void add_cells(Grid& grid, const std::array<Cuts, 2>& cuts, const std::array<Index, 8>& corners) {
  std::array<Index, 9> all{};
  std::ranges::copy(corners, all.begin());
  if (!cuts[1].empty()) {
    Vec3 x = Vec3::Zero();
    for (const Index i : corners) x += grid.mesh.points[i] / 8;
    all[center] = static_cast<Index>(grid.mesh.points.size());
    grid.mesh.points.push_back(x);
  }
  std::vector<Index> points;
  for (const Cuts& cells : cuts)
    for (const Cut& cell : cells) {
      points.clear();
      for (int i = 0; i < shape_of(cell.type).n_points; ++i) points.push_back(all[cell.points[i]]);
      grid.add(cell.type, points);
    }
}

void name_sides(RawMesh& mesh, const Vec3& lower, const Vec3& upper) {
  mesh.patches = {"xmin", "xmax", "ymin", "ymax"};
  if (mesh.dim == 3) mesh.patches.insert(mesh.patches.end(), {"zmin", "zmax"});
  mesh.boundary_points = outer_faces(mesh);
  for (Index e = 0; e < mesh.boundary_points.size(); ++e) {
    double best = std::numeric_limits<double>::max();
    int side = 0;
    for (int s = 0; s < 2 * mesh.dim; ++s) {
      const int axis = s / 2;
      const double plane = s % 2 == 0 ? lower[axis] : upper[axis];
      double distance = 0;
      for (const Index p : mesh.boundary_points[e])
        distance = std::max(distance, std::abs(mesh.points[p][axis] - plane));
      distance /= upper[axis] - lower[axis];
      if (distance < best) {
        best = distance;
        side = s;
      }
    }
    mesh.boundary_patch.push_back(side);
  }
}

}  // namespace

RawMesh make_box(BoxCells cells, const std::array<int, 3>& n, const Vec3& lower, const Vec3& upper) {
  const bool flat = cells == BoxCells::quadrilaterals || cells == BoxCells::triangles;
  Grid grid(n, lower, upper, flat ? 2 : 3);
  for (int k = 0; k < (flat ? 1 : n[2]); ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) add_cells(grid, cuts_of(cells, i, j, k), grid.corners(i, j, k));
  name_sides(grid.mesh, lower, upper);
  return std::move(grid.mesh);
}

void perturb_interior(RawMesh& raw, double amount, unsigned seed) {
  std::vector<char> fixed(raw.points.size(), 0);
  for (const Index p : raw.boundary_points.index) fixed[p] = 1;
  // Local spacing is the distance to the nearest point of the same cells.
  std::vector<double> spacing(raw.points.size(), std::numeric_limits<double>::max());
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c])
      for (const Index q : raw.cell_points[c])
        if (p != q) spacing[p] = std::min(spacing[p], (raw.points[p] - raw.points[q]).norm());
  std::mt19937 random(seed);
  for (std::size_t p = 0; p < raw.points.size(); ++p)
    for (int axis = 0; axis < raw.dim; ++axis) {
      const double s = 2.0 * random() / double(std::mt19937::max()) - 1;
      if (!fixed[p]) raw.points[p][axis] += s * amount * spacing[p];
    }
}

namespace {

double* flat(std::vector<Vec3>& values) { return values.empty() ? nullptr : values.front().data(); }

/// Triangles of a face: one, or two separated by the diagonal through the point with the smallest point_id.
struct Triangles {
  int count;
  std::array<std::array<Index, 3>, 2> corner;
};

Triangles triangles_of(const Mesh& mesh, Index face) {
  const auto p = mesh.face_points[face];
  if (p.size() == 3) return {1, {{{p[0], p[1], p[2]}}}};
  int s = 0;
  for (int i = 1; i < 4; ++i)
    if (mesh.point_id[p[i]] < mesh.point_id[p[s]]) s = i;
  const auto at = [&](int i) { return p[(s + i) % 4]; };
  return {2, {{{at(0), at(1), at(2)}, {at(0), at(2), at(3)}}}};
}

/// Adds the cone of `apex` and triangle (a, b, c) to a cell's volume and first moment about `apex`.
void add_cone(double sign, const Vec3& apex, const Vec3& a, const Vec3& b, const Vec3& c, double& volume,
              Vec3& moment) {
  const Vec3 u = a - apex, v = b - apex, w = c - apex;
  const double cone = sign * u.dot(v.cross(w)) / 6;
  volume += cone;
  moment += cone / 4 * (u + v + w);
}

void faces_3d(const Mesh& mesh, const std::vector<Vec3>& apex, Geometry& g) {
  const std::vector<Vec3>& x = g.points;
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Triangles t = triangles_of(mesh, f);
    Vec3 area = Vec3::Zero(), moment = Vec3::Zero(), mean = Vec3::Zero();
    double total = 0;
    const Index o = mesh.owner[f];
    const Vec3 shift = f < mesh.n_interior ? mesh.shift(f) : Vec3(Vec3::Zero());
    for (int i = 0; i < t.count; ++i) {
      const Vec3 &a = x[t.corner[i][0]], &b = x[t.corner[i][1]], &c = x[t.corner[i][2]];
      const Vec3 s = 0.5 * (b - a).cross(c - a);
      const double size = s.norm();
      const Vec3 centre = (a + b + c) / 3;
      area += s;
      moment += size * centre;
      mean += centre / t.count;
      total += size;
      add_cone(1, apex[o], a, b, c, g.volume[o], g.cell_centre[o]);
      if (f < mesh.n_interior) {
        const Index n = mesh.neighbour[f];
        add_cone(-1, apex[n] + shift, a, b, c, g.volume[n], g.cell_centre[n]);
      }
    }
    g.face_area[f] = area;
    g.face_centre[f] = total > 0 ? Vec3(moment / total) : mean;
  }
}

void faces_2d(const Mesh& mesh, const std::vector<Vec3>& apex, Geometry& g) {
  const std::vector<Vec3>& x = g.points;
  const auto add_triangle = [&](double sign, Index cell, const Vec3& centre, const Vec3& a, const Vec3& b) {
    const Vec3 u = a - centre, v = b - centre;
    const double triangle = sign * 0.5 * (u[0] * v[1] - u[1] * v[0]);
    g.volume[cell] += triangle;
    g.cell_centre[cell] += triangle / 3 * (u + v);
  };
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Vec3 &a = x[mesh.face_points[f][0]], &b = x[mesh.face_points[f][1]];
    g.face_area[f] = Vec3(b[1] - a[1], a[0] - b[0], 0);
    g.face_centre[f] = 0.5 * (a + b);
    const Index o = mesh.owner[f];
    add_triangle(1, o, apex[o], a, b);
    if (f >= mesh.n_interior) continue;
    const Index n = mesh.neighbour[f];
    add_triangle(-1, n, apex[n] + mesh.shift(f), a, b);
  }
}

}  // namespace

Geometry compute_geometry(const Mesh& mesh, std::vector<Vec3> points) {
  const Index n = mesh.cells.n_local();
  Geometry g;
  g.points = std::move(points);
  g.volume.assign(n, 0);
  g.cell_centre.assign(n, Vec3::Zero());
  g.face_area.resize(mesh.n_faces());
  g.face_centre.resize(mesh.n_faces());
  // Cones from a point inside each cell limit round-off far from the origin.
  std::vector<Vec3> apex(n, Vec3::Zero());
  for (Index c = 0; c < n; ++c) {
    for (const Index p : mesh.cell_points[c]) apex[c] += g.points[p];
    apex[c] /= double(mesh.cell_points[c].size());
  }
  mesh.dim == 2 ? faces_2d(mesh, apex, g) : faces_3d(mesh, apex, g);
  for (Index c = 0; c < n; ++c)
    g.cell_centre[c] = g.volume[c] == 0 ? apex[c] : Vec3(apex[c] + g.cell_centre[c] / g.volume[c]);
  // A ghost may lack faces on this rank, so its values come from the owner.
  mesh.cells.update_ghosts(std::span<double>(g.volume));
  mesh.cells.update_ghosts(std::span<double>(flat(g.cell_centre), 3 * std::size_t(n)), 3);
  return g;
}

std::vector<double> swept_volumes(const Mesh& mesh, std::span<const Vec3> from, std::span<const Vec3> to) {
  std::vector<double> swept(mesh.n_faces(), 0);
  if (mesh.dim == 2) {
    // The edge vector is linear in time, so its mean is at the middle position. The mean velocity is
    // constant.
    for (Index f = 0; f < mesh.n_faces(); ++f) {
      const Index a = mesh.face_points[f][0], b = mesh.face_points[f][1];
      const auto old_a = from[a].head<2>(), old_b = from[b].head<2>(), new_a = to[a].head<2>(),
                 new_b = to[b].head<2>();
      const Vec<2> e = 0.5 * (old_b - old_a + new_b - new_a);
      const Vec<2> d = 0.5 * (new_a - old_a + new_b - old_b);
      swept[f] = d[0] * e[1] - d[1] * e[0];
    }
    return swept;
  }
  // Thesis (4.16)-(4.17): a triangle with edges e1(s) = e1 + s f1, e2(s) = e2 + s f2, 0 <= s <= 1, and mean
  // displacement d sweeps d . integral of (e1 x e2)/2 ds. The integrand is quadratic in s.
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Triangles t = triangles_of(mesh, f);
    for (int i = 0; i < t.count; ++i) {
      const auto [a, b, c] = t.corner[i];
      const Vec3 e1 = from[b] - from[a], e2 = from[c] - from[a];
      const Vec3 f1 = to[b] - to[a] - e1, f2 = to[c] - to[a] - e2;
      const Vec3 mean_area = 0.5 * (e1.cross(e2) + 0.5 * (e1.cross(f2) + f1.cross(e2)) + f1.cross(f2) / 3);
      const Vec3 d = (to[a] - from[a] + to[b] - from[b] + to[c] - from[c]) / 3;
      swept[f] += d.dot(mean_area);
    }
  }
  return swept;
}

}  // namespace couplet::mesh
