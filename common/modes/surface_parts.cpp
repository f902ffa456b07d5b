// SPDX-License-Identifier: Apache-2.0
#include "common/modes/modal_checks.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "common/base/disjoint_sets.hpp"
#include "common/base/point_tree.hpp"

namespace couplet::modes {

namespace {

/// Face at an edge. `forward` is true if it runs from the smaller to the larger vertex number.
struct EdgeUse {
  Index face;
  bool forward;
};
using Edges = std::map<std::pair<Index, Index>, std::vector<EdgeUse>>;

Edges edges_of(const mesh::Csr& faces) {
  Edges edges;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto corners = faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Index from = corners[i], to = corners[(i + 1) % corners.size()];
      edges[std::minmax(from, to)].push_back({f, from < to});
    }
  }
  return edges;
}

/// Distance up to which vertices are considered equal [m].
double same_place(const ModalModel& model) {
  double shortest = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i)
      shortest = std::min(
          shortest, (model.vertices[corners[i]] - model.vertices[corners[(i + 1) % corners.size()]]).norm());
  }
  return std::min(1e-6 * extent_of(model).norm(), 0.01 * shortest);
}

/// Smallest vertex number at the position of each vertex.
std::vector<Index> places_of(const ModalModel& model) {
  const double distance = same_place(model);
  const base::PointTree tree(model.vertices);
  std::vector<Index> place(model.vertices.size());
  for (std::size_t v = 0; v < place.size(); ++v) {
    place[v] = Index(v);
    for (const Index other : tree.within(model.vertices[v], distance))
      place[v] = std::min(place[v], place[std::size_t(std::min(other, Index(v)))]);
  }
  return place;
}

/// Surface whose vertices at one position are merged (to 1e-6 of its size and 1/100 of its shortest edge),
/// because other programs may duplicate them for every face or part.
struct WeldedSurface {
  mesh::Csr faces;                       ///< merged vertex numbers; faces with fewer than 3 are empty
  std::vector<std::vector<Index>> part;  ///< faces of each part connected by edges
};

WeldedSurface weld(const ModalModel& model) {
  WeldedSurface welded;
  const std::vector<Index> place = places_of(model);
  for (Index f = 0; f < model.faces.size(); ++f) {
    std::vector<Index> corners;
    for (const Index v : model.faces[f])
      if (std::ranges::find(corners, place[std::size_t(v)]) == corners.end())
        corners.push_back(place[std::size_t(v)]);
    if (corners.size() < 3) corners.clear();
    welded.faces.push_row(corners);
  }
  // Touching bodies have edges of four faces, where only faces with the same vertices are connected.
  base::DisjointSets groups(Index(model.faces.size()));
  for (const auto& [edge, uses] : edges_of(model.faces))
    for (const EdgeUse& use : uses) groups.join(uses.front().face, use.face);
  for (const auto& [edge, uses] : edges_of(welded.faces))
    if (uses.size() == 2) groups.join(uses[0].face, uses[1].face);
  std::map<Index, std::size_t> number;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto [at, fresh] = number.try_emplace(groups.find(f), welded.part.size());
    if (fresh) welded.part.emplace_back();
    welded.part[at->second].push_back(f);
  }
  return welded;
}

/// Reports two faces at an edge (possibly with duplicate vertices) with different orientation. More than two
/// faces may belong to touching bodies and are skipped.
std::string neighbour_problem_of(const ModalModel& model, const WeldedSurface& welded) {
  for (const auto& [edge, uses] : edges_of(welded.faces)) {
    if (uses.size() != 2 || uses[0].forward != uses[1].forward) continue;
    const Vec3 x = 0.5 * (model.vertices[edge.first] + model.vertices[edge.second]);
    return fmt::format(
        "faces {} and {} share an edge at ({:.4g}, {:.4g}, {:.4g}) and traverse it in the same direction: "
        "one of them is inside out",
        uses[0].face + 1, uses[1].face + 1, x.x(), x.y(), x.z());
  }
  return "";
}

/// Relative sum of area vectors above which a surface is a sheet. It is zero for a closed surface, equals the
/// missing rim for a plate, and is 0.64 for half a tube.
constexpr double sheet_share = 0.25;

/// Center of the edges that belong to only one face. Nothing for a closed surface.
std::optional<Vec3> middle_of_rim(const ModalModel& model) {
  Vec3 sum = Vec3::Zero();
  double length = 0;
  for (const auto& [edge, uses] : edges_of(model.faces)) {
    if (uses.size() > 1) continue;
    const Vec3 &a = model.vertices[edge.first], &b = model.vertices[edge.second];
    sum += (b - a).norm() * 0.5 * (a + b);
    length += (b - a).norm();
  }
  if (!(length > 0)) return std::nullopt;
  return sum / length;
}

}  // namespace

