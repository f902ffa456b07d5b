// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <vector>

namespace couplet::solid {

/// Whether a static step can have stayed on its path of equilibria. On a smooth path each cell moves by something between what the tangents
/// at the two ends of the step give for its load; past a limit point, of the body or of some cells, Newton's method converges, if at all, to an
/// equilibrium beyond both.
class StepJump {
 public:
  /// `u`: unknowns of the last equilibrium, `dim` per node.
  void start(std::span<const double> u, int dim);
  /// `u`, the unknowns before the first iteration, `correction` that iteration's.
  void predict(std::span<const double> u, std::span<const double> correction);
  /// Takes the equilibrium before; gives the motion for the same load by the tangent at the new one. Throws SolveFailure.
  using Backward = std::function<std::vector<double>(std::span<const double> before)>;
  /// `u`: the new equilibrium. Throws SolveFailure where it lies beyond both: a shorter step either finds the soft states between or shows
  /// that there is no equilibrium. Calls `backward` only if the motion is beyond the tangent before. Collective.
  void end(MPI_Comm comm, std::span<const double> u, const Backward& backward) const;

 private:
  double beyond(MPI_Comm comm, std::span<const double> u, std::span<const double> later) const;

  std::vector<double> before_, predicted_;
  std::size_t dim_ = 3;
};

}  // namespace couplet::solid
