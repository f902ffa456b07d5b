// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::diagnostics {

/// Range over the measured scenes.
struct Spread {
  double least = 0, most = 0;
};

/// Cost of an effect compared to the same scene without it, on one rank. 0 means negligible.
struct Price {
  std::string_view program, effect;
  int dimension;  ///< of the scenes; 1: beds of a tank
  Spread bytes;   ///< per cell, during a step
  Spread step;    ///< relative to a step without it
};

/// All prices, measured and written by `scripts/prices`.
std::span<const Price> price_list();

/// Prices of one effect by dimension. Empty if not measured.
std::vector<Price> prices_of(std::string_view program, std::string_view effect);

/// Text "16 to 62", in bytes per cell. Empty if negligible.
std::string memory_text(const Price& price);

/// Text "+60 to +78", in percent of a step. Empty if negligible.
std::string time_text(const Price& price);

/// Text "2-D: 16 to 62 B per cell, +60 to +78 % of a step". Empty if negligible.
std::string price_text(const Price& price);

/// Table cell "2-D: 16 to 62 B; 3-D: 30 B". Empty if not measured.
std::string column(const std::vector<Price>& prices, std::string (*text)(const Price&), const char* unit);

/// Least saving from omitting an effect, relative to a step with it. 0 if not measured.
double saved_share(std::string_view program, std::string_view effect);

}  // namespace couplet::diagnostics
