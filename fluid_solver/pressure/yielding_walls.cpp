// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/point_tree.hpp"
#include "common/log/log.hpp"
#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/term.hpp"

namespace couplet::fluid {

/// Pairs of wall faces on the two wet sides of a thin body. Found once, on the mesh at rest; the body carries
/// them.
class OppositeFaces {
 public:
  /// Part of a face and of the face opposite.
  struct Pair {
    Index face;   ///< boundary face, owned
    Index other;  ///< entry of the map: an owned boundary face, or a copy of another rank's
    double area;  ///< common area [m^2]
  };

  OppositeFaces() = default;
  /// `candidates`: owned boundary faces of such walls. A body is thin if its thickness is at most a quarter
  /// of their extent. Each pair appears once from either side. Collective.
  OppositeFaces(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::span<const Index> candidates);

  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Owned boundary faces, then copies of opposite faces from other ranks.
  const parallel::IndexMap& map() const { return map_; }
  /// Share of the candidates' area with an opposite face, over all ranks, and the mean thickness there [m].
  double share() const { return share_; }
  double thickness() const { return thickness_; }

 private:
  void balance(const std::vector<double>& covered);
  std::vector<Pair> pairs_;
  parallel::IndexMap map_;
  double share_ = 0, thickness_ = 0;
};

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

namespace {

// Share of the interface's area that must be opposite itself for a log entry.
constexpr double worth_telling = 0.05;

/// Checks that there are two sides where the case states that they move together. Collective.
void check_sides(const mesh::Mesh& mesh, const FluidParameters& parameters, const OppositeFaces& opposite) {
  for (const mesh::Patch& patch : mesh.patches) {
    if (parameters.boundaries.at(patch.name).sides != Sides::together) continue;
    const bool any = std::ranges::any_of(opposite.pairs(), [&](const OppositeFaces::Pair& pair) {
      const Index at = mesh.n_interior + pair.face - patch.first;
      return at >= 0 && at < patch.count;
    });
    if (!parallel::any(mesh.comm, any))
      throw Error(
          "boundaries.{}.sides: together, but none of its faces lies opposite another face of the interface, on the "
          "other side of a body no thicker than a quarter of the interface's extent; use 'auto' or 'apart'.",
          patch.name);
  }
}

/// Interface as a Robin condition: w follows from the structure's expected response, relative to the velocity
/// w^k that it gave for p_b^k. A single side with mass m per area and Z = m/dt has
///   Z (w - w^k) = p_b - p_b^k,   p_b = p_P + s - D (w - w^n),  D = rho S/(g dt),  normal to the wall
/// so its flux is that of w^k plus S (p_P + q)/(Z + D), q = s - D (w^k - w^n) - p_b^k [badia2008]. At
/// convergence p_b = p_b^k and w = w^k for any Z. Opposite faces of a thin body with the common area S'
/// respond to their pressure difference with both masses:
///   +- S' [(p_P + q) - (p_P + q)']/(Z + Z' + D + D')
/// This couples the cells of both sides in the matrix, which remains symmetric and positive.
template <int D>
class YieldingWalls final : public Term<D> {
 public:
  /// Collective.
  YieldingWalls(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction)
      : Term<D>(scene, step, prediction) {
    const mesh::Geometry geometry = mesh::compute_geometry(mesh_, scene_.points_at_rest);
    opposite_ = OppositeFaces(mesh_, geometry, scene_.boundary.faces_with_two_sides());
    check_sides(mesh_, scene_.parameters, opposite_);
    const std::size_t faces = std::size_t(mesh_.boundary.n_owned());
    alone_.assign(faces, 1.);
    std::vector<GlobalIndex> cell(std::size_t(opposite_.map().n_local()));
    for (std::size_t b = 0; b < faces; ++b)
      cell[b] = mesh_.cells.global(mesh_.owner[mesh_.n_interior + static_cast<Index>(b)]);
    opposite_.map().update_ghosts(std::span<GlobalIndex>(cell));
    for (const auto& pair : opposite_.pairs()) {
      const Index f = mesh_.n_interior + pair.face;
      alone_[pair.face] -= pair.area / geometry.face_area[f].norm();
      couplings_.row.push_back(mesh_.owner[f]);
      couplings_.column.push_back(cell[pair.other]);
    }
    for (double& share : alone_) share = std::max(share, 0.);
    couplings_.value.assign(couplings_.row.size(), 0.);
    if (opposite_.share() > worth_telling)
      log::info(
          "Robin interface: {:.0f} % of it lies opposite itself, on the other side of a body {:.3g} m thick: there "
          "both sides move together (boundary key 'sides').",
          100 * opposite_.share(), opposite_.thickness());
  }

