// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Says once where the temperature swings to and fro from step to step: the trapezoidal rule turns modes that its step does
/// not resolve (a shock, a large Fourier number) round in each step in place of damping them: amplification
/// (1 - z/2)/(1 + z/2), towards -1 for z = dt/tau to infinity.
class HeatSwing {
 public:
  /// Of an accepted step that ends at `time` [s], temperatures of local cells [K]. Collective.
  void accepted(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const std::vector<double>& before,
                const std::vector<double>& after, double time);

 private:
  std::vector<double> change_;       // of the last step [K]
  double lowest_ = 0, highest_ = 0;  // that was seen [K]
  int turns_ = 0;                    // in a row
  bool begun_ = false;
  bool told_ = false;
};

}  // namespace couplet::solid
