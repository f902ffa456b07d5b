// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/linalg/component_multigrid.hpp"

namespace couplet::elastic {

/// Multigrid cycle x = V(b) with `components` values per cell. Collective.
using ComponentCycle = std::function<void(std::span<const double> b, std::span<double> x, int components)>;

/// Preconditioner of A with the symmetric face gradient and its mass, without a matrix. It applies a multigrid cycle to the two-point flux of
/// each component with coefficient |S| / (d . n) [mu + (mu + lambda) n_c^2] (diagonal of the compact block
/// operator). Unknowns of faces follow from u_B = K_B^-1 (r_B + C u_P).
class ElasticPreconditioner {
 public:
  struct Options {
    /// Inertia of the unknown nodes (owned cells, then faces) [N/m], or empty.
    std::span<const double> node_inertia = {};
    /// Preconditions the operator without the bulk modulus of cells, for the mixed form.
    bool without_cells_bulk = false;
    /// Creates another cycle than ComponentMultigrid's for comparison (benchmarks/linalg), or empty.
    std::function<ComponentCycle(linalg::ComponentMultigrid::Rows,
                                 const linalg::ComponentMultigrid::MultigridOptions&)>
        cycle = {};
  };
  ElasticPreconditioner(const mesh::Mesh& mesh, const ElasticOperator& rows, const Options& options);

  /// Computes z = M^-1 r. Collective.
  void apply(std::span<const double> r, std::span<double> z);

 private:
  /// Face unknown u_B = inverse r_B + cell u_P (+ other u_P' across a bonded face).
  struct FaceElimination {
    Tensor3 inverse, cell, other;
    Index owner, twin_owner;  // -1 if not bonded or on another rank
  };
  void find_face_rows(std::span<const double> node_inertia);
  void add_true_diagonal(std::span<const double> node_inertia);
  void solve_faces(std::span<const double> r, std::span<double> z) const;

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  const ElasticOperator* rows_;
  VolumeStrain left_out_;         // faces: the preconditioner is that of the whole operator
  std::vector<double> gathered_;  // right-hand side of the cycle
  std::vector<float> inverse_diagonal_;
  ComponentCycle cycle_;
  std::vector<FaceElimination> face_rows_;
};

}  // namespace couplet::elastic
