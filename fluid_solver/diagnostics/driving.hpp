// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <span>
#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// Time-dependent expressions that drive a flow: body force, motion of the mesh, velocities and pressures at boundaries. A
/// flow that responds linearly to such an expression does not drift from it, because errors cancel over half
/// a period, unless waves carry them away. A flow coupled to a structure or with vortices may oscillate and never counts as driven.
class Driving {
 public:
  explicit Driving(const FluidParameters& parameters);
  /// True if some expression depends on time, or a mesh mover moves walls as the case says.
  bool is_possible() const { return by_mover_ || !timed_.empty(); }
  /// True if walls, bodies or the mesh move. These expressions then do not describe the driving completely.
  bool moves() const { return moves_; }
  /// True if an expression still changes over the last steps of `dt` before `time` [s] at one of the `places`
  /// [m] of this rank, or if the mesh mover has moved the mesh in the last step. Collective over `comm`.
  bool acts(MPI_Comm comm, std::span<const Vec3> places, double time, double dt,
            std::span<const double> mesh_flux) const;

 private:
  std::vector<fv::Expression> timed_;
  bool moves_ = false, by_mover_ = false;
};

}  // namespace couplet::fluid
