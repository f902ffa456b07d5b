// SPDX-License-Identifier: Apache-2.0
// What the places of two coupled surfaces tell before the first step, and of data that arrive.
#include <algorithm>
#include <cmath>
#include <map>
#include <nanoflann.hpp>

#include "common/base/error.hpp"
#include "coupler/guards.hpp"

namespace couplet {
namespace {

using Place = Interface::Place;

struct Cloud {
  const std::vector<Vec3>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return points[i][Eigen::Index(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, Index>;

const std::vector<Vec3>& places_of(const Interface& interface) {
  return interface.vertices.empty() ? interface.face_centres : interface.vertices;
}

struct Box {
  Vec3 low, high;
  explicit Box(const std::vector<Vec3>& points) : low(points.front()), high(points.front()) {
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  }
  std::string text() const {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", low.x(), low.y(), low.z(),
                       high.x(), high.y(), high.z());
  }
};

/// Edge length of a face of this area [m]; in 2-D areas are lengths.
double edge(const Vec3& area, int dim) { return dim == 2 ? area.norm() : std::sqrt(area.norm()); }

/// For each of `points`: distance to the nearest of `among`, and which one.
std::vector<std::pair<double, Index>> nearest(const std::vector<Vec3>& points,
                                              const std::vector<Vec3>& among) {
  const Cloud cloud{among};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  tree.buildIndex();
  std::vector<std::pair<double, Index>> result;
  for (const Vec3& p : points) {
    Index index = 0;
    double square = 0;
    tree.knnSearch(p.data(), 1, &index, &square);
    result.emplace_back(std::sqrt(square), index);
  }
  return result;
}

/// Size of the face nearest to each point [m].
std::vector<double> local_size(const std::vector<Vec3>& points, const Interface& interface) {
  std::vector<double> sizes;
  for (const auto& [distance, face] : nearest(points, interface.face_centres))
    sizes.push_back(edge(interface.face_areas[std::size_t(face)], interface.dim));
  return sizes;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Both boxes must be the same within a tenth of the larger and two faces of either side.
std::string other_extent(const Interface& from, const std::string& from_name, const Interface& to,
                         const std::string& to_name, double face) {
  const Box a(places_of(from)), b(places_of(to));
  const double extent = std::min((a.high - a.low).norm(), (b.high - b.low).norm());
  const double allowed = 0.1 * extent + 2 * std::min(face, extent);
  const double off = std::max((a.low - b.low).cwiseAbs().maxCoeff(), (a.high - b.high).cwiseAbs().maxCoeff());
  if (off <= allowed) return "";
  const double ratio = (a.high - a.low).norm() / std::max((b.high - b.low).norm(), 1e-300);
  return fmt::format(
      "The interface of '{}' reaches from {} m and that of '{}' from {} m: they are not in the same place{}. "
      "Check the "
      "meshes' units and positions and which patches are of type interface.",
      from_name, a.text(), to_name, b.text(),
      ratio > 5 || ratio < 0.2
          ? fmt::format(", one is {:.3g} times as large as the other", std::max(ratio, 1 / ratio))
          : "");
}

}  // namespace

PlaceReport judge_places(const Interface& from, const std::string& from_name, const Interface& to,
                         const std::string& to_name, bool nearest_points) {
  PlaceReport report;
  // Lumped participants (a point with an area) have no extent that could be compared.
  if (!nearest_points || from.face_centres.size() < 2 || to.face_centres.size() < 2) return report;
  const std::vector<Vec3>&source = places_of(from), &target = places_of(to);
  const std::vector<double> source_size = local_size(source, from), target_size = local_size(target, to);
  report.problem =
      other_extent(from, from_name, to, to_name, std::max(median(source_size), median(target_size)));
  if (!report.problem.empty()) return report;
  const auto found = nearest(target, source);
  std::map<Index, int> followers;
  for (std::size_t i = 0; i < target.size(); ++i) {
    const auto [distance, s] = found[i];
    ++followers[s];
    const double size = std::max(source_size[std::size_t(s)], target_size[i]);
    if (distance <= 2 * size) continue;
    const Vec3& p = target[i];
    report.problem = fmt::format(
        "The point ({:.6g}, {:.6g}, {:.6g}) of '{}' is {:.3g} m away from the nearest of '{}', where the "
        "faces "
        "are {:.3g} m: "
        "the two interfaces are not the same surface. Check the meshes and which patches are of type "
        "interface.",
        p.x(), p.y(), p.z(), to_name, distance, from_name, size);
    return report;
  }
  int most = 0;
  for (const auto& [s, n] : followers) most = std::max(most, n);
  if (most >= 3 && !from.vertices.empty() && !to.vertices.empty())
    report.notes.push_back(
        fmt::format("note: '{}' is much coarser than '{}': up to {} vertices follow the same one, so the "
                    "motion arrives in "
                    "stairs. `mapping.type: nearest-projection` carries it without them.",
                    from_name, to_name, most));
  return report;
}

void require_finite(const Exchange& data, const Interface& interface, const std::vector<Interface::Datum>& of,
                    const std::string& who) {
  for (const auto& datum : of) {
    const auto found = data.find(datum.name);
    if (found == data.end()) continue;
    const auto& values = found->second;
    const auto bad = std::ranges::find_if(values, [](double v) { return !std::isfinite(v); });
    if (bad == values.end()) continue;
    const auto entry = std::size_t(bad - values.begin()) / std::size_t(datum.size(interface.dim));
    const bool at_vertices = datum.place == Place::vertices;
    const std::vector<Vec3>& places = at_vertices ? interface.vertices : interface.face_centres;
    const Vec3 p = entry < places.size() ? places[entry] : Vec3::Zero().eval();
    throw SolveFailure("'{}' gave a '{}' that is not finite at {} {}, ({:.6g}, {:.6g}, {:.6g}).", who,
                       datum.name, at_vertices ? "vertex" : "face", entry, p.x(), p.y(), p.z());
  }
}

std::string problem_of_closed_fluid(const Interface& fluid, const std::string& name) {
  if (!fluid.closed || fluid.face_areas.empty()) return "";
  Vec3 sum = Vec3::Zero();
  double all = 0;
  for (const Vec3& area : fluid.face_areas) sum += area, all += area.norm();
  // A surface closed in itself: a body that moves through the fluid displaces nothing in all.
  if (sum.norm() <= 1e-6 * all) return "";
  return fmt::format(
      "'{}' is closed: none of its boundaries lets fluid out, so it cannot make room for an interface that "
      "moves "
      "(incompressible: the net volume through the interface must be 0, and the level of the pressure is "
      "free). "
      "Give it an outlet or a boundary with a given pressure.",
      name);
}

}  // namespace couplet
