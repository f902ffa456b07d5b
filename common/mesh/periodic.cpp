// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <tuple>

#include "common/base/error.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

/// One boundary face of a periodic patch.
struct Side {
  Index face;  // index into Faces
  Vec3 centre;
  double size;  // largest distance of a point from the centre
};

int patch_index(const RawMesh& raw, const std::string& name) {
  const auto found = std::find(raw.patches.begin(), raw.patches.end(), name);
  if (found == raw.patches.end()) throw Error(no_periodic_patch(name));
  return static_cast<int>(found - raw.patches.begin());
}

std::vector<Side> sides_of(const RawMesh& raw, const Faces& faces, int patch) {
  std::vector<Side> sides;
  for (Index b = 0; b < faces.n_boundary(); ++b) {
    if (faces.patch[b] != patch) continue;
    Side side{faces.n_interior + b, Vec3::Zero(), 0};
    const auto points = faces.points[side.face];
    for (const Index p : points) side.centre += raw.points[p] / double(points.size());
    for (const Index p : points) side.size = std::max(side.size, (raw.points[p] - side.centre).norm());
    sides.push_back(side);
  }
  return sides;
}

Vec3 middle(const std::vector<Side>& sides) {
  Vec3 sum = Vec3::Zero();
  for (const Side& s : sides) sum += s.centre;
  return sum / double(sides.size());
}

/// Finds faces by their centres, sorted by periodic_key().
class Finder {
 public:
  explicit Finder(const std::vector<Side>& sides) {
    for (std::size_t i = 0; i < sides.size(); ++i) order_.emplace_back(periodic_key(sides[i].centre), i);
    std::sort(order_.begin(), order_.end());
  }
  /// Index into `sides`, or its size.
  std::size_t find(const std::vector<Side>& sides, const Vec3& x, double reach) const {
    const double at = periodic_key(x);
    auto i = std::lower_bound(order_.begin(), order_.end(), std::pair(at - reach, std::size_t(0)));
    for (; i != order_.end() && i->first <= at + reach; ++i)
      if ((sides[i->second].centre - x).norm() <= reach) return i->second;
    return sides.size();
  }

 private:
  std::vector<std::pair<double, std::size_t>> order_;
};

struct Joined {
  Index face, owner, neighbour;  // `face` gives the points, on the owner's side
  Vec3 shift;
};

void join(const RawMesh& raw, const Faces& faces, const std::array<std::string, 2>& names,
          std::vector<Joined>& joined, std::vector<char>& gone) {
  const std::vector<Side> first = sides_of(raw, faces, patch_index(raw, names[0])),
                          second = sides_of(raw, faces, patch_index(raw, names[1]));
  if (first.size() != second.size() || first.empty())
    throw Error(periodic_counts_differ(names, GlobalIndex(first.size()), GlobalIndex(second.size())));
  const Vec3 translation = middle(second) - middle(first);
  const Finder finder(second);
  for (const Side& side : first) {
    const std::size_t found = finder.find(second, side.centre + translation, periodic_tolerance * side.size);
    if (found == second.size() || gone[second[found].face - faces.n_interior])
      throw Error(
          no_periodic_match(names, place(side.centre, raw.dim), place(side.centre + translation, raw.dim)));
    const Index a = side.face, b = second[found].face;
    gone[a - faces.n_interior] = gone[b - faces.n_interior] = 1;
    if (faces.owner[a] <= faces.owner[b])
      joined.push_back({a, faces.owner[a], faces.owner[b], -translation});
    else
      joined.push_back({b, faces.owner[b], faces.owner[a], translation});
  }
}

}  // namespace

std::string no_periodic_patch(const std::string& patch) {
  return fmt::format("The periodic patch '{}' does not exist.", patch);
}

std::string periodic_counts_differ(const std::array<std::string, 2>& patches, GlobalIndex first,
                                   GlobalIndex second) {
  return fmt::format(
      "The periodic patches '{}' and '{}' have {} and {} faces. Mesh both identically (gmsh: Periodic "
      "Curve or Periodic Surface).",
      patches[0], patches[1], first, second);
}

std::string no_periodic_match(const std::array<std::string, 2>& patches, const std::string& where,
                              const std::string& there) {
  return fmt::format(
      "The face at {} of the periodic patch '{}' has no match on '{}' at {}. The patches must be "
      "translated copies of each other.",
      where, patches[0], patches[1], there);
}

void join_periodic(const RawMesh& raw, Faces& faces) {
  if (raw.periodic.empty()) return;
  std::vector<Joined> interior;
  for (Index f = 0; f < faces.n_interior; ++f)
    interior.push_back({f, faces.owner[f], faces.neighbour[f], Vec3::Zero()});
  std::vector<char> gone(faces.n_boundary(), 0);
  for (const auto& names : raw.periodic) join(raw, faces, names, interior, gone);
  std::sort(interior.begin(), interior.end(), [](const Joined& a, const Joined& b) {
    return std::tuple(a.owner, a.neighbour, a.face) < std::tuple(b.owner, b.neighbour, b.face);
  });
  Faces result;
  result.n_interior = static_cast<Index>(interior.size());
  for (const Joined& f : interior) {
    result.points.push_row(faces.points[f.face]);
    result.owner.push_back(f.owner);
    result.neighbour.push_back(f.neighbour);
    result.shift.push_back(f.shift);
  }
  for (Index b = 0; b < faces.n_boundary(); ++b) {
    if (gone[b]) continue;
    result.points.push_row(faces.points[faces.n_interior + b]);
    result.owner.push_back(faces.owner[faces.n_interior + b]);
    result.patch.push_back(faces.patch[b]);
  }
  faces = std::move(result);
}

}  // namespace couplet::mesh
