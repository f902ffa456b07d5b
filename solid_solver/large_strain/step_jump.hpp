// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace couplet::solid {

/// Whether a static step can have stayed on its path of equilibria. On a smooth path each cell moves by something between what the tangents
/// at the two ends of the step give for its load; past a limit point, of the body or of some cells, Newton's method converges, if at all, to an
/// equilibrium beyond both.
class StepJump {
 public:
  /// `u`: unknowns of the last equilibrium, `dim` per node.
  void start(std::span<const double> u, int dim);
  /// Thermal stretches of the faces from now on. What they change by over the step, times the length of the body [m], is left out of account:
  /// a body that grows unevenly by a fifth moves by as much beside its tangents.
  void set_stretch(std::vector<double> of_faces) { stretch_ = std::move(of_faces); }
  /// The present stretches are those of an equilibrium.
  void settle() { settled_ = stretch_; }
  /// `u`, the unknowns before the first iteration, `correction` that iteration's.
  void predict(std::span<const double> u, std::span<const double> correction);
  /// Takes the equilibrium before; gives the motion for the same load by the tangent at the new one. Throws SolveFailure.
  using Backward = std::function<std::vector<double>(std::span<const double> before)>;
  /// `u`: the new equilibrium. Throws SolveFailure where it lies beyond both: a shorter step either finds the soft states between or shows
  /// that there is no equilibrium. `length` of the body [m]. Calls `backward` only if the motion is beyond the tangent before. Collective.
  void end(MPI_Comm comm, std::span<const double> u, double length, const Backward& backward);

 private:
  double beyond(MPI_Comm comm, std::span<const double> u, std::span<const double> later, double growth) const;

  double largest_growth(double length) const;

  std::vector<double> before_, predicted_, stretch_, settled_;
  std::size_t dim_ = 3;
};

}  // namespace couplet::solid
