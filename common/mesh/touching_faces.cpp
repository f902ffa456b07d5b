// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/touching_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "common/base/disjoint_sets.hpp"
#include "common/base/point_tree.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {
namespace {

/// Largest distance of faces or points that coincide, relative to the size of a face.
constexpr double touching = 1e-4;
/// Largest cosine of the angle between the outer normals of coincident faces.
constexpr double opposite = -0.95;
/// Least cosine of the angle between neighboring faces of one curved surface; beyond it they meet at an edge.
constexpr double smooth = 0.85;

struct BoundaryFace {
  Vec3 centre, normal;
  double reach;  ///< radius of a circle about the center that lies within the face [m]
  double bulge;  ///< height of the curved surface above the face [m]
  int patch;
};

std::vector<BoundaryFace> boundary_faces(const Mesh& mesh, const Geometry& geometry) {
  std::vector<BoundaryFace> faces;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const Patch& patch = mesh.patches[p];
    if (patch.bonded) continue;
    std::map<Index, std::vector<Vec3>> normals;  // of the faces at a point
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      for (const Index v : mesh.face_points[f]) normals[v].push_back(geometry.face_area[f].normalized());
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const auto points = mesh.face_points[f];
      const Vec3& centre = geometry.face_centre[f];
      double reach = 1e300;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 &a = geometry.points[points[i]], &b = geometry.points[points[(i + 1) % points.size()]];
        reach = std::min(
            reach, mesh.dim == 2 ? 0.5 * (b - a).norm() : base::nearest_on_segment(a, b, centre).distance);
      }
      const Vec3 normal = geometry.face_area[f].normalized();
      double cosine = 1;
      for (const Index v : points)
        for (const Vec3& other : normals[v])
          if (const double c = normal.dot(other); c > smooth) cosine = std::min(cosine, c);
      // A chord of length l that turns by an angle a from one to the next is a l/8 below its arc.
      faces.push_back({centre, normal, reach, reach * std::acos(cosine) / 4, static_cast<int>(p)});
    }
  }
  return faces;
}

/// Corners of a boundary element.
struct Corners {
  std::array<GlobalIndex, 4> point{};
  std::array<Vec3, 4> x{};
  int n = 0;
  Vec3 centre() const {
    Vec3 sum = Vec3::Zero();
    for (int i = 0; i < n; ++i) sum += x[std::size_t(i)];
    return sum / n;
  }
  double size() const { return (x[0] - centre()).norm(); }
};

/// Elements of all ranks, in the order of the ranks. Collective.
std::vector<Corners> all_elements(MPI_Comm comm, const MeshBlock& block) {
  const PointNumbers numbers(block.element_points);
  const std::vector<Vec3> x =
      fetch(comm, block.point_shares, std::span<const Vec3>(block.points), numbers.numbers());
  std::vector<Corners> elements(std::size_t(block.n_elements()));
  for (Index e = 0; e < block.n_elements(); ++e) {
    Corners& corners = elements[std::size_t(e)];
    for (const GlobalIndex p : block.element(e)) {
      corners.point[std::size_t(corners.n)] = p;
      corners.x[std::size_t(corners.n++)] = x[std::size_t(numbers.place(p))];
    }
  }
  return parallel::all_gather(comm, elements);
}

/// Pairs of points of two coincident elements. Empty if the elements do not coincide or share their points.
std::vector<std::array<GlobalIndex, 2>> common_points(const Corners& a, const Corners& b) {
  std::vector<std::array<GlobalIndex, 2>> pairs;
  bool differ = false;
  for (std::size_t i = 0; i < std::size_t(a.n) && a.n == b.n; ++i)
    for (std::size_t j = 0; j < std::size_t(b.n); ++j)
      if ((a.x[i] - b.x[j]).norm() <= touching * a.size()) {
        pairs.push_back({a.point[i], b.point[j]});
        differ = differ || a.point[i] != b.point[j];
      }
  if (!differ || std::ssize(pairs) != a.n) pairs.clear();
  return pairs;
}

}  // namespace

