// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/fv/gradients.hpp"
#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Published face gradient, thesis (2.53)-(2.58): least squares at the vertices, and the matrix that
/// ElasticOperator assembles with it. An empty `known` stands for zeros; all functions are collective.
class LeastSquares {
 public:
  /// Keeps references. The configuration is that of `rows`.
  LeastSquares(const mesh::Mesh& mesh, const ElasticOperator& rows)
      : mesh_(mesh),
        rows_(rows),
        nodes_(mesh, rows),
        vertices_(mesh, rows),
        gradient_(mesh, rows.geometry()),
        points_(std::size_t(mesh.points.n_local()) * std::size_t(mesh.dim), 0.0) {}

  /// Sets result = A u + K known. Assembles the matrix on first use.
  void apply(std::span<const double> unknowns, std::span<const double> known, std::span<double> result);
  /// Calls take(face, gradient) for the flux faces [first, end), entry (i, j) = d u_j / d x_i.
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const std::function<void(Index, const Tensor3&)>& take, Index first, Index end);
  /// Interpolates dim values per local point. Points without an owned cell are not changed.
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points);

 private:
  template <int D>
  void find_points(std::span<const double> unknowns, std::span<const double> known);
  template <int D>
  Tensor3 gradient(Index f) const;

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  ElasticNodes nodes_;
  ElasticVertices vertices_;
  fv::FaceGradient gradient_;
  std::vector<double> points_;  // displacement, dim values per local point
  std::optional<linalg::SparseMatrix> matrix_;
};

}  // namespace couplet::elastic
