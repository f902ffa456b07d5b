// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace couplet::base {

/// Unit of a key for a temperature difference, to distinguish it from an absolute temperature.
inline constexpr std::string_view kelvin_difference = "K difference";

/// Returns true if a number requires a unit because two common units make it ambiguous: temperatures (20 K or
/// 20 degC), angles and rotation speeds (0.5 rad or 0.5 deg). Temperature differences are the same in K and
/// degC. A bare number for anything else is in SI.
constexpr bool needs_unit(std::string_view unit) { return unit == "K" || unit == "rad" || unit == "rad/s"; }

/// Unit: SI value = factor * number + offset; exponents of kg, m, s, K, rad. Since an angle is no plain number,
/// 1/min is no speed of rotation and rad/s no frequency.
struct Unit {
  double factor = 1;
  /// Only for degC and degF by themselves; inside a product (W/(m degC)) it is a difference.
  double offset = 0;
  using Dimension = std::array<int, 5>;
  Dimension dimension{};
  bool is_number() const { return dimension == Dimension{}; }
};

/// Parses "MPa", "kg/m^3", "W/(m K)", "kPa s", "1/s", "%"; "" and "1" are plain numbers. SI prefixes are
/// allowed for g m s N Pa bar J W Wh K Hz l. Throws Error on an unknown symbol, with a suggestion.
Unit parse_unit(std::string_view text);
/// Parses a unit that converts to `wanted`. Throws Error otherwise.
Unit parse_unit(std::string_view text, std::string_view wanted);

/// Number and the text that follows it.
struct Quantity {
  double number = 0;
  std::string unit;
};
/// Splits a text that starts with a finite number. Otherwise returns nothing.
std::optional<Quantity> split_quantity(std::string_view text);

/// Converts a text to `unit`: "5.6 MPa" in "Pa" is 5.6e6. A bare number is in `unit`, unless needs_unit(). An
/// empty `unit` means a plain number or %. Throws Error.
double parse_quantity(std::string_view text, std::string_view unit);

/// Formats "0.1 m", or "0.1" without a unit, with the fewest digits that restore the same number.
std::string format_quantity(double value, std::string_view unit);

}  // namespace couplet::base
