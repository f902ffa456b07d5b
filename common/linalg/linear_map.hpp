// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

namespace couplet::linalg {

/// y = F(x) on the rows of this rank. Collective.
using LinearMap = std::function<void(std::span<const double> x, std::span<double> y)>;

}  // namespace couplet::linalg
