// SPDX-License-Identifier: Apache-2.0
#include "common/effects/prices.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace couplet::effects {
namespace {

const char* scenes_of(int dimension) { return dimension == 2 ? "2-D: " : dimension == 3 ? "3-D: " : ""; }

/// "a to b", "a" where both are alike, "up to b" from nothing.
std::string spread_text(const std::string& least, const std::string& most, bool from_nothing) {
  if (from_nothing) return "up to " + most;
  return least == most ? most : least + " to " + most;
}

}  // namespace

std::vector<Price> prices_of(std::string_view program, std::string_view effect) {
  std::vector<Price> found;
  std::ranges::copy_if(price_list(), std::back_inserter(found),
                       [&](const Price& p) { return p.program == program && p.effect == effect; });
  return found;
}

std::string memory_text(const Price& price) {
  if (!(price.bytes.most > 0)) return "";
  return spread_text(fmt::format("{:g}", price.bytes.least), fmt::format("{:g}", price.bytes.most),
                     price.bytes.least == 0);
}

std::string time_text(const Price& price) {
  if (!(price.step.most > 0)) return "";
  return spread_text(fmt::format("{:+.0f}", 100 * price.step.least),
                     fmt::format("{:+.0f}", 100 * price.step.most), price.step.least == 0);
}

std::string price_text(const Price& price) {
  const std::string memory = memory_text(price), time = time_text(price);
  if (memory.empty() && time.empty()) return "";
  return fmt::format("{}{}{}{}{}{}", scenes_of(price.dimension), memory, memory.empty() ? "" : " B per cell",
                     memory.empty() || time.empty() ? "" : ", ", time, time.empty() ? "" : " % of a step");
}

std::string column(const std::vector<Price>& prices, std::string (*text)(const Price&), const char* unit) {
  if (prices.empty()) return "";
  std::string cell;
  for (const Price& p : prices)
    if (const std::string one = text(p); !one.empty())
      cell += fmt::format("{}{}{} {}", cell.empty() ? "" : "; ", scenes_of(p.dimension), one, unit);
  return cell.empty() ? "next to none" : cell;
}

double saved_share(std::string_view program, std::string_view effect) {
  const std::vector<Price> prices = prices_of(program, effect);
  if (prices.empty()) return 0;
  const double share = std::ranges::min(prices, {}, [](const Price& p) { return p.step.least; }).step.least;
  return share / (1 + share);
}

}  // namespace couplet::effects
