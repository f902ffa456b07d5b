// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/sparse_map.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/face_weights.hpp"

namespace couplet::coupler {
namespace {

/// Map for a side without listed corners: local interpolants through the structure's face centers.
std::vector<Transfer::Entry> without_corners(MPI_Comm comm, const Surroundings& structure,
                                             const PointSet& vertices, int dim) {
  std::vector<Transfer::Entry> entries;
  add_interpolation(comm, structure.faces(), vertices.points, vertices.positions, dim == 2 ? 5 : 10, entries);
  return entries;
}

using Vec2 = Eigen::Vector2d;
using Polygon = std::vector<Vec2>;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Face projected to its plane: simplices (edges or triangles) with the corner functions at their ends.
struct Flat {
  Vec3 origin, normal, x, y;
  Index n;  // corners
  struct Simplex {
    std::array<Vec2, 3> at;
    std::array<Index, 3> corner;  // -1 where all functions are 1/n
    Vec2 low = Vec2::Zero(), high = Vec2::Zero();
  };
  std::vector<Simplex> simplices;
  double size = 0;  // area, or length

  Flat(const coupling::Interface& s, Index face);
  Vec2 flat(const Vec3& p) const { return {x.dot(p - origin), y.dot(p - origin)}; }
  Eigen::MatrixXd zero() const { return Eigen::MatrixXd::Zero(n, n); }
};

Flat::Flat(const coupling::Interface& s, Index face)
    : origin(s.face_centres[face]), normal(s.face_areas[face].normalized()) {
  const auto vertex = corners(s, face);
  n = Index(vertex.size());
  x = s.vertices[vertex[1]] - s.vertices[vertex[0]];
  if (s.dim == 3) x -= normal * normal.dot(x);
  x.normalize();
  y = s.dim == 3 ? Vec3(normal.cross(x)) : normal;
  const auto at = [&](Index i) { return flat(s.vertices[vertex[std::size_t(i)]]); };
  if (n == 2) {
    simplices.push_back({{at(0), at(1), Vec2(Vec2::Zero())}, {0, 1, -1}});
    size = std::abs(at(1).x() - at(0).x());
    return;
  }
  simplices.reserve(std::size_t(n));
  if (n == 3) {
    simplices.push_back({{at(0), at(1), at(2)}, {0, 1, 2}});
  } else {
    Vec2 centre = Vec2::Zero();
    for (Index i = 0; i < n; ++i) centre += at(i) / double(n);
    for (Index i = 0; i < n; ++i)
      simplices.push_back({{at(i), at((i + 1) % n), centre}, {i, (i + 1) % n, -1}});
  }
  for (Simplex& t : simplices) {
    const double area = 0.5 * cross(t.at[1] - t.at[0], t.at[2] - t.at[0]);
    if (area < 0) std::swap(t.at[0], t.at[1]), std::swap(t.corner[0], t.corner[1]);
    size += std::abs(area);
    t.low = t.at[0].cwiseMin(t.at[1]).cwiseMin(t.at[2]), t.high = t.at[0].cwiseMax(t.at[1]).cwiseMax(t.at[2]);
  }
}

/// Clips `subject` to the left of the line from a to b (Sutherland and Hodgman 1974).
void keep_left(const Vec2& a, const Vec2& b, Polygon& subject, Polygon& spare) {
  const Vec2 along = b - a;
  const auto side = [&](const Vec2& p) { return cross(along, p - a); };
  if (std::ranges::all_of(subject, [&](const Vec2& p) { return side(p) >= 0; })) return;
  spare.clear();
  double at_p = side(subject.back());
  for (std::size_t i = 0; i < subject.size(); ++i) {
    const Vec2 &p = i > 0 ? subject[i - 1] : subject.back(), &q = subject[i];
    const double at_q = side(q);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) spare.push_back(p + at_p / (at_p - at_q) * (q - p));
    if (at_q >= 0) spare.push_back(q);
    at_p = at_q;
  }
  std::swap(subject, spare);
}

/// Adds a multiple of the products of two functions of a simplex.
void add_product(double value, Index a, Index b, Eigen::MatrixXd& products) {
  const double share = 1 / double(products.rows());
  if (a >= 0 && b >= 0)
    products(a, b) += value;
  else if (a >= 0)
    products.row(a).array() += value * share;
  else if (b >= 0)
    products.col(b).array() += value * share;
  else
    products.array() += value * share * share;
}

/// Adds the integrals of products over the part of a triangle within a polygon.
void add_common(const Flat::Simplex& t, const Polygon& polygon, Polygon& common, Polygon& spare,
                Eigen::MatrixXd& products) {
  common = polygon;
  for (std::size_t i = 0; i < 3 && common.size() > 2; ++i)
    keep_left(t.at[i], t.at[(i + 1) % 3], common, spare);
  const double whole = cross(t.at[1] - t.at[0], t.at[2] - t.at[0]);
  if (common.size() < 3 || !(std::abs(whole) > 0)) return;
  // Barycentric coordinates of the polygon's corners, but for the first corner's, and integrals of their products.
  const auto barycentric = [&](const Vec2& p) -> Vec2 {
    return Vec2(cross(p - t.at[0], t.at[2] - t.at[0]), cross(t.at[1] - t.at[0], p - t.at[0])) / whole;
  };
  const Vec2 first = barycentric(common[0]);
  Vec2 old = barycentric(common[1]), sum = Vec2::Zero();
  double size = 0, uu = 0, uv = 0, vv = 0;
  for (std::size_t i = 1; i + 1 < common.size(); ++i) {
    const Vec2 next = barycentric(common[i + 1]), total = first + old + next;
    const double area = 0.5 * cross(common[i] - common[0], common[i + 1] - common[0]), part = area / 12;
    size += area, sum += area / 3 * total;
    uu += part * (first[0] * first[0] + old[0] * old[0] + next[0] * next[0] + total[0] * total[0]);
    uv += part * (first[0] * first[1] + old[0] * old[1] + next[0] * next[1] + total[0] * total[1]);
    vv += part * (first[1] * first[1] + old[1] * old[1] + next[1] * next[1] + total[1] * total[1]);
    old = next;
  }
  const double u = sum[0] - uu - uv, v = sum[1] - uv - vv;  // with the first coordinate, 1 - u - v
  const std::array<std::array<double, 3>, 3> within{
      {{size - sum[0] - sum[1] - u - v, u, v}, {u, uu, uv}, {v, uv, vv}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) add_product(within[i][j], t.corner[i], t.corner[j], products);
}

/// Sets the integrals of products over the part of `f` covered by a face.
void common_part(const Flat& f, const coupling::Interface& other, Index face, std::array<Polygon, 3>& spare,
                 Eigen::MatrixXd& products) {
  products.setZero(f.n, f.n);
  Polygon& polygon = spare[0];
  polygon.clear();
  for (const Index v : corners(other, face)) polygon.push_back(f.flat(other.vertices[v]));
  if (f.n == 2) {
    const Flat::Simplex& edge = f.simplices.front();
    const double first = edge.at[0].x(), length = edge.at[1].x() - first;
    const auto [low, high] =
        std::minmax({(polygon[0].x() - first) / length, (polygon[1].x() - first) / length});
    const double a = std::max(low, 0.), b = std::min(high, 1.);
    if (!(b > a)) return;
    const Eigen::Vector2d p(1 - a, a), q(1 - b, b);
    products = (b - a) * f.size / 6 *
               (2 * p * p.transpose() + 2 * q * q.transpose() + p * q.transpose() + q * p.transpose());
    return;
  }
  double area = 0;
  Vec2 low = polygon[0], high = low;
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    low = low.cwiseMin(polygon[i]), high = high.cwiseMax(polygon[i]);
    if (i + 1 < polygon.size()) area += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  if (area < 0) std::ranges::reverse(polygon);
  for (const Flat::Simplex& t : f.simplices)
    if ((t.low.array() < high.array()).all() && (low.array() < t.high.array()).all())
      add_common(t, polygon, spare[1], spare[2], products);
}

/// Distance [m] between opposite faces: of one's center from the other's plane.
double between(const coupling::Interface& a, Index f, const coupling::Interface& b, Index s) {
  const Vec3 way = b.face_centres[s] - a.face_centres[f];
  return std::min(std::abs(way.dot(a.face_areas[f].normalized())),
                  std::abs(way.dot(b.face_areas[s].normalized())));
}

/// Assigns the parts of `f` outside all polygons to the nearest faces.
void fill(const Flat& f, const coupling::Interface& other, const std::vector<Index>& near, double missing,
          std::vector<Cover>& found) {
  struct CoverSample {
    Vec2 at;
    Eigen::VectorXd functions;
  };
  std::vector<CoverSample> samples;
  const auto add = [&](const Flat::Simplex& t, const std::vector<double>& weights) {
    CoverSample s{Vec2::Zero(), Eigen::VectorXd::Zero(f.n)};
    for (std::size_t i = 0; i < weights.size(); ++i) {
      s.at += weights[i] * t.at[i];
      if (t.corner[i] >= 0)
        s.functions[t.corner[i]] += weights[i];
      else
        s.functions.array() += weights[i] / double(f.n);
    }
    samples.push_back(s);
  };
  for (const Flat::Simplex& t : f.simplices) {
    if (f.n == 2)
      for (int i = 0; i < 8; ++i) add(t, {1 - (i + 0.5) / 8, (i + 0.5) / 8});
    else
      for (const auto& w : {std::vector{2., 2., 2.}, {4., 1., 1.}, {1., 4., 1.}, {1., 1., 4.}})
        add(t, {w[0] / 6, w[1] / 6, w[2] / 6});
  }
  std::erase_if(samples, [&](const CoverSample& s) {
    return std::ranges::any_of(found, [&](const Cover& c) {
      Polygon polygon;
      for (const Index v : corners(other, c.other)) polygon.push_back(f.flat(other.vertices[v]) - s.at);
      if (f.n == 2) return (polygon[0].x() < 0) != (polygon[1].x() < 0);
      bool inside = false;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
        if ((p.y() < 0) != (q.y() < 0) && p.x() - p.y() * (q.x() - p.x()) / (q.y() - p.y()) > 0)
          inside = !inside;
      }
      return inside;
    });
  });
  for (const CoverSample& s : samples) {
    const Vec3 place = f.origin + s.at.x() * f.x + (f.n == 2 ? Vec3(Vec3::Zero()) : Vec3(s.at.y() * f.y));
    Index best = near.front();
    double least = std::numeric_limits<double>::max();
    for (const Index c : near)
      if (const double d = distance_to_face(other, c, place); d < least) least = d, best = c;
    auto known = std::ranges::find(found, best, &Cover::other);
    if (known == found.end()) known = found.insert(found.end(), {best, f.zero()});
    known->products += missing / double(samples.size()) * s.functions * s.functions.transpose();
  }
}

}  // namespace

