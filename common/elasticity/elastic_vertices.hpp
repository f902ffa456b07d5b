// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {

/// Which vertices a kernel interpolates and which it constrains: u_V = F_V sum_i w_i u_i + g_V.
class ElasticVertices {
 public:
  std::vector<Index> free;         ///< points whose nodes matter
  std::vector<Index> constrained;  ///< points with F_V other than I; those that are not free have F_V = 0

  ElasticVertices(const mesh::Mesh& mesh, const ElasticOperator& rows) : rows_(&rows) {
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      if (rows.constraints().is_constrained(v)) constrained.push_back(v);
      if (!rows.constraints().is_fixed(v) && !rows.vertices().nodes(v).empty()) free.push_back(v);
    }
    free.shrink_to_fit();
  }

  /// take(point) for all points that have a value.
  template <class Take>
  void visit(const Take& take) const {
    for (const Index v : free) take(v);
    for (const Index v : constrained) take(v);
  }

  /// Applies F_V and g_V to the values, `stride` doubles a point, whose first D are the displacement.
  template <int D>
  void constrain(std::span<double> values, int stride, std::span<const double> known) const {
    const VertexConstraints& constraints = rows_->constraints();
    for (const Index v : constrained) {
      Eigen::Map<Vec<D>> u(values.data() + std::size_t(v) * stride);
      u = (constraints.free_part(v).topLeftCorner<D, D>() * u).eval();
      const Index column = constraints.column(v);
      if (column >= 0 && !known.empty())
        u += Eigen::Map<const Vec<D>>(known.data() + std::size_t(column) * D);
    }
  }

 private:
  const ElasticOperator* rows_;
};

}  // namespace couplet::elastic
