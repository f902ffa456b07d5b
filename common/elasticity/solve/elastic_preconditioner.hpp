// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/solve/rigid_coarse_space.hpp"
#include "common/linalg/component_multigrid.hpp"

namespace couplet::elastic {

/// x = V(b), `components` values a cell. Collective.
using ComponentCycle = std::function<void(std::span<const double> b, std::span<double> x, int components)>;

/// Preconditioner of diag(inertia) + A without A: the two-point flux of each component by itself, coefficient
/// |S| / (d . n) [mu + (mu + lambda) n_c^2] (the diagonal of the compact block operator), under a multigrid
/// cycle; the unknowns of faces from their own rows, u_B = K_B^-1 (r_B + C u_P); and, where asked for, the
/// rigid motions of aggregates, added, or taken first.
class ElasticPreconditioner {
 public:
  struct Options {
    FaceGradientScheme scheme = FaceGradientScheme::thesis;
    int n_aggregates = 0;  ///< of the rigid coarse space; 0: none
    /// The thesis's operator, kept by reference: the coarse space comes first and the cycle sees what it
    /// leaves. Costs one application and saves a third of the iterations. None: both are added.
    const ElasticKernel* between = nullptr;
    /// Of the symmetric operator: inertia of the unknown nodes, owned cells, then faces [N/m]; empty: none.
    std::span<const double> node_inertia = {};
    /// Of what is left of the symmetric operator without the bulk modulus of cells: of the mixed form.
    bool without_cells_bulk = false;
    /// What makes another cycle than ComponentMultigrid's, to compare them (benchmarks/linalg); empty: none.
    std::function<ComponentCycle(linalg::ComponentMultigrid::Rows,
                                 const linalg::ComponentMultigrid::Options&)>
        cycle = {};
  };
  /// Collective.
  ElasticPreconditioner(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const double> inertia,
                        const Options& options);

  /// z = M^-1 r. Collective.
  void apply(std::span<const double> r, std::span<double> z);
  const RigidCoarseSpace* coarse_space() const { return coarse_.get(); }

 private:
  /// u_B = inverse r_B + cell u_P (+ other u_P' across a bonded face).
  struct FaceRow {
    Tensor3 inverse, cell, other;
    Index owner, twin_owner;  // -1: not bonded, or the other cell is on another rank
  };
  void find_face_rows(double boundary_factor, std::span<const double> node_inertia);
  void add_true_diagonal(std::span<const double> node_inertia);
  void solve_faces(std::span<const double> r, std::span<double> z) const;
  void smooth(std::span<const double> r, std::span<double> z);
  void smooth_symmetric(std::span<const double> r, std::span<double> z);

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  const ElasticOperator* rows_;
  std::vector<double> inertia_;
  const ElasticKernel* between_;
  bool is_symmetric_;
  VolumeStrain left_out_;         // faces: the preconditioner is that of the whole operator
  std::vector<double> gathered_;  // of the symmetric form, as the next
  std::vector<float> inverse_diagonal_;
  ComponentCycle cycle_;
  std::vector<FaceRow> face_rows_;
  std::unique_ptr<RigidCoarseSpace> coarse_;
  std::vector<double> left_, smooth_;  // of the multiplicative form
};

}  // namespace couplet::elastic
