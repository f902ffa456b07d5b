// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/prestress.hpp"

namespace couplet::elastic {

/// K_sigma of the symmetric gradient, without a matrix: v . K_sigma v = sum_f V_f sigma_f : G_f^T G_f, where three-cornered faces
/// share with their edges (SharedEdges) those with the mean gradients and the mean stress there; and the stiffness of the pressure.
class StressStiffness {
 public:
  virtual ~StressStiffness() = default;
  /// y = K_sigma x on the rows of ElasticOperator. Collective.
  virtual void apply(std::span<const double> x, std::span<double> y) = 0;
};

/// All by reference but what is kept of `of`. Collective.
std::unique_ptr<StressStiffness> make_stress_stiffness(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                       Prestress of);

}  // namespace couplet::elastic
