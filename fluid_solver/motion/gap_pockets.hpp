// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Parts that closed gaps shut off: those of the fluid that no free cells join to an outlet. What inlets let into
/// such a part has nowhere to go; through the small conductance that blocked faces keep it would be pressed all
/// the same, so it is refused.
template <int D>
class GapPockets {
 public:
  GapPockets(const mesh::Mesh& mesh, const FluidParameters& parameters);
  /// To be called when other cells are blocked than before. `gap`: per local cell, below 0: free. Collective.
  void find(const std::vector<int>& gap);
  /// Throws SchemeFailure, naming the inlets and a place, if the velocities `w` of the boundary faces let a pocket
  /// have more in than out, which a `compressible` fluid can take up, or if they lead into blocked cells. Collective.
  void check(const Placement<D>& at, const Vectors<D>& w, double time, bool compressible) const;

  /// Why a flow may have diverged: a pocket whose walls move; empty: there is none. Collective.
  std::string cause(const Placement<D>& at) const;

 private:
  const mesh::Mesh& mesh_;
  std::vector<const mesh::Patch*> open_,
      given_;                  // given pressure; given velocity but of walls. The same on all ranks
  std::vector<double> label_;  // per local cell: least cell id of its part, plus 1; 0: blocked
  std::vector<double> shut_;   // labels of the parts without an outlet, and 0, ascending
};

}  // namespace couplet::fluid