  bool sets_level() const override { return step_.yields; }
  double version() const override { return step_.yields; }
  const Couplings* couplings() const override { return &couplings_; }
  void add_to_diagonal(Diagonal& diagonal) override {
    std::vector<double>& admittance = diagonal.faces;
    admittance.resize(alone_.size(), 0.);
    std::fill(couplings_.value.begin(), couplings_.value.end(), 0.);
    if (!step_.yields) return;
    const Placement<D>& at = *step_.to;
    set_resistances();
    share();
    const double factor = scene_.fluid.rho / step_.dt;
    for (std::size_t b = 0; b < alone_.size(); ++b) {
      const double area = at.area[mesh_.n_interior + static_cast<Index>(b)].norm();
      if (sides_[b].resistance > 0) admittance[b] += factor * area * alone_[b] / sides_[b].resistance;
    }
    for (std::size_t i = 0; i < couplings_.value.size(); ++i) {
      const auto& pair = opposite_.pairs()[i];
      const double both = factor * answer_of(pair);
      admittance[pair.face] += both;
      couplings_.value[i] = -both;
    }
  }
  void foresee(const State<D>& from, Projected<D>& out) override {
    if (!step_.yields) return;
    const Placement<D>& at = *step_.to;
    const double dt = step_.dt;
    set_resistances();
    for (std::size_t b = 0; b < alone_.size(); ++b) {
      if (sides_[b].resistance == 0) continue;
      const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
      const double g = at.conductance[f];
      double source = -scene_.fluid.rho * (out.w[b] - from.w[b]).dot(at.area[f]) / (g * dt) -
                      scene_.boundary.wall_load()[b];
      if (!prediction_.force.empty()) source += scene_.fluid.rho * prediction_.force[p].dot(at.area[f]) / g;
      if (!out.gradient.empty()) source -= out.gradient[p].dot(at.oblique_of(f)) / g;
      sides_[b].pressure = source;
    }
    add_answers(out);
  }
  void after(Projected<D>& out) override {
    if (!step_.yields) return;
    for (std::size_t b = 0; b < alone_.size(); ++b)
      sides_[b].pressure = out.p[mesh_.owner[mesh_.n_interior + static_cast<Index>(b)]];
    add_answers(out);
  }

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  using Term<D>::prediction_;
  struct Side {
    double resistance = 0, pressure = 0;  // Z + D [kg/(m^2 s)], [Pa]
  };
  void set_resistances() {
    const Placement<D>& at = *step_.to;
    sides_.assign(std::size_t(opposite_.map().n_local()), {});
    for (std::size_t b = 0; b < scene_.boundary.wall_mass().size(); ++b) {
      const Index f = mesh_.n_interior + static_cast<Index>(b);
      const double m = scene_.boundary.wall_mass()[b];
      if (m > 0)
        sides_[b].resistance = (m + scene_.fluid.rho * at.area[f].norm() / at.conductance[f]) / step_.dt;
    }
  }
  /// Updates the copies of opposite faces on other ranks.
  void share() { opposite_.map().update_ghosts(std::as_writable_bytes(std::span(sides_)), sizeof(Side)); }
  /// S'/(Z + Z' + D + D') [m^4 s/kg].
  double answer_of(const OppositeFaces::Pair& pair) const {
    const Side &here = sides_[std::size_t(pair.face)], &there = sides_[std::size_t(pair.other)];
    return here.resistance > 0 && there.resistance > 0 ? pair.area / (here.resistance + there.resistance) : 0;
  }
  /// Adds the response of walls to the pressures on their sides to velocities and fluxes.
  void add_answers(Projected<D>& out) {
    const Placement<D>& at = *step_.to;
    share();
    flux_.assign(alone_.size(), 0.);
    for (std::size_t b = 0; b < alone_.size(); ++b)
      if (sides_[b].resistance > 0)
        flux_[b] = at.area[mesh_.n_interior + static_cast<Index>(b)].norm() * alone_[b] * sides_[b].pressure /
                   sides_[b].resistance;
    for (const auto& pair : opposite_.pairs())
      flux_[std::size_t(pair.face)] += answer_of(pair) * (sides_[std::size_t(pair.face)].pressure -
                                                          sides_[std::size_t(pair.other)].pressure);
    for (std::size_t b = 0; b < alone_.size(); ++b) {
      if (sides_[b].resistance == 0) continue;
      const Index f = mesh_.n_interior + static_cast<Index>(b);
      out.w[b] += flux_[b] / at.area[f].squaredNorm() * at.area[f];
      out.phi[f] = out.w[b].dot(at.area[f]);
    }
  }

  OppositeFaces opposite_;
  std::vector<double> alone_;  // area that has nothing opposite, over that of the face, per boundary face
  std::vector<Side> sides_;    // per entry of the map
  std::vector<double> flux_;   // of answers, per boundary face [m^3/s]
  Couplings couplings_;
};

}  // namespace

template <int D>
std::unique_ptr<Term<D>> make_yielding_walls(const Scene<D>& scene, const Step<D>& step,
                                             const Prediction<D>& prediction) {
  return std::make_unique<YieldingWalls<D>>(scene, step, prediction);
}

template decltype(make_yielding_walls<2>) make_yielding_walls<2>;
template decltype(make_yielding_walls<3>) make_yielding_walls<3>;

}  // namespace couplet::fluid
