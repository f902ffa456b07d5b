// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/compare_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/base/error.hpp"
#include "common/log/finding.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

void add_up(MPI_Comm comm, double* values, int n) {
  MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, comm);
}

void find_box(MPI_Comm comm, const std::vector<const Side*>& sides, SurfaceFacts& facts) {
  constexpr double far = std::numeric_limits<double>::infinity();
  facts.low.setConstant(far), facts.high.setConstant(-far);
  for (const Side* side : sides)
    for (const Vec3& p : side->interface.vertices)
      facts.low = facts.low.cwiseMin(p), facts.high = facts.high.cwiseMax(p);
  MPI_Allreduce(MPI_IN_PLACE, facts.low.data(), 3, MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, facts.high.data(), 3, MPI_DOUBLE, MPI_MAX, comm);
}

std::string text(const Vec3& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", p.x(), p.y(), p.z()); }

/// Whoever takes a motion and gives no load (a heater on one side of a flap) covers as much of the surface as it likes.
bool gives_load(const Side& side) {
  return std::ranges::any_of(side.interface.gives, [](const coupling::Interface::Datum& d) {
    return d.unit == "N" || d.unit == "Pa";
  });
}

/// Participants that exchange load and motion, directly or through others, as positions in `sides`: those that give the
/// motion and those that take it. The mesh mover is none of them.
struct Group {
  std::set<std::size_t> givers, takers;
};
std::vector<Group> groups_of(const std::vector<Side>& sides, const Links& links, const Schedule& schedule) {
  std::vector<Group> groups;
  for (const auto& link : links.all()) {
    if (link.datum.name != "displacement" || sides[link.taker].name == schedule.mover) continue;
    if (!gives_load(sides[link.taker])) continue;
    Group joined{{link.giver}, {link.taker}};
    std::erase_if(groups, [&](const Group& g) {
      const bool shares = g.givers.contains(link.giver) || g.takers.contains(link.taker);
      if (shares) joined.givers.insert(g.givers.begin(), g.givers.end());
      if (shares) joined.takers.insert(g.takers.begin(), g.takers.end());
      return shares;
    });
    groups.push_back(std::move(joined));
  }
  return groups;
}

std::vector<const Side*> chosen(const std::vector<Side>& sides, const std::set<std::size_t>& which) {
  std::vector<const Side*> list;
  for (const std::size_t i : which) list.push_back(&sides[i]);
  return list;
}

/// Lumped participants, points with areas, have no size that could be compared.
bool has_size(const std::vector<const Side*>& sides) {
  return std::ranges::all_of(sides,
                             [](const Side* s) { return s->faces.back() >= 2 && s->vertices.back() >= 2; });
}

void check_mover(MPI_Comm comm, const std::vector<Side>& sides, const Schedule& schedule) {
  if (!schedule.mover) return;
  const auto mover = std::ranges::find(sides, *schedule.mover, &Side::name),
             fluid = std::ranges::find(sides, *schedule.moved, &Side::name);
  if (mover == sides.end() || fluid == sides.end()) return;
  const SurfaceFacts moves = surface_facts(comm, {&*mover}), moved = surface_facts(comm, {&*fluid});
  const double apart = moves.area - moved.area, limit = 1e-6 * moved.area;
  if (apart < -limit)
    throw Error(
        "'{}' moves {} of the {} faces of the interface of '{}' ({:.4g} of {:.4g} m^2): the rest of the "
        "mesh wall would not follow the structure. Set `type: interface` in the mesh mover for every patch "
        "that has it in the fluid.",
        mover->name, moves.faces, moved.faces, fluid->name, moves.area, moved.area);
  if (apart > limit)
    log::finding(parallel::comm_rank(comm),
                 {.id = "surfaces-apart",
                  .number = apart,
                  .limit = limit,
                  .sentence = fmt::format(
                      "mesh motion: '{}' moves {} faces by the structure, but the interface of '{}' has {}: "
                      "patches that are not an interface of the fluid follow the nearest vertex",
                      mover->name, moves.faces, fluid->name, moved.faces),
                  .advice = "set another type for them"});
}

}  // namespace

