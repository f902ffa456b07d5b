// SPDX-License-Identifier: Apache-2.0
#include "common/fv/elastic_corrections.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "common/fv/elastic_nodes.hpp"

namespace couplet {
namespace {

// Normals of a symmetry patch closer than about 2 degrees are one plane.
constexpr double same_plane = 0.9994;

/// Flux faces of each owned cell.
Csr flux_faces_of_cells(const Mesh& mesh) {
  const Index n = mesh.cells.n_owned();
  Csr result;
  result.offset.assign(n + 1, 0);
  const auto visit = [&](auto&& take) {
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      if (mesh.owner[f] < n) take(mesh.owner[f], f);
      if (f < mesh.n_interior && mesh.neighbour[f] < n) take(mesh.neighbour[f], f);
    }
  };
  visit([&](Index c, Index) { ++result.offset[c + 1]; });
  for (Index c = 0; c < n; ++c) result.offset[c + 1] += result.offset[c];
  result.index.resize(result.offset.back());
  std::vector<Index> next(result.offset.begin(), result.offset.end() - 1);
  visit([&](Index c, Index f) { result.index[next[c]++] = f; });
  return result;
}

}  // namespace

CellGradients::CellGradients(const Mesh& mesh, const ElasticOperator& rows) {
  const Csr faces = flux_faces_of_cells(mesh);
  const Geometry& g = mesh.reference;
  offset.reserve(faces.offset.size());
  node.reserve(faces.index.size());
  weight.reserve(faces.index.size());
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    Tensor3 m = Tensor3::Zero();
    if (mesh.dim == 2) m(2, 2) = 1;
    const std::size_t first = node.size(), first_mirror = mirrors.size();
    const auto add = [&](const Vec3& d) {
      const double w = std::pow(d.squaredNorm(), -1.5);
      // Scaled to numbers of order one, so that the zz entry of a plane mesh does not matter.
      m += w * d * d.transpose();
      return Vec3(w * d);
    };
    double scale = 0;
    for (const Index f : faces[c]) {
      if (f < mesh.n_interior) {
        const Index other = mesh.owner[f] == c ? mesh.neighbour[f] : mesh.owner[f];
        node.push_back(other);
        weight.push_back(add(g.cell_centre[other] - g.cell_centre[c]));
      } else if (rows.condition(f) == ElasticCondition::symmetry) {
        const Vec3 n = g.face_area[f].normalized();
        mirrors.push_back({c, add(2 * n.dot(g.face_centre[f] - g.cell_centre[c]) * n), n});
      } else {
        node.push_back(mesh.cells.n_local() + f - mesh.n_interior);
        weight.push_back(add(g.face_centre[f] - g.cell_centre[c]));
      }
      scale = m.trace();
    }
    if (mesh.dim == 2) m(2, 2) = scale;
    const Tensor3 inverse = m.inverse();
    for (std::size_t i = first; i < weight.size(); ++i) weight[i] = inverse * weight[i];
    for (std::size_t i = first_mirror; i < mirrors.size(); ++i)
      mirrors[i].weight = inverse * mirrors[i].weight;
    offset.push_back(static_cast<Index>(node.size()));
  }
}

FaceEdges::FaceEdges(const Mesh& mesh, const ElasticOperator& rows) {
  struct Slot {
    Index to, face, place;
    bool triangle;
  };
  // Edges in the rows of their smaller point, so that neighbours in space are neighbours in memory.
  const Index n_points = mesh.points.n_local(), n_faces = n_faces_with_force(mesh);
  std::vector<Index> offset(n_points + 1, 0);
  const auto visit = [&](auto&& take) {
    for (Index f = 0; f < n_faces; ++f) {
      const auto p = mesh.face_points[f];
      for (std::size_t i = 0; i < p.size(); ++i) {
        const Index a = p[i], b = p[(i + 1) % p.size()];
        take(std::min(a, b), Slot{std::max(a, b), f, static_cast<Index>(i), p.size() == 3});
      }
    }
  };
  visit([&](Index from, const Slot&) { ++offset[from + 1]; });
  for (Index v = 0; v < n_points; ++v) offset[v + 1] += offset[v];
  std::vector<Slot> slots(offset.back());
  std::vector<Index> next(offset.begin(), offset.end() - 1);
  visit([&](Index from, const Slot& slot) { slots[next[from]++] = slot; });

  // Known vertices have no gradient, those between materials several.
  std::vector<std::uint8_t> uncorrected(n_points, 0);
  for (Index v = 0; v < n_points; ++v) uncorrected[v] = rows.constraints().is_fixed(v);
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f)
    if (rows.condition(f) == ElasticCondition::bonded)
      for (const Index v : mesh.face_points[f]) uncorrected[v] = 1;

  of_face.assign(n_faces, {});
  const auto kind_of = [&](Index from, const Slot& slot) {
    if (uncorrected[from] || uncorrected[slot.to]) return plain;
    return slot.triangle ? mean : middle;
  };
  for (const int kind : {middle, mean, plain}) {
    for (Index v = 0; v < n_points; ++v) {
      const auto first_edge = static_cast<Index>(points.size());
      for (Index s = offset[v]; s < offset[v + 1]; ++s) {
        const Slot& slot = slots[s];
        if (kind_of(v, slot) != kind) continue;
        Index edge = first_edge;
        while (edge < std::ssize(points) && points[edge][1] != slot.to) ++edge;
        if (edge == std::ssize(points)) points.push_back({v, slot.to});
        of_face[slot.face][slot.place] = edge;
      }
    }
    if (kind != plain) end[kind] = static_cast<Index>(points.size());
  }
  for (Index f = 0; f < n_faces; ++f)
    if (mesh.face_points[f].size() == 3) of_face[f][3] = of_face[f][2];
}

std::vector<MirrorVertex> mirror_vertices(const Mesh& mesh, const ElasticOperator& rows,
                                          const std::vector<Index>& points) {
  std::vector<Index> place(mesh.points.n_local(), -1);
  std::vector<MirrorVertex> result;
  for (const Index v : points) {
    if (!rows.vertices().on_symmetry(v)) continue;
    place[v] = static_cast<Index>(result.size());
    result.push_back({v, {}});
  }
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) {
    if (rows.condition(f) != ElasticCondition::symmetry) continue;
    const Vec3 n = mesh.reference.face_area[f].normalized();
    for (const Index v : mesh.face_points[f]) {
      if (place[v] < 0) continue;
      auto& normals = result[place[v]].normals;
      if (std::ranges::none_of(normals, [&](const Vec3& m) { return std::abs(m.dot(n)) > same_plane; }))
        normals.push_back(n);
    }
  }
  return result;
}

}  // namespace couplet
