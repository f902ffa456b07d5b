// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/config/section.hpp"
#include "common/diagnostics/choices.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "common/linalg/linear_solver.hpp"

namespace couplet::mesh_mover {

/// Motion of the points of a patch.
enum class BoundaryMotion {
  interface,  ///< with the displacement from the coupler
  moving,     ///< as the case prescribes
  fixed,      ///< at rest
  slip,       ///< along the plane of the patch
  free,       ///< with the adjacent interior
  periodic,   ///< like its partner, which continues the mesh beyond it
};
/// True if the displacement is given.
inline bool is_given(BoundaryMotion m) {
  return m == BoundaryMotion::interface || m == BoundaryMotion::moving;
}

struct PatchMotion {
  BoundaryMotion motion = BoundaryMotion::fixed;
  fv::MotionParameters prescribed;  ///< of `moving`
  std::string partner;              ///< of `periodic`
};

enum class Method {
  laplacian,     ///< thesis (4.11)
  pseudo_solid,  ///< thesis (4.10)
  barrier,       ///< smallest distortion, infinite for a flat cell
  automatic,     ///< Laplacian while it gives a valid mesh, else barrier
};

/// Limits of a moved mesh; 0 or infinity allows any cell that is not inverted.
struct QualityLimits {
  double smallest_scaled_jacobian = -1;
  std::optional<double> largest_angle;
  bool checks_shape() const { return smallest_scaled_jacobian > -1 || largest_angle; }
};

struct Parameters {
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;
  int dimension = 3;
  Method method = Method::automatic;
  /// chi of thesis (4.12): stiffness V^-chi of the cells.
  double stiffening = 1.0;
  /// Pseudo-solid only.
  double poisson_ratio = 0;
  QualityLimits guard;
  std::map<std::string, PatchMotion> boundaries;
  linalg::LinearOptions linear{
      .method = linalg::LinearMethod::direct_symmetric, .relative_tolerance = 1e-10, .max_iterations = 500};
};

void declare(config::Section& section, Parameters& parameters);

}  // namespace couplet::mesh_mover
