// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/modes/modal_model.hpp"

namespace couplet::modes {

/// The rigid motion u = translation + rotation x (x - centre of the vertices) that is nearest to a mode.
struct RigidMotion {
  Vec3 translation = Vec3::Zero();  ///< [1/sqrt(kg)]
  Vec3 rotation = Vec3::Zero();     ///< [1/(sqrt(kg) m)]
  double misfit = 0;                ///< rms of what is left of the mode's vertices, over their rms
};

/// By least squares over the vertices. A surface whose vertices lie on one line does not turn about it.
RigidMotion rigid_motion(const ModalModel& model, std::size_t mode);

}  // namespace couplet::modes
