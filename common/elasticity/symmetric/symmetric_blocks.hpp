// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "common/elasticity/lanes.hpp"
#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// Rows of four faces for SIMD arithmetic. All indices are locations.
struct FaceBlock {
  double b[3][3][4];                       ///< of the neighbor node, plus_0 (, plus_1): see FaceRows
  std::array<Index, 4> plus[3], minus[3];  ///< neighbor and owner nodes, then points
};

/// Volumes of four faces. Padding has none.
struct FaceVolumes {
  double whole[4];           ///< V [m^3]
  double here[4], there[4];  ///< V_fP of both sides over V
  Index face[4];             ///< -1 for padding
};

/// Faces that a rank computes, in blocks in their order. The last block is padded.
struct FaceGroup {
  std::vector<Index> faces;
  std::vector<FaceBlock> blocks;
  std::vector<FaceVolumes> volumes;
  double own = 1;                                          ///< share of their energy not assigned to edges
  std::vector<std::array<std::array<Index, 3>, 4>> edges;  ///< of each block; empty if nothing is shared
};

FaceGroup make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<Index> faces);

/// Group of this rank's flux faces with takes(f): those that share with `edges`, or the others if nullptr.
template <class Takes>
FaceGroup make_group(const mesh::Mesh& mesh, const ElasticOperator& rows, const SharedFaces& shared,
                     const SharedEdges* edges, const Takes& takes) {
  std::vector<Index> faces;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f)
    if (mesh.owner[f] < mesh.cells.n_owned() && takes(f) &&
        (mesh.dim == 3 && mesh.face_points[f].size() == 3) == (edges != nullptr))
      faces.push_back(f);
  FaceGroup group = make_group(mesh, rows, std::move(faces));
  if (!edges) return group;
  group.own = 1 - SharedEdges::share;
  group.edges.resize(group.blocks.size());
  const auto end = shared.faces.begin() + std::ptrdiff_t(shared.n_mine);
  for (std::size_t i = 0; i < group.edges.size() * 4; ++i) {
    const Index f = group.faces[std::min(i, group.faces.size() - 1)];
    const auto at = std::lower_bound(shared.faces.begin(), end, f) - shared.faces.begin();
    group.edges[i / 4][i % 4] = edges->edges_of(std::size_t(at));
  }
  return group;
}

namespace blocks {

[[gnu::always_inline]] inline Four wide(const double* from) { return lanes::load<3>(from); }

/// Gathers the vectors of four locations as components over the four faces.
template <int D>
[[gnu::always_inline]] inline void gather(const double* values, const std::array<Index, 4>& at,
                                          Four (&to)[D]) {
  if constexpr (D == 3) {
    const Four a = wide(values + std::size_t(at[0]) * 4), b = wide(values + std::size_t(at[1]) * 4),
               c = wide(values + std::size_t(at[2]) * 4), d = wide(values + std::size_t(at[3]) * 4);
    const Four ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    const Four y = __builtin_shufflevector(a, b, 1, 5, 3, 7), w = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    to[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(y, w, 0, 1, 4, 5);
    to[2] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  } else {
    for (int a = 0; a < D; ++a) {
      const double of_faces[4] = {values[std::size_t(at[0]) * 4 + a], values[std::size_t(at[1]) * 4 + a],
                                  values[std::size_t(at[2]) * 4 + a], values[std::size_t(at[3]) * 4 + a]};
      to[a] = wide(of_faces);
    }
  }
}

/// Converts the components of four faces to vectors.
[[gnu::always_inline]] inline void transpose(const Four (&from)[3], Four (&to)[4]) {
  const Four zero{};
  const Four low = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6);  // x0 y0 x2 y2
  const Four high = __builtin_shufflevector(from[0], from[1], 1, 5, 3, 7);
  const Four z = __builtin_shufflevector(from[2], zero, 0, 4, 2, 6);
  const Four zh = __builtin_shufflevector(from[2], zero, 1, 5, 3, 7);
  to[0] = __builtin_shufflevector(low, z, 0, 1, 4, 5);
  to[1] = __builtin_shufflevector(high, zh, 0, 1, 4, 5);
  to[2] = __builtin_shufflevector(low, z, 2, 3, 6, 7);
  to[3] = __builtin_shufflevector(high, zh, 2, 3, 6, 7);
}

/// Adds `force` at `plus` and subtracts it at `minus`, for each of the four faces.
template <int D>
[[gnu::always_inline]] inline void scatter(double* values, const std::array<Index, 4>& plus,
                                           const std::array<Index, 4>& minus, const Four (&force)[D]) {
  if constexpr (D == 3) {
    Four of[4];
    transpose(force, of);
    for (int k = 0; k < 4; ++k) {
      lanes::add<3>(values + std::size_t(plus[k]) * 4, of[k]);
      lanes::add<3>(values + std::size_t(minus[k]) * 4, -of[k]);
    }
  } else {
    for (int k = 0; k < 4; ++k)
      for (int a = 0; a < D; ++a) {
        values[std::size_t(plus[k]) * 4 + a] += force[a][k];
        values[std::size_t(minus[k]) * 4 + a] -= force[a][k];
      }
  }
}

/// Computes the gradient G, entry (k, j) = d u_k / d x_j.
template <int D>
[[gnu::always_inline]] inline void gradient(const FaceBlock& block, const double* values, Four (&g)[D][D]) {
  Four u[D][D], other[D];
  for (int i = 0; i < D; ++i) {
    gather<D>(values, block.plus[i], u[i]);
    gather<D>(values, block.minus[i], other);
    for (int a = 0; a < D; ++a) u[i][a] -= other[a];
  }
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      g[a][b] = u[0][a] * wide(block.b[0][b]);
      for (int k = 1; k < D; ++k) g[a][b] += u[k][a] * wide(block.b[k][b]);
    }
}

/// Adds the forces dE/du of a stress times V to nodes and points.
template <int D>
[[gnu::always_inline]] inline void push(const FaceBlock& block, const Four (&stress)[D][D], double* forces) {
  for (int k = 0; k < D; ++k) {
    Four force[D];
    for (int a = 0; a < D; ++a) {
      force[a] = stress[a][0] * wide(block.b[k][0]);
      for (int b = 1; b < D; ++b) force[a] += stress[a][b] * wide(block.b[k][b]);
    }
    scatter<D>(forces, block.plus[k], block.minus[k], force);
  }
}

/// Average of cell values, (V_fP p_P + V_fQ p_Q) / V.
[[gnu::always_inline]] inline Four between(const FaceBlock& block, const FaceVolumes& volumes,
                                           const double* of_nodes) {
  double here[4], there[4];
  for (int k = 0; k < 4; ++k) {
    here[k] = of_nodes[std::size_t(block.minus[0][k])];
    there[k] = of_nodes[std::size_t(block.plus[0][k])];
  }
  return wide(volumes.here) * wide(here) + wide(volumes.there) * wide(there);
}

/// Adds V_fP times the value of a face to its cells.
[[gnu::always_inline]] inline void add_to_cells(const FaceBlock& block, const FaceVolumes& volumes,
                                                const Four& value, double* of_nodes) {
  const Four whole = value * wide(volumes.whole);
  for (int k = 0; k < 4; ++k) {
    of_nodes[std::size_t(block.minus[0][k])] += volumes.here[k] * whole[k];
    of_nodes[std::size_t(block.plus[0][k])] += volumes.there[k] * whole[k];
  }
}

}  // namespace blocks

}  // namespace couplet::elastic
