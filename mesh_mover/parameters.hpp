// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "common/config/section.hpp"
#include "common/linalg/linear_solver.hpp"

namespace couplet::mesh_mover {

/// How the points of a patch move.
enum class BoundaryMotion {
  interface,  ///< with the displacement the coupler gives
  fixed,      ///< not at all
  slip,       ///< along the plane of the patch, whose normal must be a coordinate axis
};

struct Boundary {
  BoundaryMotion motion = BoundaryMotion::fixed;
};

struct Parameters {
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  int dimension = 3;
  /// chi of thesis (4.12): stiffness V^-chi of the cells of the reference mesh.
  double stiffening = 1.0;
  /// Smallest volume a cell may keep, as a fraction of its reference volume.
  double smallest_volume_ratio = 0.0;
  std::map<std::string, Boundary> boundaries;
  LinearOptions linear{
      .method = LinearMethod::direct_symmetric, .relative_tolerance = 1e-10, .max_iterations = 500};
};

void declare(config::Section& section, Parameters& parameters);

}  // namespace couplet::mesh_mover
