// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/gradient_fields.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace couplet::fluid {
namespace {

constexpr GradientField fields[] = {
    {"vorticity", "1/s", "field of the curl of the velocity [1/s]", true,
     [](const Tensor3& g) { return Vec3(g(2, 1) - g(1, 2), g(0, 2) - g(2, 0), g(1, 0) - g(0, 1)); }},
    // -g:g^T/2 for a field free of divergence
    {"q-criterion", "1/s^2", "field of Q = (|W|^2 - |S|^2)/2 [1/s^2]: positive in vortices", false,
     [](const Tensor3& g) { return Vec3(-0.5 * (g * g).trace(), 0, 0); }},
    {"shear-rate", "1/s",
     "field of the shear rate (2 S:S)^(1/2), S the strain rate [1/s]: |du/dy| in a shear flow", false,
     [](const Tensor3& g) { return Vec3((g + g.transpose()).norm() / std::sqrt(2.0), 0, 0); }}};

}  // namespace

std::span<const GradientField> gradient_fields() { return fields; }

}  // namespace couplet::fluid
