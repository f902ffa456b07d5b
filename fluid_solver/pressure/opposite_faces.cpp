// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/opposite_faces.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

constexpr double thin = 0.25;  // thickness over the extent of the walls
constexpr double facing =
    0.7;  // least -n.n' of the normals, least share of the way across that is along the normal
constexpr std::size_t first_look = 16;
constexpr int along = 8;    // parts of an edge
constexpr int rounds = 50;  // of the scaling

struct Face {
  Vec3 centre, normal;  // out of the fluid
  Index entry;
  int rank;
};

/// Places that stand for equal parts of a face.
std::vector<Vec3> samples_of(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  const std::span<const Index> corners = mesh.face_points[f];
  const Vec3& centre = geometry.face_centre[f];
  std::vector<Vec3> places;
  if (corners.size() == 2) {
    const Vec3 &a = geometry.points[corners[0]], &b = geometry.points[corners[1]];
    for (int i = 0; i < along; ++i) places.push_back(a + (i + 0.5) / along * (b - a));
    return places;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &a = geometry.points[corners[i]], &b = geometry.points[corners[(i + 1) % corners.size()]];
    places.push_back((centre + a + b) / 3);
    for (const Vec3& corner : {centre, a, b}) places.push_back((centre + a + b + 3 * corner) / 6);
  }
  return places;
}

double extent_of(const std::vector<Face>& all) {
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (const Face& face : all) low = low.cwiseMin(face.centre), high = high.cwiseMax(face.centre);
  return all.empty() ? 0 : (high - low).norm();
}

/// The nearest face across the body from `place` of one with the normal n; -1: none within `reach`.
Index across(const std::vector<Face>& all, const base::PointTree& tree, const Vec3& place, const Vec3& n,
             double reach) {
  for (std::size_t k = first_look;; k *= 4) {
    const std::vector<Index> near = tree.nearest(place, k);
    for (const Index i : near) {
      const Face& face = all[std::size_t(i)];
      const Vec3 way = face.centre - place;
      if (way.norm() > reach) return -1;
      if (face.normal.dot(n) < -facing && way.dot(n) >= -1e-9 * reach) return i;
    }
    if (near.size() < k) return -1;
  }
}

/// What a face says of another rank's: they have this area in common.
struct Told {
  Index to, from;
  double area;
};

}  // namespace

OppositeFaces::OppositeFaces(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                             std::span<const Index> candidates) {
  const int rank = parallel::comm_rank(mesh.comm), ranks = parallel::comm_size(mesh.comm);
  std::vector<Face> mine;
  for (const Index b : candidates) {
    const Index f = mesh.n_interior + b;
    mine.push_back({geometry.face_centre[f], geometry.face_area[f].normalized(), b, rank});
  }
  // All of them are here while the opposite ones are looked for, and no longer.
  const std::vector<Face> all = parallel::all_gather(mesh.comm, mine);
  std::vector<Vec3> centres;
  for (const Face& face : all) centres.push_back(face.centre);
  const base::PointTree tree(centres);
  const double reach = thin * extent_of(all);

  std::map<std::tuple<Index, int, Index>, double> common;  // face here, rank and face there: area
  std::vector<std::vector<Told>> tell(static_cast<std::size_t>(ranks));
  std::vector<double> covered(std::size_t(mesh.boundary.n_owned()), 0.);  // of each face [m^2]
  double sums[3] = {0, 0, 0};  // area, area with a face opposite, the same times thickness
  for (const Face& face : mine) {
    const Index f = mesh.n_interior + face.entry;
    const std::vector<Vec3> places = samples_of(mesh, geometry, f);
    const double part = geometry.face_area[f].norm() / double(places.size());
    for (const Vec3& place : places) {
      sums[0] += part;
      const Index found = across(all, tree, place, face.normal, reach);
      if (found < 0) continue;
      const Face& other = all[std::size_t(found)];
      sums[1] += part;
      covered[std::size_t(face.entry)] += part;
      sums[2] += part * (other.centre - place).dot(face.normal);
      // Half of what each of the two says: their common area is one number.
      common[{face.entry, other.rank, other.entry}] += part / 2;
      tell[std::size_t(other.rank)].push_back({other.entry, face.entry, part / 2});
    }
  }
  const auto told = parallel::all_to_all(mesh.comm, tell);
  for (std::size_t r = 0; r < told.size(); ++r)
    for (const Told& t : told[r]) common[{t.to, int(r), t.from}] += t.area;
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  share_ = sums[0] > 0 ? sums[1] / sums[0] : 0;
  thickness_ = sums[1] > 0 ? sums[2] / sums[1] : 0;

  const Index owned = mesh.boundary.n_owned();
  std::map<std::pair<int, Index>, Index> copies;
  std::vector<int> owners;
  std::vector<Index> remote;
  for (const auto& [who, area] : common) {
    const auto [face, there, entry] = who;
    Index other = entry;
    if (there != rank) {
      const auto [at, is_new] = copies.try_emplace({there, entry}, owned + static_cast<Index>(owners.size()));
      if (is_new) owners.push_back(there), remote.push_back(entry);
      other = at->second;
    }
    pairs_.push_back({face, other, area});
  }
  map_ = parallel::IndexMap(mesh.comm, owned, owners, remote);
  balance(covered);
}

/// Samples do not say quite what each face has in common with others: symmetric scaling until the parts of each add up to
/// what is covered of it, so that a body that moves as a whole pushes the same volume on both sides.
void OppositeFaces::balance(const std::vector<double>& covered) {
  std::vector<double> factor(std::size_t(map_.n_local()));
  for (int i = 0; i < rounds; ++i) {
    std::fill(factor.begin(), factor.end(), 0.);
    for (const Pair& pair : pairs_) factor[std::size_t(pair.face)] += pair.area;
    for (std::size_t b = 0; b < covered.size(); ++b)
      if (factor[b] > 0) factor[b] = std::sqrt(covered[b] / factor[b]);
    map_.update_ghosts(factor);
    for (Pair& pair : pairs_) pair.area *= factor[std::size_t(pair.face)] * factor[std::size_t(pair.other)];
  }
}

}  // namespace couplet::fluid
