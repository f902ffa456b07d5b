// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// Which way the fluid went through inlets and outlets, over all accepted steps of a run.
class Openings {
 public:
  /// `at_rest`: no wall moves; one that does may draw fluid in through an outlet.
  Openings(const mesh::Mesh& mesh, const FluidParameters& parameters, bool at_rest);
  /// phi: volume flux of each flux face, outward at boundaries [m^3/s].
  void add(std::span<const double> phi, double dt);
  /// Inlets through which fluid left, outlets through which it entered, all the time: a sign or a name is wrong. Collective.
  std::vector<std::string> doubts() const;

 private:
  struct Opening {
    const mesh::Patch* patch;
    bool inlet;
    double net = 0, gross = 0;  // outward, of this rank [m^3]
  };
  const mesh::Mesh& mesh_;
  std::vector<Opening> openings_;
};

}  // namespace couplet::fluid
