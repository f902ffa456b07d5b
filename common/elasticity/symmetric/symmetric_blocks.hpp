// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/lanes.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"

namespace couplet::elastic {

/// Four faces side by side: the kernels' arithmetic is on one number of each at a time.
template <int D>
struct BlockGeometry {
  static constexpr int width = 4;
  using Wide [[gnu::vector_size(32)]] = double;
  double vector[D][D][width];                          ///< S, c_0 (, c_1): components of each face
  std::array<Index, width> from, to;                   ///< nodes
  std::array<Index, width> plus[D - 1], minus[D - 1];  ///< points
};

/// With Hooke's law.
template <int D>
struct FaceBlock : BlockGeometry<D> {
  double mu[4], lambda[4];  ///< Lame's constants times V / (S . d)^2
};

/// In place of Hooke's isotropic law: the upper triangle of the elastic matrix times V / (S . d)^2, row by row; in the
/// plane that of xx, yy, xy.
template <int D>
struct ElasticBlock {
  static constexpr int size = D == 3 ? 6 : 3;
  double c[size * (size + 1) / 2][4];
};

namespace blocks {

template <int D>
using Wide = typename BlockGeometry<D>::Wide;

[[gnu::always_inline]] inline lanes::Lane<3> wide(const double* from) { return lanes::load<3>(from); }

/// Four nodes' vectors as components, each over the four faces.
template <int D>
[[gnu::always_inline]] inline void gather(const double* values, const std::array<Index, 4>& at,
                                          lanes::Lane<3> (&to)[D]) {
  using V = lanes::Lane<3>;
  if constexpr (D == 3) {
    const V a = wide(values + std::size_t(at[0]) * 4), b = wide(values + std::size_t(at[1]) * 4),
            c = wide(values + std::size_t(at[2]) * 4), d = wide(values + std::size_t(at[3]) * 4);
    const V ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
    const V y = __builtin_shufflevector(a, b, 1, 5, 3, 7), w = __builtin_shufflevector(c, d, 1, 5, 3, 7);
    to[0] = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
    to[1] = __builtin_shufflevector(y, w, 0, 1, 4, 5);
    to[2] = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
  } else {
    for (int a = 0; a < D; ++a) {
      const double of_faces[4] = {values[std::size_t(at[0]) * 2 + a], values[std::size_t(at[1]) * 2 + a],
                                  values[std::size_t(at[2]) * 2 + a], values[std::size_t(at[3]) * 2 + a]};
      to[a] = wide(of_faces);
    }
  }
}

/// The components of four faces as vectors.
[[gnu::always_inline]] inline void transpose(const lanes::Lane<3> (&from)[3], lanes::Lane<3> (&to)[4]) {
  using V = lanes::Lane<3>;
  const V zero{};
  const V low = __builtin_shufflevector(from[0], from[1], 0, 4, 2, 6);  // x0 y0 x2 y2
  const V high = __builtin_shufflevector(from[0], from[1], 1, 5, 3, 7);
  const V z = __builtin_shufflevector(from[2], zero, 0, 4, 2, 6);
  const V zh = __builtin_shufflevector(from[2], zero, 1, 5, 3, 7);
  to[0] = __builtin_shufflevector(low, z, 0, 1, 4, 5);
  to[1] = __builtin_shufflevector(high, zh, 0, 1, 4, 5);
  to[2] = __builtin_shufflevector(low, z, 2, 3, 6, 7);
  to[3] = __builtin_shufflevector(high, zh, 2, 3, 6, 7);
}

/// values[plus] += force, values[minus] -= force, of each of the four.
template <int D>
[[gnu::always_inline]] inline void scatter(double* values, const std::array<Index, 4>& plus,
                                           const std::array<Index, 4>& minus,
                                           const lanes::Lane<3> (&force)[D]) {
  if constexpr (D == 3) {
    lanes::Lane<3> of[4];
    transpose(force, of);
    for (int k = 0; k < 4; ++k) {
      lanes::add<3>(values + std::size_t(plus[k]) * 4, of[k]);
      lanes::add<3>(values + std::size_t(minus[k]) * 4, -of[k]);
    }
  } else {
    for (int k = 0; k < 4; ++k)
      for (int a = 0; a < D; ++a) {
        values[std::size_t(plus[k]) * 2 + a] += force[a][k];
        values[std::size_t(minus[k]) * 2 + a] -= force[a][k];
      }
  }
}

/// u_Q - u_P, then u_plus - u_minus, by components.
template <int D>
[[gnu::always_inline]] inline void differences(const BlockGeometry<D>& block, const double* nodes,
                                               const double* points, lanes::Lane<3> (&u)[D][D]) {
  lanes::Lane<3> other[D];
  gather<D>(nodes, block.to, u[0]);
  gather<D>(nodes, block.from, other);
  for (int a = 0; a < D; ++a) u[0][a] -= other[a];
  for (int i = 0; i < D - 1; ++i) {
    gather<D>(points, block.plus[i], u[i + 1]);
    gather<D>(points, block.minus[i], other);
    for (int a = 0; a < D; ++a) u[i + 1][a] -= other[a];
  }
}

/// H = (u_Q - u_P) S^T + sum_i (u_plus - u_minus) c_i^T, entry (k, j) of the displacement's component k.
template <int D>
[[gnu::always_inline]] inline void stretch(const BlockGeometry<D>& block, const double* nodes,
                                           const double* points, lanes::Lane<3> (&h)[D][D]) {
  lanes::Lane<3> u[D][D];
  differences<D>(block, nodes, points, u);
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      h[a][b] = u[0][a] * wide(block.vector[0][b]);
      for (int k = 1; k < D; ++k) h[a][b] += u[k][a] * wide(block.vector[k][b]);
    }
}

/// The forces that belong to difference k of differences().
template <int D>
[[gnu::always_inline]] inline void pull(const BlockGeometry<D>& block, int k,
                                        const lanes::Lane<3> (&force)[D], double* nodes, double* points) {
  if (k == 0)
    scatter<D>(nodes, block.to, block.from, force);
  else
    scatter<D>(points, block.plus[k - 1], block.minus[k - 1], force);
}

/// The forces of a stress (times V / (S . d)) on nodes and points: dE/du.
template <int D>
[[gnu::always_inline]] inline void push(const BlockGeometry<D>& block, const lanes::Lane<3> (&stress)[D][D],
                                        double* nodes, double* points) {
  for (int k = 0; k < D; ++k) {
    lanes::Lane<3> force[D];
    for (int a = 0; a < D; ++a) {
      force[a] = stress[a][0] * wide(block.vector[k][0]);
      for (int b = 1; b < D; ++b) force[a] += stress[a][b] * wide(block.vector[k][b]);
    }
    pull<D>(block, k, force, nodes, points);
  }
}

/// V / (S . d) sigma of H.
template <int D>
[[gnu::always_inline]] inline void hooke(const FaceBlock<D>& block, const lanes::Lane<3> (&h)[D][D],
                                         lanes::Lane<3> (&stress)[D][D]) {
  const lanes::Lane<3> mu = wide(block.mu);
  lanes::Lane<3> trace = h[0][0];
  for (int a = 1; a < D; ++a) trace += h[a][a];
  trace *= wide(block.lambda);
  for (int a = 0; a < D; ++a) {
    for (int b = a; b < D; ++b) {
      stress[a][b] = mu * (h[a][b] + h[b][a]);
      stress[b][a] = stress[a][b];
    }
    stress[a][a] += trace;
  }
}

/// The same with a matrix.
template <int D>
[[gnu::always_inline]] inline void elastic(const ElasticBlock<D>& block, const lanes::Lane<3> (&h)[D][D],
                                           lanes::Lane<3> (&stress)[D][D]) {
  constexpr int n = ElasticBlock<D>::size;
  constexpr int first[6] = {0, 1, D == 3 ? 2 : 0, 0, 1, 0}, second[6] = {0, 1, D == 3 ? 2 : 1, 1, 2, 2};
  lanes::Lane<3> strain[n], s[n];
  for (int k = 0; k < n; ++k) {
    const int i = first[k], j = second[k];
    strain[k] = k < D ? h[i][j] : h[i][j] + h[j][i];
    s[k] = lanes::Lane<3>{};
  }
  for (int i = 0, at = 0; i < n; ++i)
    for (int j = i; j < n; ++j, ++at) {
      const lanes::Lane<3> c = wide(block.c[at]);
      s[i] += c * strain[j];
      if (j != i) s[j] += c * strain[i];
    }
  for (int k = 0; k < n; ++k) stress[first[k]][second[k]] = stress[second[k]][first[k]] = s[k];
}

}  // namespace blocks

/// The blocks of these faces in their order; the last one is filled up with faces without area between the
/// first node and itself. `n_cells`: nodes before those of the boundary.
template <int D>
std::vector<FaceBlock<D>> make_blocks(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                      std::span<const Index> faces);

/// Their elastic matrices; none where the body has none.
template <int D>
std::vector<ElasticBlock<D>> make_elastic_blocks(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                 std::span<const Index> faces);

/// Puts face f into place k of a block, or, as filling, without area.
template <int D>
void set_geometry(const mesh::Mesh& mesh, const SymmetricFace<D>& face, Index f, std::size_t k,
                  bool is_filling, BlockGeometry<D>& block);

}  // namespace couplet::elastic
