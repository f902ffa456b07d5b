// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

/// Points on a grid, and for each grid cell its corners in hexahedron (or quadrilateral) order.
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

  void add(CellType type, std::initializer_list<Index> points) {
    mesh.cell_type.push_back(type);
    mesh.cell_zone.push_back(0);
    mesh.cell_points.push_row({points.begin(), points.size()});
  }

  Index add_centre(const std::array<Index, 8>& p) {
    Vec3 x = Vec3::Zero();
    for (const Index i : p) x += mesh.points[i] / 8;
    mesh.points.push_back(x);
    return static_cast<Index>(mesh.points.size()) - 1;
  }

  RawMesh mesh;

 private:
  std::array<int, 3> n_;
  int dim_;
};

void add_quadrilateral(Grid& g, const std::array<Index, 8>& p) {
  g.add(CellType::quadrilateral, {p[0], p[1], p[2], p[3]});
}

void add_triangles(Grid& g, const std::array<Index, 8>& p) {
  g.add(CellType::triangle, {p[0], p[1], p[2]});
  g.add(CellType::triangle, {p[0], p[2], p[3]});
}

void add_hexahedron(Grid& g, const std::array<Index, 8>& p) {
  g.add(CellType::hexahedron, {p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]});
}

void add_prisms(Grid& g, const std::array<Index, 8>& p) {
  g.add(CellType::prism, {p[0], p[1], p[2], p[4], p[5], p[6]});
  g.add(CellType::prism, {p[0], p[2], p[3], p[4], p[6], p[7]});
}

/// Kuhn's cut along the diagonal 0-6: the same in every grid cell, so neighbours agree.
void add_tetrahedra(Grid& g, const std::array<Index, 8>& p) {
  constexpr std::array<int, 7> ring{1, 2, 3, 7, 4, 5, 1};
  for (int i = 0; i < 6; ++i) g.add(CellType::tetrahedron, {p[0], p[ring[i]], p[ring[i + 1]], p[6]});
}

/// From the centre: pyramids on the side faces; top and bottom as pyramids or, beside prisms, as two
/// tetrahedra each.
void add_star(Grid& g, const std::array<Index, 8>& p, bool cut_top_and_bottom) {
  const Index c = g.add_centre(p);
  g.add(CellType::pyramid, {p[0], p[4], p[5], p[1], c});
  g.add(CellType::pyramid, {p[1], p[5], p[6], p[2], c});
  g.add(CellType::pyramid, {p[2], p[6], p[7], p[3], c});
  g.add(CellType::pyramid, {p[3], p[7], p[4], p[0], c});
  if (cut_top_and_bottom) {
    g.add(CellType::tetrahedron, {p[0], p[1], p[2], c});
    g.add(CellType::tetrahedron, {p[0], p[2], p[3], c});
    g.add(CellType::tetrahedron, {p[4], p[6], p[5], c});
    g.add(CellType::tetrahedron, {p[4], p[7], p[6], c});
  } else {
    g.add(CellType::pyramid, {p[0], p[1], p[2], p[3], c});
    g.add(CellType::pyramid, {p[7], p[6], p[5], p[4], c});
  }
}

/// Columns of hexahedra, of prisms with stars in every second layer, and of stars: all four types,
/// conforming.
void add_mixed(Grid& g, const std::array<Index, 8>& p, int i, int j, int k) {
  switch ((i + j) % 3) {
    case 0:
      return add_hexahedron(g, p);
    case 1:
      return k % 2 == 0 ? add_prisms(g, p) : add_star(g, p, true);
    default:
      return add_star(g, p, false);
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
      for (int i = 0; i < n[0]; ++i) {
        const auto p = grid.corners(i, j, k);
        switch (cells) {
          case BoxCells::quadrilaterals:
            add_quadrilateral(grid, p);
            break;
          case BoxCells::triangles:
            add_triangles(grid, p);
            break;
          case BoxCells::hexahedra:
            add_hexahedron(grid, p);
            break;
          case BoxCells::tetrahedra:
            add_tetrahedra(grid, p);
            break;
          case BoxCells::prisms:
            add_prisms(grid, p);
            break;
          case BoxCells::mixed:
            add_mixed(grid, p, i, j, k);
            break;
        }
      }
  name_sides(grid.mesh, lower, upper);
  return std::move(grid.mesh);
}

void perturb_interior(RawMesh& raw, double amount, unsigned seed) {
  std::vector<char> fixed(raw.points.size(), 0);
  for (const Index p : raw.boundary_points.index) fixed[p] = 1;
  // Local spacing: distance to the nearest point of the same cells.
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

}  // namespace couplet::mesh
