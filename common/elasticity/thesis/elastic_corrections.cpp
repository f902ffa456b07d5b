// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/thesis/elastic_corrections.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/fv/vertex_interpolation.hpp"

namespace couplet::elastic {
namespace {

// Normals of a symmetry patch within about 2 degrees belong to one plane.
constexpr double same_plane = 0.9994;
// Limit above the value at the edge of hexahedra (9), see VertexInterpolation::magnification.
constexpr double most_magnified = 10;

}  // namespace

CellGradients::CellGradients(const mesh::Mesh& mesh, const ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  const mesh::Csr faces = fv::flux_faces_of_cells(mesh);
  offset.reserve(faces.offset.size());
  node.reserve(faces.index.size());
  weight.reserve(faces.index.size());
  inverse.reserve(mesh.cells.n_owned());
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const std::size_t first_mirror = mirrors.size();
    std::vector<Vec3> line;
    double shortest = std::numeric_limits<double>::max();
    const auto mirrored = [&](Index f) {
      const Vec3 n = geometry.face_area[f].normalized();
      return Vec3(2 * n.dot(geometry.face_centre[f] - geometry.cell_centre[c]) * n);
    };
    for (const Index f : faces[c]) {
      if (f < mesh.n_interior)
        line.push_back(geometry.cell_centre[mesh.owner[f] == c ? mesh.neighbour[f] : mesh.owner[f]] -
                       geometry.cell_centre[c]);
      else if (rows.mirrored(f))
        line.push_back(mirrored(f));
      else
        line.push_back(geometry.face_centre[f] - geometry.cell_centre[c]);
      shortest = std::min(shortest, line.back().norm());
    }
    Tensor3 m = Tensor3::Zero();
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Index f = faces[c][i];
      const auto w = static_cast<float>(std::pow(shortest / line[i].norm(), 3));
      m += w * line[i] * line[i].transpose();
      if (rows.mirrored(f)) {
        mirrors.push_back({c, w * line[i], geometry.face_area[f].normalized()});
        continue;
      }
      node.push_back(f >= mesh.n_interior ? mesh.cells.n_local() + f - mesh.n_interior
                     : mesh.owner[f] == c ? mesh.neighbour[f]
                                          : mesh.owner[f]);
      weight.push_back(w);
    }
    // The zz entry is irrelevant for a plane mesh.
    if (mesh.dim == 2) m(2, 2) = m.trace();
    const Tensor3 back = m.inverse();
    inverse.push_back({back(0, 0), back(0, 1), back(0, 2), back(1, 1), back(1, 2), back(2, 2)});
    for (std::size_t i = first_mirror; i < mirrors.size(); ++i) mirrors[i].weight = back * mirrors[i].weight;
    offset.push_back(static_cast<Index>(node.size()));
  }
}

std::vector<std::uint32_t> edge_kinds(const mesh::Mesh& mesh, const ElasticOperator& rows) {
  // Known vertices have no gradient, and those between materials have several.
  std::vector<std::uint8_t> uncorrected(mesh.points.n_local(), 0);
  for (Index v = 0; v < mesh.points.n_local(); ++v) uncorrected[v] = rows.constraints().is_fixed(v);
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f)
    if (rows.at(f).shared)
      for (const Index v : mesh.face_points[f]) uncorrected[v] = 1;
  std::vector<std::uint32_t> kinds(n_faces_with_force(mesh), 0);
  for (std::size_t f = 0; f < kinds.size(); ++f) {
    const auto p = mesh.face_points[static_cast<Index>(f)];
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (uncorrected[p[i]] || uncorrected[p[(i + 1) % p.size()]]) continue;
      const EdgeKind kind = p.size() == 3 ? EdgeKind::mean : EdgeKind::middle;
      kinds[f] |= static_cast<std::uint32_t>(kind) << (2 * i);
    }
  }
  return kinds;
}

std::vector<Index> plain_points(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                const std::vector<Index>& points) {
  std::vector<Index> result;
  for (const Index v : points)
    if (mesh.is_wide(v) ||
        fv::VertexInterpolation::magnification(rows.vertices().weights(v)) > most_magnified)
      result.push_back(v);
  return result;
}

std::vector<MirrorVertex> mirror_vertices(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                          const std::vector<Index>& points) {
  const mesh::Geometry& geometry = rows.geometry();
  std::vector<Index> place(mesh.points.n_local(), -1);
  std::vector<MirrorVertex> result;
  for (const Index v : points) {
    if (!rows.vertices().on_symmetry(v)) continue;
    place[v] = static_cast<Index>(result.size());
    result.push_back({v, {}});
  }
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) {
    if (!rows.mirrored(f)) continue;
    const Vec3 n = geometry.face_area[f].normalized();
    for (const Index v : mesh.face_points[f]) {
      if (place[v] < 0) continue;
      auto& normals = result[place[v]].normals;
      if (std::ranges::none_of(normals, [&](const Vec3& m) { return std::abs(m.dot(n)) > same_plane; }))
        normals.push_back(n);
    }
  }
  return result;
}

}  // namespace couplet::elastic
