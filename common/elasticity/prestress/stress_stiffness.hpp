// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/prestress/pressure_stiffness.hpp"

namespace couplet::elastic {

/// What acts in a body before it moves on.
struct Prestress {
  std::vector<Tensor3> stress;       ///< per flux face [Pa], that of the trial functions: the kernel's own
  std::vector<PlaceBlock> pressure;  ///< of a pressure that follows the surface
};

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
