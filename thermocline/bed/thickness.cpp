// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/thickness.hpp"

namespace couplet::thermocline {
namespace {

/// Lowest height at which the profile, a broken line through the cell centres, reaches a temperature that
/// lies between those of the lowest and the highest cell.
double height_of(std::span<const double> z, std::span<const double> temperature, double wanted) {
  std::size_t i = 1;
  while (i + 1 < z.size() && temperature[i] < wanted) ++i;
  const double step = temperature[i] - temperature[i - 1];
  const double share = step > 0 ? (wanted - temperature[i - 1]) / step : 0;
  return z[i - 1] + share * (z[i] - z[i - 1]);
}

}  // namespace

std::optional<double> thermocline_thickness(std::span<const double> z, double height,
                                            std::span<const double> temperature, double cold, double hot) {
  const double bottom = temperature.front(), top = temperature.back();
  if (bottom >= hot || top <= cold) return std::nullopt;
  const double step = hot - cold;
  const bool cold_left = bottom > cold, hot_left = top < hot;
  if (cold_left && hot_left)
    return top > bottom ? std::optional(height * step / (top - bottom)) : std::nullopt;
  if (cold_left) return height_of(z, temperature, hot) * step / (hot - bottom);
  if (hot_left) return (height - height_of(z, temperature, cold)) * step / (top - cold);
  return height_of(z, temperature, hot) - height_of(z, temperature, cold);
}

}  // namespace couplet::thermocline
