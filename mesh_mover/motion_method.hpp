// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "common/linalg/linear_solver.hpp"

namespace couplet::mesh_mover {

/// From the displacement of what moves to that of every point, on the mesh that it was made with.
class MotionMethod {
 public:
  virtual ~MotionMethod() = default;
  /// `prescribed`: dim values per local point, ghosts current, read on patches whose displacement is given.
  /// Result: dim values per local point [m], ghosts up to date. Throws SolveFailure. Collective.
  virtual std::vector<double> solve(std::span<const double> prescribed) = 0;
  /// Of the last solve.
  virtual linalg::SolveStatistics last() const = 0;
  /// What the next solve starts from. Collective.
  virtual void save(io::CheckpointWriter& file) const = 0;
  virtual void load(io::CheckpointReader& file) = 0;
};

}  // namespace couplet::mesh_mover
