// SPDX-License-Identifier: Apache-2.0
// Surfaces for tests of mappings, with the corners of their faces.
#pragma once

#include "common/coupling/participant.hpp"
#include "coupler/mapping/links.hpp"
#include "tests/support/test.hpp"

namespace couplet::tests {

inline void add_face(coupling::Interface& s, std::vector<Index> corners, const Vec3& area) {
  Vec3 centre = Vec3::Zero();
  for (const Index v : corners) centre += s.vertices[v] / double(corners.size());
  if (s.face_offset.empty()) s.face_offset.push_back(0);
  s.face_vertices.insert(s.face_vertices.end(), corners.begin(), corners.end());
  s.face_offset.push_back(Index(s.face_vertices.size()));
  s.face_centres.push_back(centre);
  s.face_areas.push_back(area);
}

/// The three wetted sides of a flap of 0.1 x 1 m: up, across, down. `sign` 1: areas out of the flap. `shift`
/// moves the vertices within the sides along them, by that share of an edge.
inline coupling::Interface flap(int along, int across, double sign, double shift = 0) {
  coupling::Interface s;
  s.dim = 2;
  const auto at = [&](int i, int n) { return (i == 0 || i == n ? i : i + shift) / double(n); };
  for (int i = 0; i <= along; ++i) s.vertices.emplace_back(0, at(i, along), 0);
  for (int i = 1; i <= across; ++i) s.vertices.emplace_back(0.1 * at(i, across), 1, 0);
  for (int i = 1; i <= along; ++i) s.vertices.emplace_back(0.1, 1 - at(i, along), 0);
  for (Index v = 0; v + 1 < Index(s.vertices.size()); ++v) {
    const Vec3 edge = s.vertices[v + 1] - s.vertices[v];
    add_face(s, {v, v + 1}, sign * Vec3(-edge.y(), edge.x(), 0));
  }
  return s;
}

/// The unit circle by n edges; areas outwards.
inline coupling::Interface ring(int n) {
  coupling::Interface s;
  s.dim = 2;
  const auto angle = [n](double i) { return 2 * std::numbers::pi * i / n; };
  for (int i = 0; i < n; ++i) s.vertices.emplace_back(std::cos(angle(i)), std::sin(angle(i)), 0);
  for (Index i = 0; i < n; ++i)
    add_face(
        s, {i, (i + 1) % n},
        2 * std::sin(std::numbers::pi / n) * Vec3(std::cos(angle(i + 0.5)), std::sin(angle(i + 0.5)), 0));
  return s;
}

/// (0, 2) x (0, 1) at height `z`, n quadrilaterals on a length of 1, or each cut into two triangles; areas
/// along sign z.
inline coupling::Interface plate(int n, bool triangles, double sign, double z = 0) {
  coupling::Interface s;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= 2 * n; ++i) s.vertices.emplace_back(i / double(n), j / double(n), z);
  const Vec3 area(0, 0, sign / (double(n) * n));
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < 2 * n; ++i) {
      const Index a = j * (2 * n + 1) + i, b = a + 1, c = b + 2 * n + 1, d = a + 2 * n + 1;
      if (triangles)
        add_face(s, {a, b, c}, area / 2), add_face(s, {a, c, d}, area / 2);
      else
        add_face(s, {a, b, c, d}, area);
    }
  return s;
}

/// This rank's part of a whole surface, cut evenly; vertices and faces each their own way.
inline coupling::Interface part_of(MPI_Comm world, const coupling::Interface& whole) {
  const auto rank = std::size_t(parallel::comm_rank(world));
  const coupling::Starts v = coupling::even_starts(GlobalIndex(whole.vertices.size()),
                                                   parallel::comm_size(world)),
                         f = coupling::even_starts(GlobalIndex(whole.face_centres.size()),
                                                   parallel::comm_size(world));
  coupling::Interface part;
  part.dim = whole.dim;
  part.takes = whole.takes, part.gives = whole.gives;
  part.vertices.assign(whole.vertices.begin() + v[rank], whole.vertices.begin() + v[rank + 1]);
  part.face_centres.assign(whole.face_centres.begin() + f[rank], whole.face_centres.begin() + f[rank + 1]);
  part.face_areas.assign(whole.face_areas.begin() + f[rank], whole.face_areas.begin() + f[rank + 1]);
  if (!whole.face_offset.empty()) part.face_offset.push_back(0);
  for (GlobalIndex face = f[rank]; face < f[rank + 1] && !whole.face_offset.empty(); ++face) {
    part.face_vertices.insert(part.face_vertices.end(), whole.face_vertices.begin() + whole.face_offset[face],
                              whole.face_vertices.begin() + whole.face_offset[face + 1]);
    part.face_offset.push_back(Index(part.face_vertices.size()));
  }
  return part;
}

inline coupler::PointSet vertices_of(const coupling::Interface& s) {
  return {"vertices", s.vertices, {}, &s};
}
inline coupler::PointSet faces_of(const coupling::Interface& s) {
  coupler::PointSet set{"faces", s.face_centres, {}, &s};
  set.place = coupling::Interface::Place::faces;
  for (const Vec3& area : s.face_areas) set.sizes.push_back(area.norm());
  return set;
}

}  // namespace couplet::tests
