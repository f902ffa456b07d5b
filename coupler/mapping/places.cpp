// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/places.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {
namespace {

using Place = coupling::Interface::Place;

struct Box {
  Vec3 low, high;
  Box(MPI_Comm comm, const std::vector<Vec3>& points) {
    constexpr double far = std::numeric_limits<double>::infinity();
    low.setConstant(far), high.setConstant(-far);
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    MPI_Allreduce(MPI_IN_PLACE, low.data(), 3, MPI_DOUBLE, MPI_MIN, comm);
    MPI_Allreduce(MPI_IN_PLACE, high.data(), 3, MPI_DOUBLE, MPI_MAX, comm);
  }
  double extent() const { return (high - low).norm(); }
  std::string text() const {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", low.x(), low.y(), low.z(),
                       high.x(), high.y(), high.z());
  }
};

/// Extent of each face of this rank [m]: between corners where these are known (a face may be long and thin),
/// else the edge of a square of its area; in 2-D areas are lengths. Collective.
std::vector<double> extents(MPI_Comm comm, const Side& side) {
  const coupling::Interface& i = side.interface;
  const coupling::Starts corners = coupling::starts_of(
      parallel::all_gather(comm, std::vector<GlobalIndex>{GlobalIndex(i.face_vertices.size())}));
  std::vector<Transfer::Entry> entries;
  for (std::size_t k = 0; k < i.face_vertices.size(); ++k)
    entries.push_back(
        {corners[std::size_t(parallel::comm_rank(comm))] + GlobalIndex(k), i.face_vertices[k], 1.});
  std::vector<double> xyz, at_corners;
  for (const Vec3& v : i.vertices) xyz.insert(xyz.end(), v.data(), v.data() + 3);
  if (corners.back() > 0) at_corners = Transfer(comm, corners, side.vertices, entries).apply(xyz, 3);
  std::vector<double> result;
  for (std::size_t f = 0; f < i.face_centres.size(); ++f) {
    const double area = i.face_areas[f].norm();
    double extent = i.dim == 2 ? area : std::sqrt(area);
    for (Index k = i.face_offset.empty() ? 0 : i.face_offset[f];
         !i.face_offset.empty() && k < i.face_offset[f + 1]; ++k)
      extent = std::max(
          extent, 2 * (Eigen::Map<const Vec3>(&at_corners[3 * std::size_t(k)]) - i.face_centres[f]).norm());
    result.push_back(extent);
  }
  return result;
}

/// Extent of the face nearest to each point [m].
std::vector<double> local_size(MPI_Comm comm, const std::vector<Vec3>& points, const Side& side) {
  PointSet faces = side.places(Place::faces);
  faces.sizes = extents(comm, side);
  std::vector<double> sizes;
  for (const Neighbour& n : nearest(comm, points, faces)) sizes.push_back(n.size);
  return sizes;
}

double mean(MPI_Comm comm, const std::vector<double>& values) {
  double total = 0;
  for (const double v : values) total += v;
  return parallel::sum(comm, total) / std::max(1., parallel::sum(comm, double(values.size())));
}

/// The first text of any rank, on all.
std::string first_text(MPI_Comm comm, const std::string& text) {
  if (parallel::comm_size(comm) == 1 || !parallel::any(comm, !text.empty())) return text;
  const std::vector<char> all = parallel::all_gather(comm, std::vector<char>(text.begin(), text.end()));
  return {all.begin(), all.end()};
}

/// Both boxes must be the same within a tenth of the smaller and two faces of the coarser side.
std::string other_extent(const Box& a, const std::string& from, const Box& b, const std::string& to,
                         double face) {
  const double least = std::min(a.extent(), b.extent());
  const double allowed = 0.1 * least + 2 * std::min(face, least);
  const double off = std::max((a.low - b.low).cwiseAbs().maxCoeff(), (a.high - b.high).cwiseAbs().maxCoeff());
  if (off <= allowed) return "";
  const double ratio = a.extent() / std::max(b.extent(), 1e-300);
  return fmt::format(
      "The interface of '{}' extends from {} m and that of '{}' from {} m: their positions differ{}. Check "
      "the meshes' units and positions and which patches are of type interface.",
      from, a.text(), to, b.text(),
      ratio > 5 || ratio < 0.2
          ? fmt::format(", one is {:.3g} times as large as the other", std::max(ratio, 1 / ratio))
          : "");
}

/// Most targets that follow one source.
int most_followers(MPI_Comm comm, const std::vector<Neighbour>& found, const coupling::Starts& starts) {
  std::vector<std::vector<GlobalIndex>> used(std::size_t(parallel::comm_size(comm)));
  for (const Neighbour& n : found)
    used[std::size_t(coupling::owner_of(starts, n.position))].push_back(n.position);
  std::vector<GlobalIndex> mine;
  for (const auto& part : parallel::all_to_all(comm, used)) mine.insert(mine.end(), part.begin(), part.end());
  std::ranges::sort(mine);
  int most = 0;
  for (std::size_t i = 0; i < mine.size();) {
    const std::size_t first = i;
    while (i < mine.size() && mine[i] == mine[first]) ++i;
    most = std::max(most, int(i - first));
  }
  return int(parallel::max(comm, double(most)));
}

