// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace couplet::base {

/// The unit of a key that takes a difference of temperatures: a dimension apart from temperatures above absolute zero.
inline constexpr std::string_view kelvin_difference = "K difference";

/// Whether a number of this unit must not stand bare: two units in common use give it two plausible meanings. So it is
/// for temperatures (20 K or 20 degC), angles and speeds of rotation (0.5 rad or 0.5 deg); differences of temperatures
/// are the same in K and degC, everything else is in SI.
constexpr bool needs_unit(std::string_view unit) { return unit == "K" || unit == "rad" || unit == "rad/s"; }

/// value in SI = factor * number + offset. Exponents of kg, m, s, K; angles are plain numbers (rad = 1).
struct Unit {
  double factor = 1;
  double offset = 0;  ///< only degC alone; inside a product (W/(m degC)) it is a difference
  std::array<int, 4> dimension{};
  bool is_number() const { return dimension == std::array<int, 4>{}; }
};

/// "MPa", "kg/m^3", "W/(m K)", "kPa s", "1/s", "%"; "" and "1" are plain numbers. SI prefixes in front of g m
/// s N Pa bar J W Wh K Hz l. Throws Error on an unknown symbol, with the one that was probably meant.
Unit parse_unit(std::string_view text);

/// A number and whatever follows it.
struct Quantity {
  double number = 0;
  std::string unit;
};
/// Empty unless the text starts with a finite number.
std::optional<Quantity> split_quantity(std::string_view text);

/// "5.6 MPa" in "Pa" is 5.6e6; a bare number is taken to be in `unit` already, where it may be (needs_unit()). An
/// empty `unit` means a plain number (only % is taken then). Throws Error saying what was expected.
double parse_quantity(std::string_view text, std::string_view unit);

/// "0.1 m", or "0.1" without a unit; shortest text that reads back as the same number.
std::string format_quantity(double value, std::string_view unit);

}  // namespace couplet::base
