// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// What drives a flow in time: expressions of body force, velocities and pressures of boundaries that use t. A flow that
/// answers linearly to a clock cannot drift away from it: what a step leaves turns back with the next half period. One that
/// moves with a structure or carries vortices may swing of itself, clock or not: it is never counted as driven.
class Driving {
 public:
  explicit Driving(const FluidParameters& parameters);
  /// Some expression uses the time at all.
  bool is_possible() const { return !timed_.empty(); }
  /// Walls, bodies or the mesh move: what drives the flow is not known from these expressions alone.
  bool moves() const { return moves_; }
  /// Some of them still change over the last steps of `dt` before `time` [s] at one of the `places` [m], those of this
  /// rank. Collective over `comm`.
  bool acts(MPI_Comm comm, std::span<const Vec3> places, double time, double dt) const;

 private:
  std::vector<fv::Expression> timed_;
  bool moves_ = false;
};

}  // namespace couplet::fluid
