// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/surface_checks.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/error.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/exchange/transfer.hpp"
#include "coupler/mapping/sparse_map.hpp"

namespace couplet::coupler {
namespace {

using Place = coupling::Interface::Place;

/// Extent of each face of this rank [m]: between corners where these are known (a face may be long and thin),
/// else the edge of a square of its area; in 2-D areas are lengths. Collective.
std::vector<double> extents(MPI_Comm comm, const Side& side) {
  const coupling::Interface& i = side.interface;
  const FaceCorners corners(comm, side);
  std::vector<double> result;
  for (std::size_t f = 0; f < i.face_centres.size(); ++f) {
    const double area = i.face_areas[f].norm();
    double extent = i.dim == 2 ? area : std::sqrt(area);
    for (Index k = corners.begin(f); k < corners.end(f); ++k)
      extent = std::max(extent, 2 * (corners.points()[std::size_t(k)] - i.face_centres[f]).norm());
    result.push_back(extent);
  }
  return result;
}

double mean(MPI_Comm comm, const std::vector<double>& values) {
  double total = 0;
  for (const double v : values) total += v;
  return parallel::sum(comm, total) / std::max(1., parallel::sum(comm, double(values.size())));
}

/// First nonempty text of any rank, on all ranks.
std::string first_text(MPI_Comm comm, const std::string& text) {
  if (parallel::comm_size(comm) == 1 || !parallel::any(comm, !text.empty())) return text;
  const std::vector<char> all = parallel::all_gather(comm, std::vector<char>(text.begin(), text.end()));
  return {all.begin(), all.end()};
}

std::string text(const PointBox& b) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", b.low.x(), b.low.y(), b.low.z(),
                     b.high.x(), b.high.y(), b.high.z());
}

/// Both boxes must be the same within a tenth of the smaller and two faces of the coarser side.
std::string other_extent(const PointBox& a, const std::string& from, const PointBox& b, const std::string& to,
                         double face) {
  const double least = std::min(a.extent(), b.extent());
  const double allowed = 0.1 * least + 2 * std::min(face, least);
  const double off = std::max((a.low - b.low).cwiseAbs().maxCoeff(), (a.high - b.high).cwiseAbs().maxCoeff());
  if (off <= allowed) return "";
  const double ratio = a.extent() / std::max(b.extent(), 1e-300);
  return fmt::format(
      "The interface of '{}' extends from {} m and that of '{}' from {} m: their positions differ{}. Check "
      "the meshes' units and positions and which patches have `type: interface` or `conjugate: true`.",
      from, text(a), to, text(b),
      ratio > 5 || ratio < 0.2
          ? fmt::format(", one is {:.3g} times as large as the other", std::max(ratio, 1 / ratio))
          : "");
}

/// True if each of these points has another within a tenth of the size of the nearest face.
bool all_near(MPI_Comm comm, const std::vector<Neighbour>& found, const std::vector<Neighbour>& face) {
  bool far = false;
  for (std::size_t i = 0; i < found.size(); ++i) far = far || found[i].distance > 0.1 * face[i].size;
  return !parallel::any(comm, far);
}

/// Why the nearest vertex is no suitable map: motion in steps, and loads with a different work.
std::string not_nested(const std::string& from, const std::string& to) {
  return fmt::format(
      "The faces of '{}' and '{}' do not nest: vertices of either side lie between those of the other. With "
      "`coupling.mapping.type: nearest` the wall would move stepwise and the load would do different work on the two sides. "
      "Set `coupling.mapping.type: projection`: it conserves work, force and moment on any meshes.",
      from, to);
}

void add_up(MPI_Comm comm, double* values, int n) {
  MPI_Allreduce(MPI_IN_PLACE, values, n, MPI_DOUBLE, MPI_SUM, comm);
}

