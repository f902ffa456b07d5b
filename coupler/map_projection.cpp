// SPDX-License-Identifier: Apache-2.0
#include "coupler/map_projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/base/error.hpp"
#include "common/base/nearest.hpp"
#include "common/base/point_tree.hpp"
#include "coupler/map_local.hpp"

namespace couplet {
namespace {

std::span<const Index> corners(const Interface& surface, Index face) {
  return {surface.face_vertices.data() + surface.face_offset[face],
          std::size_t(surface.face_offset[face + 1] - surface.face_offset[face])};
}

/// The nearest place of a face, as weights of its corners.
struct OnFace {
  std::vector<double> weights;
  double distance = std::numeric_limits<double>::max();
};

OnFace on_face(const Interface& surface, Index face, const Vec3& p) {
  const auto vertex = corners(surface, face);
  const auto at = [&](std::size_t i) { return surface.vertices[vertex[i]]; };
  const auto whole = [](const auto& nearest) {
    return OnFace{{nearest.weights.begin(), nearest.weights.end()}, nearest.distance};
  };
  if (vertex.size() == 2) return whole(nearest_on_segment(at(0), at(1), p));
  if (vertex.size() == 3) return whole(nearest_on_triangle(at(0), at(1), at(2), p));
  const std::size_t n = vertex.size();
  Vec3 centre = Vec3::Zero();
  for (std::size_t i = 0; i < n; ++i) centre += at(i) / double(n);
  OnFace best;
  for (std::size_t i = 0; i < n; ++i) {
    const Nearest<3> part = nearest_on_triangle(at(i), at((i + 1) % n), centre, p);
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
  explicit FacesAround(const Interface& surface) : offset(surface.vertices.size() + 1, 0) {
    for (const Index v : surface.face_vertices) ++offset[v + 1];
    for (std::size_t v = 0; v + 1 < offset.size(); ++v) offset[v + 1] += offset[v];
    face.resize(surface.face_vertices.size());
    std::vector<Index> next(offset.begin(), offset.end() - 1);
    for (Index f = 0; f < Index(surface.face_centres.size()); ++f)
      for (const Index v : corners(surface, f)) face[next[v]++] = f;
  }
};

/// Centres of equal parts of a face, about `pieces` along each direction; their mean is the face's centre.
std::vector<Vec3> parts(const Interface& surface, Index face, int pieces) {
  const Vec3& centre = surface.face_centres[face];
  if (pieces <= 1 || surface.face_offset.empty()) return {centre};
  const auto vertex = corners(surface, face);
  const auto at = [&](std::size_t i) { return surface.vertices[vertex[i]]; };
  std::vector<Vec3> result;
  if (vertex.size() == 2 || vertex.size() == 4) {
    for (int i = 0; i < pieces; ++i) {
      const double s = (i + 0.5) / pieces;
      if (vertex.size() == 2) result.push_back((1 - s) * at(0) + s * at(1));
      for (int j = 0; vertex.size() == 4 && j < pieces; ++j) {
        const double t = (j + 0.5) / pieces;
        result.push_back((1 - s) * ((1 - t) * at(0) + t * at(3)) + s * ((1 - t) * at(1) + t * at(2)));
      }
    }
  } else {  // triangles about the centre, each cut into pieces^2 alike
    const std::size_t n = vertex.size();
    for (std::size_t e = 0; e < n; ++e)
      for (int i = 0; i < pieces; ++i)
        for (int j = 0; j < 2 * (pieces - i) - 1; ++j) {
          const double s = (i + (j % 2 == 0 ? 1. : 2.) / 3) / pieces,
                       t = (j / 2 + (j % 2 == 0 ? 1. : 2.) / 3) / pieces;
          result.push_back((1 - s - t) * centre + s * at(e) + t * at((e + 1) % n));
        }
  }
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : result) mean += p / double(result.size());
  for (Vec3& p : result) p += centre - mean;
  return result;
}

/// The first k of `near` that look against `area`.
void facing(const Vec3& area, const Interface& to, const std::vector<Index>& near, std::size_t k,
            std::vector<Index>& result) {
  result.clear();
  for (const Index s : near)
    if (result.size() < k && area.dot(to.face_areas[s]) < -0.5 * area.norm() * to.face_areas[s].norm())
      result.push_back(s);
}

}  // namespace

void require_corners(bool known) {
  if (!known)
    throw Error(
        "A mapping by projection needs the vertices of each face, which a participant does not list: take "
        "`coupling.mapping.type: rbf` or nearest.");
}

SparseMap nearest_projection(const Interface& surface, const std::vector<Vec3>& targets) {
  require_corners(surface.face_offset.size() == surface.face_centres.size() + 1);
  const FacesAround around(surface);
  const PointTree vertices(surface.vertices), centres(surface.face_centres);
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

SparseMap shared_out(const Interface& from, const Interface& to, std::size_t k) {
  const PointTree tree(to.face_centres);
  const double power = to.dim == 2 ? 1 : 0.5;
  SparseMap gather;  // to the parts of each face of `from`, from the faces of `to`: transposed at the end
  gather.n_from = to.face_centres.size();
  std::vector<Index> sources;
  for (Index f = 0; f < Index(from.face_centres.size()); ++f) {
    const Index closest = tree.nearest(from.face_centres[f], 1).front();
    const double size = std::pow(from.face_areas[f].norm() / to.face_areas[closest].norm(), power);
    const std::vector<Vec3> pieces = parts(from, f, int(std::clamp(std::ceil(size - 0.1), 1., 32.)));
    std::map<Index, double> row;
    for (const Vec3& p : pieces) {
      facing(from.face_areas[f], to, tree.nearest(p, k), k, sources);
      if (sources.size() < k) facing(from.face_areas[f], to, tree.nearest(p, 4 * k), k, sources);
      if (sources.size() < 2) sources = tree.nearest(p, k);
      const std::vector<double> weights = local_weights(to.face_centres, sources, p);
      for (std::size_t i = 0; i < sources.size(); ++i) row[sources[i]] += weights[i] / double(pieces.size());
    }
    std::vector<Index> columns;
    std::vector<double> weights;
    for (const auto& [column, weight] : row) columns.push_back(column), weights.push_back(weight);
    gather.push_row(columns, weights);
  }
  return gather.transposed();
}

SparseMap local_interpolation(const std::vector<Vec3>& sources, const std::vector<Vec3>& targets,
                              std::size_t k) {
  const PointTree tree(sources);
  SparseMap map;
  map.n_from = sources.size();
  for (const Vec3& p : targets) {
    const std::vector<Index> near = tree.nearest(p, k);
    map.push_row(near, local_weights(sources, near, p));
  }
  return map;
}

void check_corners(const Interface& surface, const std::string& name, GlobalIndex vertices) {
  if (surface.face_offset.empty() && surface.face_vertices.empty()) return;
  const auto refuse = [&](const std::string& what) {
    throw Error("The corners of the faces of '{}' are listed wrongly: {}.", name, what);
  };
  const std::size_t n = surface.face_centres.size();
  if (surface.face_offset.size() != n + 1)
    refuse(
        fmt::format("{} offsets for {} faces, one more than faces is right", surface.face_offset.size(), n));
  if (surface.face_offset.front() != 0 || surface.face_offset.back() != Index(surface.face_vertices.size()))
    refuse("the offsets do not go from 0 to the number of corners");
  for (std::size_t f = 0; f < n; ++f)
    if (surface.face_offset[f + 1] - surface.face_offset[f] < 2)
      refuse(fmt::format("face {} has less than two corners", f));
  for (const Index v : surface.face_vertices)
    if (v < 0 || v >= vertices) refuse(fmt::format("vertex {} is none of its {}", v, vertices));
}

SparseMap vertices_to_faces(const Interface& surface) {
  if (surface.face_offset.size() != surface.face_centres.size() + 1)
    return local_interpolation(surface.vertices, surface.face_centres, surface.dim == 2 ? 2 : 4);
  SparseMap map;
  map.n_from = surface.vertices.size();
  for (Index f = 0; f < Index(surface.face_centres.size()); ++f) {
    const auto vertex = corners(surface, f);
    map.push_row(vertex, std::vector<double>(vertex.size(), 1 / double(vertex.size())));
  }
  return map;
}

}  // namespace couplet