ConjugateMap::ConjugateMap(MPI_Comm comm, const Side& structure, const Side& surface)
    : comm_(comm), structure_(&structure), surface_(&surface) {
  const Surroundings theirs(comm, structure.interface), ours(comm, surface.interface);
  const bool corners = theirs.has_corners() && ours.has_corners();
  to_faces_ = vertices_to_faces(comm, structure.interface);
  to_surface_faces_ = vertices_to_faces(comm, surface.interface);
  across_ = corners ? faces_to_vertices(comm, structure.interface, surface.interface)
                    : without_corners(comm, theirs, ours.vertices(), structure.interface.dim);
}

ConjugateMap::Entries ConjugateMap::between(Place structure, Place surface) const {
  Entries before;
  if (surface == Place::faces) before = product(comm_, surface_->vertices, to_surface_faces_, across_);
  const Entries& map = surface == Place::faces ? before : across_;
  return structure == Place::vertices ? product(comm_, structure_->faces, map, to_faces_) : map;
}

ConjugateMap::Entries ConjugateMap::motion(Place from, Place to) const { return between(from, to); }

ConjugateMap::Entries ConjugateMap::load(Place from, Place to) const { return transposed(between(to, from)); }

std::vector<Cover> covers(const coupling::Interface& surface, Index face, const coupling::Interface& other,
                          const std::vector<Index>& candidates) {
  const Flat f(surface, face);
  struct Layer {
    double distance;
    Cover cover;
    double size, slack;
  };
  std::vector<Index> facing;
  facing.reserve(candidates.size());
  for (const Index c : candidates)
    if (f.normal.dot(other.face_areas[c]) < -0.5 * other.face_areas[c].norm()) facing.push_back(c);
  std::vector<Layer> layers;
  layers.reserve(facing.size());
  const double own = reach(surface, face);
  static thread_local std::array<Polygon, 3> spare;
  static thread_local Eigen::MatrixXd products;
  for (const Index c : facing) {
    const Vec2 centre = f.flat(other.face_centres[c]);
    if ((surface.dim == 3 ? centre.norm() : std::abs(centre[0])) > own + reach(other, c)) continue;
    common_part(f, other, c, spare, products);
    const double size = products.sum();
    if (size > 1e-12 * f.size)
      layers.push_back(
          {between(surface, face, other, c), {c, products}, size, 0.25 * (own + reach(other, c))});
  }
  std::ranges::stable_sort(layers, {}, &Layer::distance);
  std::vector<Cover> found;
  double covered = 0;
  for (Layer& l : layers) {
    if (l.distance > layers.front().distance + l.slack && covered > 0.98 * f.size) continue;
    covered += l.size;
    found.push_back(std::move(l.cover));
  }
  if (covered < 0.95 * f.size) fill(f, other, facing.empty() ? candidates : facing, f.size - covered, found);
  return found;
}

}  // namespace couplet::coupler