std::string surface_problem_of(const ModalModel& model) {
  std::vector<bool> used(model.vertices.size(), false);
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (auto v = corners.begin(); v != corners.end(); ++v) {
      used[std::size_t(*v)] = true;
      if (std::find(corners.begin(), v, *v) != v)
        return fmt::format("face {} refers to vertex {} twice", f + 1, *v);
    }
  }
  // More than two faces at an edge may belong to touching bodies, which are oriented consistently in pairs.
  for (const auto& [edge, uses] : edges_of(model.faces)) {
    const bool forward = uses.front().forward;
    if (uses.size() > 1 && std::ranges::all_of(uses, [&](const EdgeUse& u) { return u.forward == forward; }))
      return fmt::format(
          "faces {} and {} traverse their edge between vertices {} and {} in the same direction: one of them is inside out",
          uses[0].face + 1, uses[1].face + 1, forward ? edge.first : edge.second,
          forward ? edge.second : edge.first);
  }
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v]) return fmt::format("vertex {} belongs to no face", v);
  return "";
}

std::optional<double> volume_behind(const ModalModel& model) {
  const std::vector<Vec3> centres = face_centres(model), areas = face_areas(model);
  Vec3 left = Vec3::Zero(), middle = Vec3::Zero();
  double area = 0;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    left += areas[f];
    area += areas[f].norm();
    middle += areas[f].norm() * centres[f];
  }
  if (!(area > 0) || left.norm() > sheet_share * area) return std::nullopt;
  middle /= area;
  const auto about = [&](const Vec3& origin) {
    double volume = 0;
    for (std::size_t f = 0; f < areas.size(); ++f) volume += (centres[f] - origin).dot(areas[f]) / 3;
    return volume;
  };
  const std::optional<Vec3> rim = middle_of_rim(model);
  if (!rim) return about(middle);
  // For a wide, curved rim the cone is only a guess, so the center of the surface must give the same sign.
  const double by_rim = about(*rim), by_middle = about(middle);
  if ((by_rim > 0) != (by_middle > 0)) return std::nullopt;
  return by_rim;
}

namespace {

/// Intersection of a line with a triangle in units of `along`, or NaN [Moeller and Trumbore 1997].
double meeting(const Vec3& from, const Vec3& along, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = along.cross(ac);
  const double none = std::numeric_limits<double>::quiet_NaN(), determinant = ab.dot(p);
  if (std::abs(determinant) <= 1e-12 * ab.norm() * ac.norm()) return none;
  const Vec3 s = from - a, q = s.cross(ab);
  const double u = s.dot(p) / determinant, v = along.dot(q) / determinant;
  if (!(u >= 0 && v >= 0 && u + v <= 1)) return none;
  return ac.dot(q) / determinant;
}

/// Intersections of the surface with a line along the normal of a face.
struct Crossings {
  int before = 0, behind = 0;                       // number of faces
  bool other_before = false, other_behind = false;  // with another part
  bool touches = false;  // a face at the same position: a touching body, or a duplicate
};

/// Areas that vote for the orientation of a part [m^2].
struct Votes {
  double outward = 0, inward = 0, all = 0;
};

class Sides {
 public:
  Sides(const ModalModel& model, const WeldedSurface& welded)
      : model_(model), welded_(welded), areas_(face_areas(model)), part_of_(areas_.size()) {
    for (std::size_t p = 0; p < welded.part.size(); ++p)
      for (const Index f : welded.part[p]) part_of_[std::size_t(f)] = p;
    near_ = 1e-9 * extent_of(model).norm();
  }

  /// Votes of at most `samples` faces of a part, evenly distributed.
  Votes of(std::size_t part, std::size_t samples) const {
    const std::vector<Index>& faces = welded_.part[part];
    const bool sheet = is_sheet(faces);
    Votes votes;
    const std::size_t n = std::min(samples, faces.size());
    for (std::size_t i = 0; i < n; ++i) {
      const Index f = faces[i * faces.size() / n];
      const double area = areas_[std::size_t(f)].norm();
      votes.all += area;
      const Crossings seen = crossings(f);
      const bool before = seen.before % 2 == 1, behind = seen.behind % 2 == 1;
      if (seen.touches || before == behind) continue;
      // A curved sheet does not define a side by intersecting itself.
      if (sheet && !(before ? seen.other_before : seen.other_behind)) continue;
      (before ? votes.inward : votes.outward) += area;
    }
    return votes;
  }

  /// Volume behind a single part.
  std::optional<double> volume(std::size_t part) const {
    ModalModel alone;
    alone.vertices = model_.vertices;
    for (const Index f : welded_.part[part])
      if (!welded_.faces[f].empty()) alone.faces.push_row(welded_.faces[f]);
    return volume_behind(alone);
  }

