// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Whether the trapezoidal rule of a compressible fluid rings: waves of less than four steps a period, which it neither
/// resolves nor damps, make most of what the pressure changes. Of pressures p_0, p_1, p_2 of three steps these are
/// |p_0 - 2 p_1 + p_2| > |p_0 - p_2|, root mean squares over the volume.
class RingingWatch {
 public:
  /// After a step: the share |p_0 - 2 p_1 + p_2| / (4 |p_0|) if it rings, else 0. Collective.
  template <int D>
  static double share(const mesh::Mesh& mesh, const State<D>& state);
  /// Of each step; true when it has rung for as many steps in a row as say so, once.
  bool add(double share);
  double largest() const { return largest_; }
  static constexpr double limit = 0.05;

 private:
  double largest_ = 0;
  int steps_ = 0;
  bool told_ = false;
};

}  // namespace couplet::fluid
