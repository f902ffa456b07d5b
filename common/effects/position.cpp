// SPDX-License-Identifier: Apache-2.0
#include "common/effects/position.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace couplet::effects {
namespace {

struct Axis {
  const char* effect;
  const char* quantity;
  const char* map;
};

constexpr std::array axes{
    Axis{"near-incompressibility", "Poisson's ratio", "solid-nu"},
    Axis{"resolved-grains", "Biot number of the grains", "tank-biot"},
    Axis{"step-that-resolves-the-contact", "step over the duration of an impact", "plate-contact"}};

}  // namespace

std::vector<Coordinate> coordinates_of(const std::vector<EffectVerdict>& verdicts) {
  std::vector<Coordinate> found;
  for (const EffectVerdict& v : verdicts) {
    const auto axis = std::ranges::find(axes, v.id(), [](const Axis& a) { return std::string(a.effect); });
    if (axis != axes.end() && !(v.saves > 0) && v.threshold > 0)
      found.push_back({axis->quantity, v.number, v.threshold, axis->map});
  }
  return found;
}

void keep_nearest(std::vector<Coordinate>& kept, const std::vector<Coordinate>& seen) {
  for (const Coordinate& c : seen) {
    const auto before = std::ranges::find(kept, c.quantity, &Coordinate::quantity);
    if (before == kept.end())
      kept.push_back(c);
    else if (c.used() > before->used())
      *before = c;
  }
}

std::string position_sentence(const std::vector<Coordinate>& position) {
  if (position.empty()) return {};
  std::string list;
  for (const Coordinate& c : position)
    list += fmt::format("{}{} {:.3g} of {}{:.3g}", list.empty() ? "" : ", ", c.quantity, c.value,
                        c.floor ? "at least " : "", c.limit);
  const Coordinate& nearest = *std::ranges::max_element(position, {}, &Coordinate::used);
  const double used = nearest.used();
  return fmt::format("on the map: {}; {}: {} (docs/stability.md, map {}).", list,
                     used > 1 ? "beyond the limit" : "nearest limit",
                     fmt::format("{}, {:.0f} % of the way", nearest.quantity, 100 * used), nearest.map);
}

}  // namespace couplet::effects