void find_box(MPI_Comm comm, const std::vector<const Side*>& sides, SurfaceFacts& facts) {
  std::vector<Vec3> points;
  for (const Side* side : sides)
    points.insert(points.end(), side->interface.vertices.begin(), side->interface.vertices.end());
  const PointBox box(comm, points);
  facts.low = box.low, facts.high = box.high;
}

std::string text(const Vec3& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", p.x(), p.y(), p.z()); }

/// True for data that a body gives to the fluid around it: its motion, its answer to heat.
bool tells_shape(const coupling::Interface::Datum& datum) {
  return datum.name == "displacement" || datum.name == "film-coefficient";
}

/// A participant that takes a motion but gives no load (a heater on a flap) may cover part of a surface.
bool gives_load(const Side& side) {
  return std::ranges::any_of(side.interface.gives, [](const coupling::Interface::Datum& d) {
    return coupling::is_amount(d) || d.unit == "Pa";
  });
}

/// Participants that exchange load and motion, directly or indirectly, as positions in `sides`: givers and
/// takers of the motion, without the mesh mover.
struct SurfaceGroup {
  std::set<std::size_t> givers, takers;
};
std::vector<SurfaceGroup> groups_of(const std::vector<Side>& sides, const Links& links,
                                    const Schedule& schedule) {
  std::vector<SurfaceGroup> groups;
  for (const auto& link : links.all()) {
    if (!tells_shape(link.datum) || sides[link.taker].name == schedule.mover) continue;
    if (!gives_load(sides[link.taker])) continue;
    SurfaceGroup joined{{link.giver}, {link.taker}};
    std::erase_if(groups, [&](const SurfaceGroup& g) {
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

/// Lumped participants (points with areas) have no size to compare.
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
        "'{}' moves {} of the {} faces of the interface of '{}' ({:.4g} of {:.4g} m^2): the rest of the mesh wall would not "
        "follow the structure. Set `type: interface` in the mesh mover for every patch that has it in the fluid.",
        mover->name, moves.faces, moved.faces, fluid->name, moves.area, moved.area);
  if (apart > limit)
    diagnostics::finding(
        parallel::comm_rank(comm),
        {.id = "surfaces-apart",
         .number = apart,
         .limit = limit,
         .sentence = fmt::format(
             "mesh motion: '{}' moves {} faces with the structure, but the interface of '{}' has {}: patches that are not an "
             "interface of the fluid follow the nearest vertex",
             mover->name, moves.faces, fluid->name, moved.faces),
         .advice = "set another type for them"});
}

}  // namespace

PlaceReport compare_places(MPI_Comm comm, const Side& from, const Side& to, bool by_nearest) {
  PlaceReport report;
  // Lumped participants (points with areas) have no extent to compare.
  if (from.faces.back() < 2 || to.faces.back() < 2 || from.vertices.back() < 2 || to.vertices.back() < 2)
    return report;
  const PointSet source = from.places(Place::vertices), target = to.places(Place::vertices);
  PointSet source_faces = from.places(Place::faces), target_faces = to.places(Place::faces);
  source_faces.sizes = extents(comm, from), target_faces.sizes = extents(comm, to);
  report.problem =
      other_extent(PointBox(comm, source.points), from.name, PointBox(comm, target.points), to.name,
                   std::max(mean(comm, source_faces.sizes), mean(comm, target_faces.sizes)));
  if (!report.problem.empty()) return report;
  const std::vector<Neighbour> found = nearest(comm, target.points, source),
                               face = nearest(comm, target.points, source_faces);
  // The size of its own faces is only needed where a point is far for those of the source.
  std::vector<std::size_t> far;
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < target.points.size(); ++i)
    if (!(found[i].distance <= 2 * face[i].size)) far.push_back(i), places.push_back(target.points[i]);
  if (parallel::any(comm, !far.empty())) {
    const std::vector<Neighbour> own = nearest(comm, places, target_faces);
    for (std::size_t k = 0; k < far.size() && report.problem.empty(); ++k) {
      const double size = std::max(face[far[k]].size, own[k].size), distance = found[far[k]].distance;
      if (distance <= 2 * size) continue;
      const Vec3& p = places[k];
      report.problem = fmt::format(
          "The point ({:.6g}, {:.6g}, {:.6g}) of '{}' is {:.3g} m away from the nearest point of '{}', where "
          "the face size is {:.3g} m: the two interfaces are not the same surface. Check the meshes, their 'mesh-scale' and which "
          "patches are of type interface.",
          p.x(), p.y(), p.z(), to.name, distance, from.name, size);
    }
  }
  report.problem = first_text(comm, report.problem);
  if (!report.problem.empty() || !by_nearest) return report;
  report.nests = all_near(comm, found, face) || all_near(comm, nearest(comm, source.points, target),
                                                         nearest(comm, source.points, source_faces));
  if (const int most = most_followers(comm, found, source.starts); most >= 3)
    report.notes.push_back(fmt::format(
        "note: '{}' is much coarser than '{}': up to {} vertices follow the same one, so the motion is stepwise. "
        "`mapping.type: projection` avoids this.",
        from.name, to.name, most));
  return report;
}

void require_finite(MPI_Comm comm, const coupling::Exchange& data, const coupling::Interface& interface,
                    const std::vector<coupling::Interface::Datum>& of, const std::string& who) {
  std::string problem;
  for (const auto& datum : of) {
    const auto found = data.find(datum.name);
    if (found == data.end() || !problem.empty()) continue;
    const auto& values = found->second;
    // Zero times a value is zero or NaN; four partial sums avoid a branch per value.
    double sums[4] = {};
    for (std::size_t i = 0; i + 4 <= values.size(); i += 4)
      for (std::size_t c = 0; c < 4; ++c) sums[c] += 0 * values[i + c];
    for (std::size_t i = values.size() / 4 * 4; i < values.size(); ++i) sums[0] += 0 * values[i];
    if (sums[0] + sums[1] + sums[2] + sums[3] == 0) continue;
    const auto bad = std::ranges::find_if(values, [](double v) { return !std::isfinite(v); });
    if (bad == values.end()) continue;
    const auto entry = std::size_t(bad - values.begin()) / std::size_t(datum.size(interface.dim));
    const bool at_vertices = datum.place == Place::vertices;
    const std::vector<Vec3>& places = at_vertices ? interface.vertices : interface.face_centres;
    const std::vector<GlobalIndex>& ids = at_vertices ? interface.vertex_ids : interface.face_ids;
    const Vec3 p = entry < places.size() ? places[entry] : Vec3::Zero().eval();
    problem = fmt::format("'{}' gave a '{}' that is not finite at {} {}, ({:.6g}, {:.6g}, {:.6g}).", who,
                          datum.name, at_vertices ? "vertex" : "face",
                          entry < ids.size() ? ids[entry] : GlobalIndex(entry), p.x(), p.y(), p.z());
  }
  if (const std::string text = first_text(comm, problem); !text.empty()) throw SolveFailure("{}", text);
}

void check_anticipation(const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
                        const std::vector<std::size_t>& group) {
  const auto place = [&](std::size_t i) { return std::ranges::find(group, i) - group.begin(); };
  for (const auto& own : links.all()) {
    if (own.giver != own.taker) continue;
    const bool behind = std::ranges::all_of(links.all(), [&](const Links::Link& l) {
      return l.taker != own.taker || l.datum.name != "velocity" || place(l.giver) < place(own.taker);
    });
    if (behind && schedule.iterates && !schedule.side_by_side) continue;
    throw Error(
        "'{}' anticipates the response of its walls (`surface-density` at its interface), so the structure "
        "must be solved before it in each iteration. Use 'coupling.order: structure-first' (in an exchange: the "
        "structure first in the list) with 'scheme: semi-implicit' or 'implicit', or remove the key.",
        sides[own.taker].name);
  }
}

void check_places(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                  const MappingParameters& mapping) {
  std::set<std::pair<std::size_t, std::size_t>> compared;
  std::vector<int> givers(sides.size(), 0), fluids(sides.size(), 0);
  for (const auto& link : links.all()) {
    if (!tells_shape(link.datum)) continue;
    ++givers[link.taker];
    const auto& gives = sides[link.taker].interface.gives;
    if (std::ranges::any_of(gives, coupling::is_amount)) ++fluids[link.giver];
  }
  for (const auto& link : links.all()) {
    if (!tells_shape(link.datum)) continue;
    const Side &from = sides[link.giver], &to = sides[link.taker];
    // Each of several bodies has only a part of the fluid's surface, each of several fluids a part of the
    // body's. The matched map has its own check.
    if (mapping.type == MappingParameters::Type::matched || givers[link.taker] > 1 || fluids[link.giver] > 1)
      continue;
    if (!compared.insert({link.giver, link.taker}).second) continue;
    const bool by_nearest = mapping.type == MappingParameters::Type::nearest;
    const PlaceReport report = compare_places(comm, from, to, by_nearest);
    if (!report.problem.empty()) throw Error("{}", report.problem);
    if (by_nearest && !report.nests && std::ranges::any_of(from.interface.takes, coupling::is_amount))
      throw Error("{}", not_nested(from.name, to.name));
    if (by_nearest)
      for (const std::string& note : report.notes) log::warn("{}", note);
  }
}

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
  return facts;
}

