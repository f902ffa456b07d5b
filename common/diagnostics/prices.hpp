// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::diagnostics {

/// From the least to the most over the scenes that were measured.
struct Spread {
  double least = 0, most = 0;
};

/// What an effect costs beside the same scene without it, on one rank; 0: next to nothing.
struct Price {
  std::string_view program, effect;
  int dimension;  ///< of the scenes; 1: beds of a tank
  Spread bytes;   ///< per cell, while it steps
  Spread step;    ///< as a share of a step without it
};

/// The one list of prices: `scripts/prices` measures and writes it.
std::span<const Price> price_list();

/// Of one effect, by dimension; empty: not measured.
std::vector<Price> prices_of(std::string_view program, std::string_view effect);

/// "16 to 62", in bytes per cell; empty: next to none.
std::string memory_text(const Price& price);

/// "+60 to +78", in per cent of a step; empty: next to none.
std::string time_text(const Price& price);

/// "2-D: 16 to 62 B per cell, +60 to +78 % of a step"; empty: next to nothing.
std::string price_text(const Price& price);

/// A cell of a table: "2-D: 16 to 62 B; 3-D: 30 B"; empty: not measured.
std::string column(const std::vector<Price>& prices, std::string (*text)(const Price&), const char* unit);

/// What leaving an effect out saves at least, as a share of a step with it; 0: not measured.
double saved_share(std::string_view program, std::string_view effect);

}  // namespace couplet::diagnostics
