// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::coupler {

/// Weights of the sources for the value at x: the interpolant by Wendland's compact C2 function
/// phi(r) = (1 - r/R)^4 (4 r/R + 1) on these sources, with a linear polynomial [Wendland 1995; de Boer et al.
/// 2007]. They sum to 1 and carry linear fields exactly. The polynomial is taken in the directions in which
/// the sources spread, so that points on a line or in a plane are no trouble; across these the value is
/// constant, and also where x lies far from the sources in a direction in which these hardly spread. One
/// source: its value.
std::vector<double> local_weights(const std::vector<Vec3>& points, std::span<const Index> sources,
                                  const Vec3& x);

}  // namespace couplet::coupler
