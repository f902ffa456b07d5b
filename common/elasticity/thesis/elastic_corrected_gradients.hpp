// SPDX-License-Identifier: Apache-2.0
// Passes of CorrectedKernel over cells and vertices: their values and gradients. Those over faces are in elastic_kernel_corrected.cpp.
#pragma once

#include "common/elasticity/thesis/elastic_corrected_kernel.hpp"

namespace couplet::elastic::corrected {

/// Gradient rows and q of a node at `place`.
template <int D>
template <class Take>
inline void CorrectedKernel<D>::set_record(Index node, const Vec3& place, const Take& row) {
  Lane<D> q = load<D>(nodes_[node]);
  Rows<D> gradient;
  for (int i = 0; i < D; ++i) {
    gradient.row[i] = row(i);
    q -= 0.5 * (place[i] - origin_[i]) * gradient.row[i];
  }
  store_record<D>(cell(node), q, gradient);
}

template <int D>
inline void CorrectedKernel<D>::find_cell_gradients() {
  const Index* offset = gradients_.offset.data();
  const Index* node = gradients_.node.data();
  const float* weight = gradients_.weight.data();
  const Vec3* centre = geometry_.cell_centre.data();
  const Index n_cells = mesh_.cells.n_local();
  const Vec3* outside = geometry_.face_centre.data() + mesh_.n_interior;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Lane<D> here = load<D>(nodes_[c]);
    Rows<D> sum;
    for (Index i = offset[c]; i < offset[c + 1]; ++i) {
      const Lane<D> difference = weight[i] * (load<D>(nodes_[node[i]]) - here);
      const Vec3& there = node[i] < n_cells ? centre[node[i]] : outside[node[i] - n_cells];
      for (int a = 0; a < D; ++a) sum.row[a] += (there[a] - centre[c][a]) * difference;
    }
    const auto& m = gradients_.inverse[c];
    Rows<D> g;
    if constexpr (D == 2) {
      g.row[0] = m[0] * sum.row[0] + m[1] * sum.row[1];
      g.row[1] = m[1] * sum.row[0] + m[3] * sum.row[1];
    } else {
      g.row[0] = m[0] * sum.row[0] + m[1] * sum.row[1] + m[2] * sum.row[2];
      g.row[1] = m[1] * sum.row[0] + m[3] * sum.row[1] + m[4] * sum.row[2];
      g.row[2] = m[2] * sum.row[0] + m[4] * sum.row[1] + m[5] * sum.row[2];
    }
    set_record(
        c, centre[c], [&](int a) __attribute__((always_inline)) { return g.row[a]; });
  }
  for (const auto& mirror : gradients_.mirrors) {
    double* here = cell(mirror.cell);
    const Lane<D> u = load<D>(nodes_[mirror.cell]);
    double normal = 0, reach = 0;
    for (int a = 0; a < D; ++a) {
      normal += mirror.normal[a] * u[a];
      reach += mirror.weight[a] * (geometry_.cell_centre[mirror.cell][a] - origin_[a]);
    }
    for (int b = 0; b < D; ++b) {
      const double difference = -2 * normal * mirror.normal[b];
      here[b] -= 0.5 * reach * difference;
      for (int a = 0; a < D; ++a) here[(a + 1) * D + b] += mirror.weight[a] * difference;
    }
  }
}

template <int D>
inline void CorrectedKernel<D>::find_vertices(std::span<const Index> points) {
  for (const Index v : points) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Lane<D> u = {};
    Rows<D> g;
    for (std::size_t i = 0; i < index.size(); ++i) {
      const double* node = cell(index[i]);
      const double w = weight[i];
      u += w * load<D>(node);
      for (int a = 0; a < D; ++a) g.row[a] += w * row_of<D>(node, a);
    }
    const Vec3& x = geometry_.points[v];
    for (int a = 0; a < D; ++a) u += 0.5 * (x[a] - origin_[a]) * g.row[a];
    store_record<D>(vertex(v), u, g);
  }
}

// u = sum w u_i, exact for linear fields.
template <int D>
void CorrectedKernel<D>::plain_vertices() {
  for (const Index v : plain_points_) {
    const auto index = rows_.vertices().nodes(v);
    const auto weight = rows_.vertices().weights(v);
    Lane<D> u = {};
    for (std::size_t i = 0; i < index.size(); ++i) u += weight[i] * load<D>(nodes_[index[i]]);
    lanes::store_components<D>(vertex(v), u);
  }
}

// On a symmetry plane: the mean of the gradient and its mirror image, G - NG -
// GN + 2 NGN with N = n n^T.
template <int D>
void CorrectedKernel<D>::mirror_vertex_gradients() {
  for (const MirrorVertex& mirror : mirrors_) {
    double* here = vertex(mirror.point);
    for (const Vec3& normal : mirror.normals) {
      const Vec<D> n = normal.head<D>();
      Tensor<D> g;
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) g(a, b) = here[(a + 1) * D + b];
      const Vec<D> right = g * n, left = g.transpose() * n;
      g += n * (2 * n.dot(right) * n - left).transpose() - right * n.transpose();
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b) here[(a + 1) * D + b] = g(a, b);
    }
  }
}

}  // namespace couplet::elastic::corrected
