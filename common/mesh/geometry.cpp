// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <array>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh {
namespace {

double* flat(std::vector<Vec3>& values) { return values.empty() ? nullptr : values.front().data(); }

/// The triangles of a face: one, or two on either side of the diagonal through the point with the smallest
/// point_id.
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

/// Adds the cone between `apex` and the triangle (a, b, c) to a cell's volume and first moment about `apex`.
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
  // Cones from a point inside each cell keep round-off small far from the origin.
  std::vector<Vec3> apex(n, Vec3::Zero());
  for (Index c = 0; c < n; ++c) {
    for (const Index p : mesh.cell_points[c]) apex[c] += g.points[p];
    apex[c] /= double(mesh.cell_points[c].size());
  }
  mesh.dim == 2 ? faces_2d(mesh, apex, g) : faces_3d(mesh, apex, g);
  for (Index c = 0; c < n; ++c)
    g.cell_centre[c] = g.volume[c] == 0 ? apex[c] : Vec3(apex[c] + g.cell_centre[c] / g.volume[c]);
  // Not all faces of a ghost are here: its owner knows.
  mesh.cells.update_ghosts(std::span<double>(g.volume));
  mesh.cells.update_ghosts(std::span<double>(flat(g.cell_centre), 3 * std::size_t(n)), 3);
  return g;
}

std::vector<double> swept_volumes(const Mesh& mesh, std::span<const Vec3> from, std::span<const Vec3> to) {
  std::vector<double> swept(mesh.n_faces(), 0);
  if (mesh.dim == 2) {
    // The edge vector is linear in time, so its mean is that of the middle position; the mean velocity is
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
  // displacement d sweeps d . integral of (e1 x e2)/2 ds; the integrand is quadratic in s.
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
