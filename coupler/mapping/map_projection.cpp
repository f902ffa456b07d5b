// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/map_projection.hpp"

#include <algorithm>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/point_tree.hpp"
#include "coupler/mapping/corner_weights.hpp"
#include "coupler/mapping/map_local.hpp"

namespace couplet::coupler {
namespace {

/// The nearest place of a face, as weights of its corners.
struct OnFace {
  std::vector<double> weights;
  double distance = std::numeric_limits<double>::max();
};

OnFace on_face(const coupling::Interface& surface, Index face, const Vec3& p) {
  const auto vertex = corners(surface, face);
  const auto at = [&](std::size_t i) { return surface.vertices[vertex[i]]; };
  const auto whole = [](const auto& nearest) {
    return OnFace{{nearest.weights.begin(), nearest.weights.end()}, nearest.distance};
  };
  if (vertex.size() == 2) return whole(base::nearest_on_segment(at(0), at(1), p));
  if (vertex.size() == 3) return whole(base::nearest_on_triangle(at(0), at(1), at(2), p));
  const std::size_t n = vertex.size();
  Vec3 centre = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) centre += at(i) / double(n);
  OnFace best;
  for (std::size_t i = 0; i < n; ++i) {
    const base::Nearest<3> part = base::nearest_on_triangle(at(i), at((i + 1) % n), centre, p);
    if (part.distance >= best.distance) continue;
    best = {std::vector<double>(n, part.weights[2] / double(n)), part.distance};
    best.weights[i] += part.weights[0];
    best.weights[(i + 1) % n] += part.weights[1];
  }
  return best;
}

/// Faces at each vertex.
struct FacesAround {
  std::vector<Index> offset, face;
  explicit FacesAround(const coupling::Interface& surface) : offset(surface.vertices.size() + 1, 0) {
    for (const Index v : surface.face_vertices) ++offset[v + 1];
    for (std::size_t v = 0; v + 1 < offset.size(); ++v) offset[v + 1] += offset[v];
    face.resize(surface.face_vertices.size());
    std::vector<Index> next(offset.begin(), offset.end() - 1);
    for (Index f = 0; f < Index(surface.face_centres.size()); ++f)
      for (const Index v : corners(surface, f)) face[next[v]++] = f;
  }
};

}  // namespace

void require_corners(bool known) {
  if (!known)
    throw Error(
        "A mapping by projection needs the vertices of each face, but one participant does not list them: "
        "use `coupling.mapping.type: rbf`.");
}

SparseMap nearest_projection(const coupling::Interface& surface, const std::vector<Vec3>& targets) {
  require_corners(surface.face_offset.size() == surface.face_centres.size() + 1);
  const FacesAround around(surface);
  const base::PointTree vertices(surface.vertices), centres(surface.face_centres);
  SparseMap map;
  map.n_from = surface.vertices.size();
  for (const Vec3& p : targets) {
    std::vector<Index> faces = centres.nearest(p, projection_faces);
    for (const Index v : vertices.nearest(p, projection_vertices))
      faces.insert(faces.end(), around.face.begin() + around.offset[v],
                   around.face.begin() + around.offset[v + 1]);
    OnFace best;
    Index chosen = -1;
    for (const Index f : faces) {
      OnFace found = on_face(surface, f, p);
      if (found.distance < best.distance) best = std::move(found), chosen = f;
    }
    map.push_row(corners(surface, chosen), best.weights);
  }
  return map;
}

double distance_to_face(const coupling::Interface& surface, Index face, const Vec3& place) {
  return on_face(surface, face, place).distance;
}

void add_entries(const SparseMap& map, const std::vector<GlobalIndex>& targets,
                 const std::vector<GlobalIndex>& sources, std::vector<Transfer::Entry>& entries) {
  for (std::size_t row = 0; row < map.n_to(); ++row)
    for (std::size_t k = map.offset[row]; k < map.offset[row + 1]; ++k)
      entries.push_back({targets[row], sources[std::size_t(map.source[k])], map.weight[k]});
}

SparseMap local_interpolation(const std::vector<Vec3>& sources, const std::vector<Vec3>& targets,
                              std::size_t k) {
  const base::PointTree tree(sources);
  SparseMap map;
  map.n_from = sources.size();
  for (const Vec3& p : targets) {
    const std::vector<Index> near = tree.nearest(p, k);
    map.push_row(near, local_weights(sources, near, p));
  }
  return map;
}

void check_corners(const coupling::Interface& surface, const std::string& name, GlobalIndex vertices) {
  if (surface.face_offset.empty() && surface.face_vertices.empty()) return;
  const auto refuse = [&](const std::string& what) {
    throw Error("The face corners of '{}' are invalid: {}.", name, what);
  };
  const std::size_t n = surface.face_centres.size();
  if (surface.face_offset.size() != n + 1)
    refuse(
        fmt::format("{} offsets for {} faces; expected one more than faces", surface.face_offset.size(), n));
  if (surface.face_offset.front() != 0 || surface.face_offset.back() != Index(surface.face_vertices.size()))
    refuse("the offsets do not run from 0 to the number of corners");
  for (std::size_t f = 0; f < n; ++f)
    if (surface.face_offset[f + 1] - surface.face_offset[f] < 2)
      refuse(fmt::format("face {} has fewer than two corners", f));
  for (const Index v : surface.face_vertices)
    if (v < 0 || v >= vertices) refuse(fmt::format("vertex {} is not one of its {}", v, vertices));
}

}  // namespace couplet::coupler
