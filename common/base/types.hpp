// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace couplet {

using Index = std::int32_t;        ///< local index on one rank
using GlobalIndex = std::int64_t;  ///< index over all ranks

using Vec3 = Eigen::Vector3d;
using Tensor3 = Eigen::Matrix3d;
template <int D>
using Vec = Eigen::Matrix<double, D, 1>;
template <int D>
using Tensor = Eigen::Matrix<double, D, D>;

/// Double contraction a : b.
inline double contraction(const Tensor3& a, const Tensor3& b) { return a.cwiseProduct(b).sum(); }

}  // namespace couplet
