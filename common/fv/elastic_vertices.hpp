// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/fv/elasticity.hpp"
#include "common/fv/lanes.hpp"

namespace couplet {

/// Which vertices a kernel interpolates, and their weights as one stream.
struct ElasticVertices {
  std::vector<Index> free;       ///< points with a row of weights; those on symmetry planes included
  std::vector<Index> on_planes;  ///< those on symmetry planes
  std::vector<Index> known;      ///< prescribed points

  ElasticVertices(const Mesh& mesh, const ElasticOperator& rows) : known(rows.prescribed_points()) {
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      if (rows.known_of_point(v) >= 0 || rows.vertices().nodes(v).empty()) continue;
      free.push_back(v);
      if (rows.vertices().on_symmetry(v)) on_planes.push_back(v);
    }
  }
};

/// sum_i w_i value_i for these points: `Lanes` lanes a record, records of `Stride` doubles.
template <int D, int Lanes, int Stride, int OutStride>
[[gnu::always_inline]] inline void interpolate_records(const VertexInterpolation& vertices,
                                                       std::span<const Index> points, const double* nodes,
                                                       double* out) {
  constexpr int width = lanes::width<D>;
  for (const Index v : points) {
    const auto index = vertices.nodes(v);
    const auto weight = vertices.weights(v);
    lanes::Lane<D> sum[Lanes] = {};
    for (std::size_t i = 0; i < index.size(); ++i) {
      const double* here = nodes + std::size_t(index[i]) * Stride;
      const double w = weight[i];
      for (int l = 0; l < Lanes; ++l) sum[l] += w * lanes::load<D>(here + l * width);
    }
    double* there = out + std::size_t(v) * OutStride;
    for (int l = 0; l < Lanes; ++l) lanes::store<D>(there + l * width, sum[l]);
  }
}

}  // namespace couplet