SurfaceFacts surface_facts(MPI_Comm comm, const std::vector<const Side*>& sides) {
  SurfaceFacts facts;
  double sums[5] = {};  // area, its first moments, extents of faces
  for (const Side* side : sides) {
    facts.names += (facts.names.empty() ? "'" : ", '") + side->name + "'";
    facts.faces += side->faces.back();
    const coupling::Interface& i = side->interface;
    for (std::size_t f = 0; f < i.face_centres.size(); ++f) {
      const double area = i.face_areas[f].norm();
      sums[0] += area;
      for (int c = 0; c < 3; ++c) sums[1 + c] += area * i.face_centres[f][c];
      sums[4] += i.dim == 2 ? area : std::sqrt(area);
    }
  }
  add_up(comm, sums, 5);
  find_box(comm, sides, facts);
  facts.area = sums[0];
  facts.face = sums[4] / std::max(1., double(facts.faces));
  if (facts.area == 0) return facts;
  facts.centroid = Vec3(sums[1], sums[2], sums[3]) / facts.area;
  Vec3 spread = Vec3::Zero();
  for (const Side* side : sides)
    for (std::size_t f = 0; f < side->interface.face_centres.size(); ++f)
      spread += side->interface.face_areas[f].norm() *
                (side->interface.face_centres[f] - facts.centroid).cwiseAbs();
  add_up(comm, spread.data(), 3);
  facts.spread = spread / facts.area;
  return facts;
}

double faceting(const SurfaceFacts& a, const SurfaceFacts& b) {
  const double extent = std::min(a.extent(), b.extent());
  const double share = extent > 0 ? std::max(a.face, b.face) / extent : 1;
  return 0.01 + share * share;
}

/// Largest difference of the mean distances from the centroid [m]. The centres of one row of faces all lie on a line, those of two rows
/// do not: a direction in which a surface is but few faces wide is left to the box.
double spread_apart(const SurfaceFacts& a, const SurfaceFacts& b) {
  const Vec3 width = (a.high - a.low).cwiseMin(b.high - b.low);
  double apart = 0;
  for (int c = 0; c < 3; ++c)
    if (width[c] > 3 * std::max(a.face, b.face)) apart = std::max(apart, std::abs(a.spread[c] - b.spread[c]));
  return apart;
}

std::string difference_of(const SurfaceFacts& a, const SurfaceFacts& b, double limit) {
  const double size = std::min(a.extent(), b.extent()), area = std::max(a.area, b.area);
  if (!(size > 0) || !(area > 0)) return "";
  const auto of = [&](const char* what, double apart, const std::string& one, const std::string& other) {
    return apart <= limit ? std::string()
                          : fmt::format("{} {} ({}) and {} ({}), {:.2g} % apart (limit {:.2g} %)", what, one,
                                        a.names, other, b.names, 100 * apart, 100 * limit);
  };
  const double box = std::max((a.low - b.low).cwiseAbs().maxCoeff(), (a.high - b.high).cwiseAbs().maxCoeff());
  for (const std::string& found :
       {of("area", std::abs(a.area - b.area) / area, fmt::format("{:.4g} m^2", a.area),
           fmt::format("{:.4g} m^2", b.area)),
        of("centroid", (a.centroid - b.centroid).norm() / size, text(a.centroid), text(b.centroid)),
        of("mean distance from the centroid", spread_apart(a, b) / size, text(a.spread), text(b.spread)),
        of("bounding box", box / size, text(a.low) + " to " + text(a.high),
           text(b.low) + " to " + text(b.high))})
    if (!found.empty()) return found;
  return "";
}

void compare_surfaces(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                      const Schedule& schedule) {
  check_mover(comm, sides, schedule);
  for (const Group& group : groups_of(sides, links, schedule)) {
    const auto givers = chosen(sides, group.givers), takers = chosen(sides, group.takers);
    if (!has_size(givers) || !has_size(takers)) continue;
    const SurfaceFacts a = surface_facts(comm, givers), b = surface_facts(comm, takers);
    if (const std::string difference = difference_of(a, b, faceting(a, b)); !difference.empty())
      log::finding(
          parallel::comm_rank(comm),
          {.id = "surfaces-apart",
           .sentence = fmt::format("surfaces that move together differ: {}: loads and motion are transferred "
                                   "between different sizes",
                                   difference),
           .advice = "check the meshes' units and dimensions, and which patches have `type: interface`"});
  }
}

}  // namespace couplet::coupler
