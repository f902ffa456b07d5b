// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/fv/prescribed_motion.hpp"
#include "fluid_solver/boundary/boundary.hpp"

namespace couplet::fluid {

/// Sets w [m/s] at the faces of bodies to the velocity with which their motion begins at `time`, and, where it is not
/// empty, the turn of these faces (see turn_of()); both per boundary face. Gives the largest speed. Collective.
template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn);

}  // namespace couplet::fluid
