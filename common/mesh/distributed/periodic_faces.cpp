// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/match_faces.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"

namespace couplet::mesh {
namespace {

/// Maximum distance of a face center from its partner's, relative to the size of the face.
constexpr double periodic_tolerance = 1e-4;

struct PeriodicSide {
  Vec3 centre;
  double size;  // largest distance of a point from the center
  GlobalIndex element, cell;
  std::int8_t face, side;
  /// Coordinate along a direction in which meshes are not aligned.
  double key() const { return 0.5377 * centre[0] + 0.3315 * centre[1] + 0.7751 * centre[2]; }
};

/// Faces of both patches on this rank. Collective.
std::vector<PeriodicSide> sides_here(MPI_Comm comm, const MeshBlock& block,
                                     const std::array<std::string, 2>& names,
                                     const std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
  std::array<int, 2> patch{};
  for (int s = 0; s < 2; ++s) {
    const auto found = std::ranges::find(block.patches, names[s]);
    if (found == block.patches.end()) throw Error("The periodic patch '{}' does not exist.", names[s]);
    patch[s] = static_cast<int>(found - block.patches.begin());
  }
  std::vector<PeriodicSide> sides;
  std::vector<GlobalIndex> used;
  for (const BoundedCell& b : bounded) {
    const auto e = static_cast<Index>(b.element - first_element);
    for (std::int8_t s = 0; s < 2; ++s) {
      if (block.element_patch[e] != patch[s]) continue;
      sides.push_back({Vec3::Zero(), 0, b.element, b.cell, b.face, s});
      used.insert(used.end(), block.element(e).begin(), block.element(e).end());
    }
  }
  const PointNumbers numbers(used);
  const std::vector<Vec3> x =
      fetch(comm, block.point_shares, std::span<const Vec3>(block.points), numbers.numbers());
  for (PeriodicSide& side : sides) {
    const auto points = block.element(static_cast<Index>(side.element - first_element));
    for (const GlobalIndex p : points) side.centre += x[numbers.place(p)] / double(points.size());
    for (const GlobalIndex p : points)
      side.size = std::max(side.size, (x[numbers.place(p)] - side.centre).norm());
  }
  return sides;
}

/// Translation from the mean center of the first patch's faces to that of the second's.
Vec3 translation_of(const std::vector<PeriodicSide>& all, const std::array<std::string, 2>& names) {
  std::array<Vec3, 2> sum{Vec3::Zero(), Vec3::Zero()};
  std::array<GlobalIndex, 2> count{};
  for (const PeriodicSide& s : all) sum[s.side] += s.centre, ++count[s.side];
  if (count[0] != count[1] || count[0] == 0)
    throw Error(
        "The periodic patches '{}' and '{}' have {} and {} faces. Mesh both identically (gmsh: Periodic "
        "Curve or Periodic Surface).",
        names[0], names[1], count[0], count[1]);
  return sum[1] / double(count[1]) - sum[0] / double(count[0]);
}

/// Cell across each side, or -1. The first patch is translated onto the second.
std::vector<GlobalIndex> cells_beyond(std::vector<PeriodicSide> all, const Vec3& translation) {
  std::array<std::vector<std::size_t>, 2> order;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].side == 0) all[i].centre += translation;
    order[std::size_t(all[i].side)].push_back(i);
  }
  for (auto& of_side : order)
    std::ranges::sort(of_side, {}, [&](std::size_t i) { return std::pair(all[i].key(), all[i].element); });
  std::vector<GlobalIndex> beyond(all.size(), -1);
  for (const std::size_t a : order[0]) {
    const double reach = periodic_tolerance * all[a].size, key = all[a].key();
    auto b = std::ranges::lower_bound(order[1], key - reach, {}, [&](std::size_t i) { return all[i].key(); });
    for (; b != order[1].end() && all[*b].key() <= key + reach; ++b) {
      if (beyond[*b] >= 0 || (all[*b].centre - all[a].centre).norm() > reach) continue;
      beyond[a] = all[*b].cell;
      beyond[*b] = all[a].cell;
      break;
    }
  }
  return beyond;
}

}  // namespace

PeriodicFaces find_periodic_faces(MPI_Comm comm, const MeshBlock& block,
                                  const std::vector<BoundedCell>& bounded, GlobalIndex first_element) {
  PeriodicFaces found;
  for (std::size_t pair = 0; pair < block.periodic.size(); ++pair) {
    const auto& names = block.periodic[pair];
    const std::vector<PeriodicSide> here = sides_here(comm, block, names, bounded, first_element),
                                    all = parallel::all_gather(comm, here);
    const Vec3 translation = translation_of(all, names);
    const std::vector<GlobalIndex> beyond = cells_beyond(all, translation);
    for (std::size_t i = 0; i < all.size(); ++i)
      if (beyond[i] < 0 && all[i].side == 0)
        throw Error(
            "The face at {} of the periodic patch '{}' has no match on '{}' at {}. The patches must be "
            "translated copies of each other.",
            place(all[i].centre, block.dim), names[0], names[1],
            place(all[i].centre + translation, block.dim));
    const auto before = std::size_t(parallel::exclusive_scan(comm, GlobalIndex(here.size())));
    for (std::size_t i = 0; i < here.size(); ++i) {
      const PeriodicSide& s = here[i];
      found.joined.push_back({s.element, s.cell, beyond[before + i], s.face, s.side, static_cast<int>(pair)});
    }
    found.translation.push_back(translation);
  }
  std::ranges::sort(found.joined, {}, &JoinedFace::element);
  return found;
}

}  // namespace couplet::mesh
