// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/opposite_faces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "common/base/point_tree.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

constexpr double thin = 0.25;    // thickness over the extent of the walls
constexpr double facing = 0.7;   // least -n.n' of the normals
constexpr double beside = 1.1;   // of a face's radius: largest distance from its center to meet it
constexpr std::size_t look = 8;  // faces at a place of the way across
constexpr int along = 8;         // parts of an edge
constexpr int rounds = 50;       // of the scaling

struct Face {
  Vec3 centre, normal;  // out of the fluid
  double radius;        // of its corners about the center [m]
  Index entry;
  int rank;
};

/// Sample points that represent equal parts of a face.
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

/// Faces of all ranks, to look for those across a body.
class Walls {
 public:
  explicit Walls(const std::vector<Face>& all) : all_(all), centres_(centres_of(all)), tree_(centres_) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
    for (const Face& face : all) {
      low = low.cwiseMin(face.centre), high = high.cwiseMax(face.centre);
      widest_ = std::max(widest_, face.radius);
    }
    if (!all.empty()) reach_ = thin * (high - low).norm();
  }

  /// Face met by the normal of `from` across the body from a place; nullptr if there is none. Stops where no
  /// face can be met, so that walls with one wet side cost little.
  const Face* across(const Face& from, const Vec3& place) const {
    for (double way = 0; way <= reach_;) {
      const Vec3 at = place + way * from.normal;
      const std::vector<Index> near = tree_.nearest(at, look);
      for (const Index i : near)
        if (is_met(all_[std::size_t(i)], from, place)) return &all_[std::size_t(i)];
      const double clear = (centres_[std::size_t(near.front())] - at).norm() - widest_;
      way += std::max(clear, from.radius / 2);
    }
    return nullptr;
  }

 private:
  static std::vector<Vec3> centres_of(const std::vector<Face>& all) {
    std::vector<Vec3> centres;
    for (const Face& face : all) centres.push_back(face.centre);
    return centres;
  }
  bool is_met(const Face& face, const Face& from, const Vec3& place) const {
    const Vec3 way = face.centre - place;
    const double depth = way.dot(from.normal);
    return face.normal.dot(from.normal) < -facing && depth >= -1e-9 * reach_ && depth <= reach_ &&
           (way - depth * from.normal).norm() <= beside * face.radius;
  }

  const std::vector<Face>& all_;
  std::vector<Vec3> centres_;
  base::PointTree tree_;
  double widest_ = 0, reach_ = 0;  // largest radius; largest thickness [m]
};

/// Common area of a face with one of another rank.
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
    double radius = 0;
    for (const Index v : mesh.face_points[f])
      radius = std::max(radius, (geometry.points[v] - geometry.face_centre[f]).norm());
    mine.push_back({geometry.face_centre[f], geometry.face_area[f].normalized(), radius, b, rank});
  }
  // All faces are stored on each rank only during the search.
  const std::vector<Face> all = parallel::all_gather(mesh.comm, mine);
  const Walls walls(all);

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
      const Face* const found = walls.across(face, place);
      if (!found) continue;
      const Face& other = *found;
      sums[1] += part;
      covered[std::size_t(face.entry)] += part;
      sums[2] += part * (other.centre - place).dot(face.normal);
      // Half of both values, because the common area is one number.
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

/// Corrects the sampled common areas by symmetric scaling until the parts of each face sum to its covered
/// area. A body that moves as a whole then displaces the same volume on both sides.
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
