// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "common/config/section.hpp"
#include "common/diagnostics/effects.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "common/linalg/linear_solver.hpp"

namespace couplet::mesh_mover {

/// How the points of a patch move.
enum class BoundaryMotion {
  interface,  ///< with the displacement the coupler gives
  moving,     ///< as the case prescribes
  fixed,      ///< not at all
  slip,       ///< along the plane of the patch
  free,       ///< with what is inside
  periodic,   ///< as its partner, which is what lies beyond it
};
/// The displacement of these is given.
inline bool is_given(BoundaryMotion m) {
  return m == BoundaryMotion::interface || m == BoundaryMotion::moving;
}

struct Boundary {
  BoundaryMotion motion = BoundaryMotion::fixed;
  fv::MotionParameters prescribed;  ///< of `moving`
  std::string partner;              ///< of `periodic`
};

enum class Method {
  laplacian,     ///< thesis (4.11)
  pseudo_solid,  ///< thesis (4.10)
  rotations,     ///< Laplacian of the rotations of the surface and of what is left
  barrier,       ///< least distortion, infinite for a flat cell
  automatic,     ///< Laplacian, as long as it gives a valid mesh; barrier where it would not
};
/// Mesh that the displacement is relative to.
enum class Form {
  automatic,
  total,        ///< the reference mesh: no drift
  incremental,  ///< the mesh of the last step: the thesis's
};
/// Mesh whose volumes (4.12) takes.
enum class StiffeningVolumes { reference, current };

/// Limits of a moved mesh; 0 or infinity allows anything that is not inverted.
struct GuardParameters {
  double smallest_scaled_jacobian = -1;
  std::optional<double> largest_edge_ratio, largest_angle, largest_area_change, largest_shape_change;
  bool judges_shape() const {
    return smallest_scaled_jacobian > -1 || largest_edge_ratio || largest_angle || largest_area_change ||
           largest_shape_change;
  }
};

struct Parameters {
  std::string mesh;
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;
  int dimension = 3;
  Method method = Method::automatic;
  Form form = Form::automatic;
  /// chi of thesis (4.12): stiffness V^-chi of the cells.
  double stiffening = 1.0;
  StiffeningVolumes stiffening_volumes = StiffeningVolumes::reference;
  /// Pseudo-solid only.
  double poisson_ratio = 0;
  /// Smallest volume a cell may keep, as a fraction of its reference volume.
  double smallest_volume_ratio = 0.0;
  GuardParameters guard;
  std::map<std::string, Boundary> boundaries;
  linalg::LinearOptions linear{
      .method = linalg::LinearMethod::direct_symmetric, .relative_tolerance = 1e-10, .max_iterations = 500};
};

void declare(config::Section& section, Parameters& parameters);

using Card = diagnostics::EffectCard<Parameters>;
std::span<const Card> effect_cards();

}  // namespace couplet::mesh_mover
