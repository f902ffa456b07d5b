// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/surface_pressure.hpp"

namespace couplet::elastic {

/// Geometric stiffness of the symmetric gradient without a matrix: v . K_sigma v = sum_f V_f sigma_f : G_f^T
/// G_f. Triangles share it with their edges (SharedEdges). It includes the tangent of the loads.
class StressStiffness {
 public:
  /// Keeps references to mesh and rows, and the needed parts of `of`. Collective.
  StressStiffness(const mesh::Mesh& mesh, const ElasticOperator& rows, Prestress of);
  /// Computes y = K_sigma x on the rows of ElasticOperator. Collective.
  void apply(std::span<const double> x, std::span<double> y);

 private:
  template <int D>
  void push(const FaceGroup& group);
  void push_edges();

  SymmetricSpace space_;
  std::vector<FaceGroup> groups_;
  std::unique_ptr<SharedEdges> edges_;
  std::vector<Tensor3> edge_stress_;
  std::vector<double> edge_value_;
  Prestress of_;
};

}  // namespace couplet::elastic
