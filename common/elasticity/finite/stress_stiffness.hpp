// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/symmetric/face_groups.hpp"
#include "common/elasticity/symmetric/surface_pressure.hpp"

namespace couplet::elastic {

/// Geometric stiffness of the symmetric gradient without a matrix: v . K_sigma v = sum_f V_f sigma_f : G_f^T
/// G_f. Triangles share it with their edges (SharedEdges). It includes the tangent of the loads.
class StressStiffness {
 public:
  /// Own part of V sigma of four faces, entries as in SharedEdges.
  using FaceStress = std::array<std::array<double, 4>, SharedEdges::size>;

  /// Keeps references to mesh and rows. Collective.
  StressStiffness(const mesh::Mesh& mesh, const ElasticOperator& rows, Prestress of);
  /// Computes y = K_sigma x on the rows of ElasticOperator. Collective.
  void apply(std::span<const double> x, std::span<double> y);

 private:
  struct StressGroup : FaceGroup {
    std::vector<FaceStress> stress;
  };
  void push_edges();

  SymmetricSpace space_;
  std::vector<StressGroup> groups_;
  std::unique_ptr<SharedEdges> edges_;
  std::vector<Tensor3> edge_stress_;
  std::vector<double> edge_value_;
  std::vector<PlaceBlock> loads_;
};

}  // namespace couplet::elastic