std::vector<TouchingFaces> find_touching_faces(const Mesh& mesh, const Geometry& geometry) {
  const std::vector<BoundaryFace> own = boundary_faces(mesh, geometry),
                                  all = parallel::all_gather(mesh.comm, own);
  if (all.empty()) return {};
  std::vector<Vec3> centres;
  for (const BoundaryFace& face : all) centres.push_back(face.centre);
  const base::PointTree tree(centres);
  struct PatchPair {
    int patch, other;
    bool alike;
    Index at;  // among the faces of all ranks
  };
  std::vector<PatchPair> found;
  const auto first = static_cast<Index>(parallel::exclusive_scan(mesh.comm, GlobalIndex(own.size())));
  for (std::size_t i = 0; i < own.size(); ++i)
    for (const Index j : tree.within(own[i].centre, own[i].reach)) {
      const BoundaryFace &face = own[i], &other = all[std::size_t(j)];
      const Vec3 away = other.centre - face.centre;
      const double most = touching * face.reach + 1.1 * std::max(face.bulge, other.bulge);
      if (face.normal.dot(other.normal) > opposite || std::abs(face.normal.dot(away)) > most) continue;
      const bool alike = away.norm() <= touching * face.reach;
      const Index here = first + Index(i);
      found.push_back({face.patch, other.patch, alike, here});
      if (!alike) found.push_back({other.patch, face.patch, alike, j});
    }
  found = parallel::all_gather(mesh.comm, found);
  std::ranges::sort(found, {}, [](const PatchPair& f) { return std::tuple(f.patch, f.other, f.at); });
  std::map<std::pair<int, int>, TouchingFaces> pairs;
  Index last = -1;
  for (const PatchPair& f : found) {
    if (f.patch > f.other) continue;
    TouchingFaces& pair = pairs[{f.patch, f.other}];
    if (pair.count == 0)
      pair = {mesh.patches[std::size_t(f.patch)].name, mesh.patches[std::size_t(f.other)].name, 0,
              centres[std::size_t(f.at)], true};
    pair.count += pair.count == 0 || f.at != last;
    pair.alike = pair.alike && f.alike;
    last = f.at;
  }
  std::vector<TouchingFaces> result;
  for (auto& [patches, pair] : pairs) result.push_back(std::move(pair));
  return result;
}

void tie_touching_faces(MPI_Comm comm, MeshBlock& block) {
  const auto before = std::size_t(parallel::exclusive_scan(comm, GlobalIndex(block.n_elements())));
  const std::vector<Corners> all = all_elements(comm, block);
  if (all.empty()) return;
  std::vector<Vec3> centres;
  std::vector<GlobalIndex> points;
  for (const Corners& e : all) {
    centres.push_back(e.centre());
    points.insert(points.end(), e.point.begin(), e.point.begin() + e.n);
  }
  const base::PointTree tree(centres);
  const PointNumbers numbers(points);
  base::DisjointSets sets(static_cast<Index>(numbers.numbers().size()));
  std::vector<bool> is_tied(all.size(), false);
  for (std::size_t e = 0; e < all.size(); ++e)
    for (const Index other : tree.within(centres[e], touching * all[e].size())) {
      const auto pairs = common_points(all[e], all[std::size_t(other)]);
      if (!pairs.empty()) is_tied[e] = is_tied[std::size_t(other)] = true;
      for (const auto& [a, b] : pairs) sets.join(numbers.place(a), numbers.place(b));
    }
  const auto tied = std::ranges::count(is_tied, true);
  if (tied == 0)
    log::warn("touching-faces: tie: no two faces in groups of the mesh coincide, so nothing was tied");
  else
    log::info("{} faces of parts that touch are tied in pairs", tied);
  std::map<GlobalIndex, GlobalIndex> moved;
  for (Index i = 0; i < Index(numbers.numbers().size()); ++i)
    if (const Index to = sets.find(i); to != i)
      moved[numbers.numbers()[std::size_t(i)]] = numbers.numbers()[std::size_t(to)];
  const auto move = [&](GlobalIndex& p) {
    if (const auto to = moved.find(p); to != moved.end()) p = to->second;
  };
  std::ranges::for_each(block.cells.points, move);
  MeshBlock kept;
  for (Index e = 0; e < block.n_elements(); ++e)
    if (!is_tied[before + std::size_t(e)])
      kept.push_element(block.element_patch[std::size_t(e)], block.element(e));
  std::ranges::for_each(kept.element_points, move);
  block.element_points = std::move(kept.element_points);
  block.element_offset = std::move(kept.element_offset);
  block.element_patch = std::move(kept.element_patch);
}

}  // namespace couplet::mesh