/// Whether each of these points has another within a tenth of the faces there.
bool all_near(MPI_Comm comm, const std::vector<Neighbour>& found, const std::vector<double>& size) {
  bool far = false;
  for (std::size_t i = 0; i < found.size(); ++i) far = far || found[i].distance > 0.1 * size[i];
  return !parallel::any(comm, far);
}

/// Why the nearest vertex is no map between these two: motion in stairs, loads that do another work.
std::string not_nested(const std::string& from, const std::string& to) {
  return fmt::format(
      "The faces of '{}' and '{}' do not nest: vertices of either side lie between those of the other. With "
      "`coupling.mapping.type: nearest` the wall would move in steps and the load would do different work "
      "on the two sides. Set `coupling.mapping.type: projection`: it conserves work, force and moment on "
      "any meshes.",
      from, to);
}

}  // namespace

PlaceReport judge_places(MPI_Comm comm, const Side& from, const Side& to) {
  PlaceReport report;
  // Lumped participants (points with areas) have no extent that could be compared.
  if (from.faces.back() < 2 || to.faces.back() < 2 || from.vertices.back() < 2 || to.vertices.back() < 2)
    return report;
  const PointSet source = from.places(Place::vertices), target = to.places(Place::vertices);
  const std::vector<double> target_size = local_size(comm, target.points, to),
                            source_size = local_size(comm, source.points, from);
  report.problem = other_extent(Box(comm, source.points), from.name, Box(comm, target.points), to.name,
                                std::max(mean(comm, source_size), mean(comm, target_size)));
  if (!report.problem.empty()) return report;
  const std::vector<Neighbour> found = nearest(comm, target.points, source);
  const std::vector<double> there =
      local_size(comm, target.points, from);  // of the source's faces at the targets
  for (std::size_t i = 0; i < target.points.size() && report.problem.empty(); ++i) {
    const double size = std::max(there[i], target_size[i]);
    if (found[i].distance <= 2 * size) continue;
    const Vec3& p = target.points[i];
    report.problem = fmt::format(
        "The point ({:.6g}, {:.6g}, {:.6g}) of '{}' is {:.3g} m away from the nearest point of '{}', where "
        "the face size is {:.3g} m: the two interfaces are not the same surface. Check the meshes and which "
        "patches are of type interface.",
        p.x(), p.y(), p.z(), to.name, found[i].distance, from.name, size);
  }
  report.problem = first_text(comm, report.problem);
  if (!report.problem.empty()) return report;
  report.nests =
      all_near(comm, found, there) || all_near(comm, nearest(comm, source.points, target), source_size);
  if (const int most = most_followers(comm, found, source.starts); most >= 3)
    report.notes.push_back(
        fmt::format("note: '{}' is much coarser than '{}': up to {} vertices follow the same one, so the "
                    "motion is stepped. `mapping.type: projection` avoids this.",
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
    // Zero times a value is zero or not a number: four sums side by side in place of a question a value.
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

void check_foreseen(const std::vector<Side>& sides, const Links& links, const Schedule& schedule,
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
        "must be solved before it in each pass. Use 'coupling.order: structure-first' (in an exchange: the "
        "structure first in the list) with 'scheme: semi-implicit' or 'implicit', or remove the key.",
        sides[own.taker].name);
  }
}

void check_places(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                  const MappingParameters& mapping) {
  std::set<std::pair<std::size_t, std::size_t>> judged;
  std::vector<int> givers(sides.size(), 0), fluids(sides.size(), 0);
  for (const auto& link : links.all()) {
    if (link.datum.name != "displacement") continue;
    ++givers[link.taker];
    const auto& gives = sides[link.taker].interface.gives;
    if (std::ranges::any_of(gives, coupling::is_amount)) ++fluids[link.giver];
  }
  for (const auto& link : links.all()) {
    if (link.datum.name != "displacement") continue;
    const Side &from = sides[link.giver], &to = sides[link.taker];
    // With several bodies each has a part of the fluid's surface only, with several fluids each a part of the
    // body's; the matched map has its own check.
    if (mapping.type == MappingParameters::Type::matched || givers[link.taker] > 1 || fluids[link.giver] > 1)
      continue;
    if (!judged.insert({link.giver, link.taker}).second) continue;
    const PlaceReport report = judge_places(comm, from, to);
    if (!report.problem.empty()) throw Error("{}", report.problem);
    const bool by_nearest = mapping.type == MappingParameters::Type::nearest;
    if (by_nearest && !report.nests && std::ranges::any_of(from.interface.takes, coupling::is_amount))
      throw Error("{}", not_nested(from.name, to.name));
    if (by_nearest)
      for (const std::string& note : report.notes) log::warn("{}", note);
  }
}

}  // namespace couplet::coupler
