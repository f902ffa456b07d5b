// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/fv/elastic_kernel.hpp"
#include "common/fv/rigid_coarse_space.hpp"
#include "common/linalg/component_multigrid.hpp"

namespace couplet {

/// Preconditioner of diag(inertia) + A without A: the two-point flux of each component by itself, coefficient
/// |S| / (d . n) [mu + (mu + lambda) n_c^2] (the diagonal of the compact block operator), under a multigrid
/// cycle; the unknowns of open faces from u_B = u_P + K_B^-1 r_B, K_B their own block; and, where asked for,
/// the rigid motions of aggregates added.
class ElasticPreconditioner {
 public:
  /// `n_aggregates`: 0 for none. Collective.
  ElasticPreconditioner(const Mesh& mesh, const ElasticOperator& rows, std::span<const double> mu,
                        std::span<const double> lambda, std::span<const double> inertia,
                        FaceGradientScheme scheme, int n_aggregates);

  /// z = M^-1 r. Collective.
  void apply(std::span<const double> r, std::span<double> z);
  const RigidCoarseSpace* coarse_space() const { return coarse_.get(); }

 private:
  const Mesh* mesh_;
  const ElasticOperator* rows_;
  std::unique_ptr<ComponentMultigrid> multigrid_;
  std::vector<Tensor3> inverse_own_;  // K_B^-1 of each open face
  std::unique_ptr<RigidCoarseSpace> coarse_;
};

}  // namespace couplet
