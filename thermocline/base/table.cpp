// SPDX-License-Identifier: Apache-2.0
#include "thermocline/base/table.hpp"

namespace couplet::thermocline {
namespace {

[[gnu::target_clones("avx2", "default")]] void add_ramp(double at, double bend, const double* t,
                                                        double* value, std::size_t n) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) value[i] += bend * std::max(0.0, t[i] - at);
}

[[gnu::target_clones("avx2", "default")]] void add_mean(double at, double bend, const double* from,
                                                        const double* to, double* value, std::size_t n) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double a = std::max(0.0, from[i] - at), b = std::max(0.0, to[i] - at), way = to[i] - from[i];
    // Both beyond the bend: their mean; otherwise half the difference of the squares over the way.
    const bool both = (a > 0) == (b > 0);
    value[i] += bend * (both ? 0.5 * (a + b) : 0.5 * (b * b - a * a) / (way == 0 ? 1 : way));
  }
}

}  // namespace

void Ramps::values(const double* t, double* value, std::size_t n) const {
  for (std::size_t i = 0; i < n; ++i) value[i] = first_;
  for (std::size_t s = 0; s < at_.size(); ++s) add_ramp(at_[s], bend_[s], t, value, n);
}

void Ramps::means(const double* from, const double* to, double* value, std::size_t n) const {
  for (std::size_t i = 0; i < n; ++i) value[i] = first_;
  for (std::size_t s = 0; s < at_.size(); ++s) add_mean(at_[s], bend_[s], from, to, value, n);
}

}  // namespace couplet::thermocline