  /// Description of a part in a message.
  std::string name(std::size_t part) const {
    if (welded_.part.size() == 1) return "its faces";
    Vec3 middle = Vec3::Zero();
    double area = 0;
    const std::vector<Vec3> centres = face_centres(model_);
    for (const Index f : welded_.part[part]) {
      middle += areas_[std::size_t(f)].norm() * centres[std::size_t(f)];
      area += areas_[std::size_t(f)].norm();
    }
    middle /= area;
    return fmt::format(
        "the faces of part {} of {} ({} faces from face {} on, centered at ({:.4g}, {:.4g}, {:.4g}))",
        part + 1, welded_.part.size(), welded_.part[part].size(), welded_.part[part].front() + 1, middle.x(),
        middle.y(), middle.z());
  }

 private:
  bool is_sheet(const std::vector<Index>& faces) const {
    Vec3 left = Vec3::Zero();
    double area = 0;
    for (const Index f : faces) left += areas_[std::size_t(f)], area += areas_[std::size_t(f)].norm();
    return left.norm() > sheet_share * area;
  }

  /// Starts at a point of the face that is unlikely to be opposite an edge.
  Crossings crossings(Index face) const {
    const auto corners = model_.faces[face];
    const Vec3 from = 0.41 * model_.vertices[corners[0]] + 0.33 * model_.vertices[corners[1]] +
                      0.26 * model_.vertices[corners[2]];
    const Vec3 along = areas_[std::size_t(face)].normalized();
    Crossings seen;
    for (Index f = 0; f < model_.faces.size(); ++f) {
      if (f == face) continue;
      const auto v = model_.faces[f];
      for (std::size_t i = 2; i < v.size(); ++i) {
        const double at =
            meeting(from, along, model_.vertices[v[0]], model_.vertices[v[i - 1]], model_.vertices[v[i]]);
        if (std::isnan(at)) continue;
        const bool other = part_of_[std::size_t(f)] != part_of_[std::size_t(face)];
        seen.touches = seen.touches || std::abs(at) <= near_;
        ++(at > 0 ? seen.before : seen.behind);
        bool& other_there = at > 0 ? seen.other_before : seen.other_behind;
        other_there = other_there || other;
        break;
      }
    }
    return seen;
  }

  const ModalModel& model_;
  const WeldedSurface& welded_;
  std::vector<Vec3> areas_;
  std::vector<std::size_t> part_of_;
  double near_ = 0;
};

/// Reports a wrong orientation of one part. Empty if it is right or undetermined.
std::string part_problem(const Sides& sides, std::size_t part, std::size_t samples, Facing wanted) {
  constexpr const char* rule =
      "(seen from outside, the vertices of a face must be in counterclockwise order)";
  const Votes votes = sides.of(part, samples);
  const double said = votes.outward + votes.inward;
  const double right = wanted == Facing::outward ? votes.outward : votes.inward, wrong = said - right;
  if (said >= 0.5 * votes.all) {
    if (right >= 0.9 * said) return "";
    if (wrong >= 0.9 * said)
      return wanted == Facing::outward
                 ? fmt::format(
                       "{} are inside out: their normals point into the structure, but must point out of it {}",
                       sides.name(part), rule)
                 : fmt::format(
                       "{} point out of the space that the surface encloses, but those of a cavity wall "
                       "('modes.cavity: true') must point into it {}",
                       sides.name(part), rule);
  }
  const std::optional<double> volume = sides.volume(part);
  if (!volume) {
    if (!(said >= 0.5 * votes.all)) return "";
    return fmt::format(
        "cannot determine on which side of {} the structure lies: {:.0f} % of them face away from other faces and {:.0f} % "
        "toward them. Give the complete surface of the structure, closed where it is closed",
        sides.name(part), 100 * votes.outward / said, 100 * votes.inward / said);
  }
  if (wanted == Facing::outward ? !(*volume < 0) : !(*volume > 0)) return "";
  return wanted == Facing::outward
             ? fmt::format(
                   "{} are inside out: their normals point into the volume of {:.3g} m^3 that the surface encloses, but must "
                   "point out of it {}",
                   sides.name(part), -*volume, rule)
             : fmt::format(
                   "{} point out of the volume of {:.3g} m^3 that the surface encloses, but those of a cavity wall "
                   "('modes.cavity: true') must point into it {}",
                   sides.name(part), *volume, rule);
}

}  // namespace

std::string facing_problem_of(const ModalModel& model, Facing wanted) {
  const WeldedSurface welded = weld(model);
  if (std::string problem = neighbour_problem_of(model, welded); !problem.empty()) return problem;
  const Sides sides(model, welded);
  const std::size_t parts = welded.part.size();
  const std::size_t samples = std::clamp<std::size_t>(2000 / parts, 5, 64);
  for (std::size_t p = 0; p < parts; ++p)
    if (std::string problem = part_problem(sides, p, samples, wanted); !problem.empty()) return problem;
  return "";
}

}  // namespace couplet::modes
