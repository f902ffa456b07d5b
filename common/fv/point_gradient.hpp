// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::fv {

/// Mean gradient of each owned cell by Gauss's theorem from values and gradients at points, which give a
/// quadratic on every edge; quadrilaterals are cut into triangles around the mean of their corners. Exact for
/// quadratic fields on any (also warped) cell; for linear ones with slopes that are the same everywhere.
/// `values`: mesh.dim components a local point; `slopes`: their gradients there; ghosts up to date. Entry
/// (i, j) of a gradient is the derivative of component j along i, in the reference configuration.
std::vector<Tensor3> gradients_from_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                           std::span<const double> values, std::span<const Tensor3> slopes);

}  // namespace couplet::fv
