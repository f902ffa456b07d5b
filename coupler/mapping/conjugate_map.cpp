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
    Polygon at;
    std::vector<Eigen::VectorXd> functions;
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
  const auto unit = [&](Index i) { return Eigen::VectorXd(Eigen::VectorXd::Unit(n, i)); };
  x = s.vertices[vertex[1]] - s.vertices[vertex[0]];
  if (s.dim == 3) x -= normal * normal.dot(x);
  x.normalize();
  y = s.dim == 3 ? Vec3(normal.cross(x)) : normal;
  Polygon at;
  for (const Index v : vertex) at.push_back(flat(s.vertices[v]));
  if (n == 2) {
    simplices.push_back({at, {unit(0), unit(1)}});
    size = std::abs(at[1].x() - at[0].x());
    return;
  }
  if (n == 3) {
    simplices.push_back({at, {unit(0), unit(1), unit(2)}});
  } else {
    Vec2 centre = Vec2::Zero();
    for (const Vec2& p : at) centre += p / double(n);
    for (Index i = 0; i < n; ++i)
      simplices.push_back({{at[std::size_t(i)], at[std::size_t((i + 1) % n)], centre},
                           {unit(i), unit((i + 1) % n), Eigen::VectorXd::Constant(n, 1 / double(n))}});
  }
  for (Simplex& t : simplices) {
    const double area = 0.5 * cross(t.at[1] - t.at[0], t.at[2] - t.at[0]);
    if (area < 0) std::swap(t.at[0], t.at[1]), std::swap(t.functions[0], t.functions[1]);
    size += std::abs(area);
  }
}

/// Clips `subject` to the left of the line from a to b (Sutherland and Hodgman 1974).
void keep_left(const Vec2& a, const Vec2& b, Polygon& subject, Polygon& spare) {
  spare.clear();
  for (std::size_t i = 0; i < subject.size(); ++i) {
    const Vec2 &p = subject[i], &q = subject[i + 1 < subject.size() ? i + 1 : 0];
    const double at_p = cross(b - a, p - a), at_q = cross(b - a, q - a);
    if (at_p >= 0) spare.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) spare.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  std::swap(subject, spare);
}

/// Adds the integrals of products over the part of a triangle within a polygon.
void add_common(const Flat::Simplex& t, const Polygon& polygon, Polygon& common, Polygon& spare,
                Eigen::MatrixXd& products) {
  common = polygon;
  for (std::size_t i = 0; i < 3 && common.size() > 2; ++i)
    keep_left(t.at[i], t.at[(i + 1) % 3], common, spare);
  const double whole = cross(t.at[1] - t.at[0], t.at[2] - t.at[0]);
  if (common.size() < 3 || !(std::abs(whole) > 0)) return;
  const auto barycentric = [&](const Vec2& p) {
    const double second = cross(p - t.at[0], t.at[2] - t.at[0]) / whole,
                 third = cross(t.at[1] - t.at[0], p - t.at[0]) / whole;
    return Vec3(1 - second - third, second, third);
  };
  const Vec3 first = barycentric(common[0]);
  Vec3 old = barycentric(common[1]);
  Eigen::Matrix3d within = Eigen::Matrix3d::Zero();
  for (std::size_t i = 1; i + 1 < common.size(); ++i) {
    const Vec3 next = barycentric(common[i + 1]), total = first + old + next;
    const double area = 0.5 * cross(common[i] - common[0], common[i + 1] - common[0]);
    within += area / 12 *
              (first * first.transpose() + old * old.transpose() + next * next.transpose() +
               total * total.transpose());
    old = next;
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      products.noalias() +=
          within(i, j) * t.functions[std::size_t(i)] * t.functions[std::size_t(j)].transpose();
}

/// Integrals of products over the part of `f` covered by a face.
Eigen::MatrixXd common_part(const Flat& f, const coupling::Interface& other, Index face,
                            std::array<Polygon, 3>& spare) {
  Eigen::MatrixXd products = f.zero();
  Polygon& polygon = spare[0];
  polygon.clear();
  for (const Index v : corners(other, face)) polygon.push_back(f.flat(other.vertices[v]));
  if (f.n == 2) {
    const Flat::Simplex& edge = f.simplices.front();
    const double first = edge.at[0].x(), length = edge.at[1].x() - first;
    const auto [low, high] =
        std::minmax({(polygon[0].x() - first) / length, (polygon[1].x() - first) / length});
    const double a = std::max(low, 0.), b = std::min(high, 1.);
    if (!(b > a)) return products;
    const Eigen::Vector2d p(1 - a, a), q(1 - b, b);
    products = (b - a) * f.size / 6 *
               (2 * p * p.transpose() + 2 * q * q.transpose() + p * q.transpose() + q * p.transpose());
    return products;
  }
  double area = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    area += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  if (area < 0) std::ranges::reverse(polygon);
  for (const Flat::Simplex& t : f.simplices) add_common(t, polygon, spare[1], spare[2], products);
  return products;
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
  struct Sample {
    Vec2 at;
    Eigen::VectorXd functions;
  };
  std::vector<Sample> samples;
  const auto add = [&](const Flat::Simplex& t, const std::vector<double>& weights) {
    Sample s{Vec2::Zero(), Eigen::VectorXd::Zero(f.n)};
    for (std::size_t i = 0; i < weights.size(); ++i)
      s.at += weights[i] * t.at[i], s.functions += weights[i] * t.functions[i];
    samples.push_back(s);
  };
  for (const Flat::Simplex& t : f.simplices) {
    if (f.n == 2)
      for (int i = 0; i < 8; ++i) add(t, {1 - (i + 0.5) / 8, (i + 0.5) / 8});
    else
      for (const auto& w : {std::vector{2., 2., 2.}, {4., 1., 1.}, {1., 4., 1.}, {1., 1., 4.}})
        add(t, {w[0] / 6, w[1] / 6, w[2] / 6});
  }
  std::erase_if(samples, [&](const Sample& s) {
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
  for (const Sample& s : samples) {
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

ConjugateMap::ConjugateMap(MPI_Comm comm, const Side& structure, const Side& surface,
                           MappingParameters::Type type)
    : comm_(comm), structure_(&structure), surface_(&surface) {
  const Surroundings theirs(comm, structure.interface), ours(comm, surface.interface);
  const bool corners = theirs.has_corners() && ours.has_corners();
  if (type == MappingParameters::Type::projection) require_corners(corners);
  to_faces_ = vertices_to_faces(comm, structure.interface);
  to_surface_faces_ = vertices_to_faces(comm, surface.interface);
  across_ = corners ? faces_to_vertices(comm, structure.interface, surface.interface, type)
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
  for (const Index c : candidates)
    if (f.normal.dot(other.face_areas[c]) < -0.5 * other.face_areas[c].norm()) facing.push_back(c);
  std::vector<Layer> layers;
  const double own = reach(surface, face);
  std::array<Polygon, 3> spare;
  for (const Index c : facing) {
    const Vec2 centre = f.flat(other.face_centres[c]);
    if ((surface.dim == 3 ? centre.norm() : std::abs(centre[0])) > own + reach(other, c)) continue;
    Eigen::MatrixXd products = common_part(f, other, c, spare);
    const double size = products.sum();
    if (size > 1e-12 * f.size)
      layers.push_back(
          {between(surface, face, other, c), {c, std::move(products)}, size, 0.25 * (own + reach(other, c))});
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