double faceting(const SurfaceFacts& a, const SurfaceFacts& b) {
  const double extent = std::min(a.extent(), b.extent());
  const double share = extent > 0 ? std::max(a.face, b.face) / extent : 1;
  return 0.01 + share * share;
}

std::string difference_of(const SurfaceFacts& a, const SurfaceFacts& b, double limit) {
  const double size = std::min(a.extent(), b.extent()), area = std::max(a.area, b.area);
  if (!(size > 0) || !(area > 0)) return "";
  const auto of = [&](const char* what, double apart, const std::string& one, const std::string& other) {
    return apart <= limit ? std::string()
                          : fmt::format("{} {} ({}) and {} ({}), which differ by {:.2g} % (limit {:.2g} %)",
                                        what, one, a.names, other, b.names, 100 * apart, 100 * limit);
  };
  const double box = std::max((a.low - b.low).cwiseAbs().maxCoeff(), (a.high - b.high).cwiseAbs().maxCoeff());
  for (const std::string& found :
       {of("area", std::abs(a.area - b.area) / area, fmt::format("{:.4g} m^2", a.area),
           fmt::format("{:.4g} m^2", b.area)),
        of("centroid", (a.centroid - b.centroid).norm() / size, text(a.centroid), text(b.centroid)),
        of("bounding box", box / size, text(a.low) + " to " + text(a.high),
           text(b.low) + " to " + text(b.high))})
    if (!found.empty()) return found;
  return "";
}

void compare_surfaces(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                      const Schedule& schedule) {
  check_mover(comm, sides, schedule);
  for (const SurfaceGroup& group : groups_of(sides, links, schedule)) {
    const auto givers = chosen(sides, group.givers), takers = chosen(sides, group.takers);
    if (!has_size(givers) || !has_size(takers)) continue;
    const SurfaceFacts a = surface_facts(comm, givers), b = surface_facts(comm, takers);
    if (const std::string difference = difference_of(a, b, faceting(a, b)); !difference.empty())
      diagnostics::finding(
          parallel::comm_rank(comm),
          {.id = "surfaces-apart",
           .sentence = fmt::format("the coupled surfaces do not match, so parts of one surface have no "
                                   "partner on the other: {}",
                                   difference),
           .advice =
               "check the meshes' units and dimensions, and which patches have `type: interface` or `conjugate: true`"});
  }
}

}  // namespace couplet::coupler
