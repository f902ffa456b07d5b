// SPDX-License-Identifier: Apache-2.0
#include "common/base/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::base {
namespace {

struct Symbol {
  std::string_view name;
  bool prefixed;
  Unit unit;
};

constexpr Unit make(double factor, int kg, int m, int s, int K, int rad, double offset = 0) {
  return {factor, offset, {kg, m, s, K, rad}};
}

constexpr Symbol symbols[] = {
    {"kg", false, make(1, 1, 0, 0, 0, 0)},
    {"g", true, make(1e-3, 1, 0, 0, 0, 0)},
    {"t", false, make(1e3, 1, 0, 0, 0, 0)},
    {"m", true, make(1, 0, 1, 0, 0, 0)},
    {"l", true, make(1e-3, 0, 3, 0, 0, 0)},
    {"s", true, make(1, 0, 0, 1, 0, 0)},
    {"min", false, make(60, 0, 0, 1, 0, 0)},
    {"h", false, make(3600, 0, 0, 1, 0, 0)},
    {"day", false, make(86400, 0, 0, 1, 0, 0)},
    {"N", true, make(1, 1, 1, -2, 0, 0)},
    {"Pa", true, make(1, 1, -1, -2, 0, 0)},
    {"bar", true, make(1e5, 1, -1, -2, 0, 0)},
    {"atm", false, make(101325, 1, -1, -2, 0, 0)},
    {"psi", false, make(6894.757293168361, 1, -1, -2, 0, 0)},
    {"mmHg", false, make(133.322387415, 1, -1, -2, 0, 0)},
    {"cmHg", false, make(1333.22387415, 1, -1, -2, 0, 0)},
    {"inHg", false, make(3386.388640341, 1, -1, -2, 0, 0)},
    {"mmH2O", false, make(9.80665, 1, -1, -2, 0, 0)},
    {"cmH2O", false, make(98.0665, 1, -1, -2, 0, 0)},
    {"mH2O", false, make(9806.65, 1, -1, -2, 0, 0)},
    {"inH2O", false, make(249.08891, 1, -1, -2, 0, 0)},
    {"P", false, make(0.1, 1, -1, -1, 0, 0)},
    {"cP", false, make(1e-3, 1, -1, -1, 0, 0)},
    {"J", true, make(1, 1, 2, -2, 0, 0)},
    {"W", true, make(1, 1, 2, -3, 0, 0)},
    {"Wh", true, make(3600, 1, 2, -2, 0, 0)},
    {"K", true, make(1, 0, 0, 0, 1, 0)},
    {"degC", false, make(1, 0, 0, 0, 1, 0, 273.15)},
    {"degF", false, make(5. / 9, 0, 0, 0, 1, 0, 459.67 * 5 / 9)},
    {"Hz", true, make(1, 0, 0, -1, 0, 0)},
    {"rad", false, make(1, 0, 0, 0, 0, 1)},
    {"deg", false, make(std::numbers::pi / 180, 0, 0, 0, 0, 1)},
    {"%", false, make(0.01, 0, 0, 0, 0, 0)},
};

struct Prefix {
  std::string_view name;
  double factor;
};
constexpr Prefix prefixes[] = {{"G", 1e9},  {"M", 1e6},  {"k", 1e3},  {"h", 1e2},  {"d", 1e-1},
                               {"c", 1e-2}, {"m", 1e-3}, {"u", 1e-6}, {"µ", 1e-6}, {"n", 1e-9}};

std::vector<std::string> usual_names() {
  std::vector<std::string> names;
  for (const Symbol& symbol : symbols) {
    names.emplace_back(symbol.name);
    if (!symbol.prefixed) continue;
    for (const std::string_view prefix : {"G", "M", "k", "m"})
      if (symbol.name != "g" || prefix != "k")
        names.push_back(std::string(prefix) + std::string(symbol.name));
  }
  return names;
}

Unit symbol_unit(std::string_view name) {
  for (const Symbol& symbol : symbols)
    if (symbol.name == name) return symbol.unit;
  for (const Symbol& symbol : symbols)
    for (const Prefix& prefix : prefixes)
      if (symbol.prefixed && name.size() == prefix.name.size() + symbol.name.size() &&
          name.starts_with(prefix.name) && name.ends_with(symbol.name)) {
        Unit unit = symbol.unit;
        unit.factor *= prefix.factor;
        return unit;
      }
  static constexpr std::array<std::string_view, 8> scales{"C", "°C", "Celsius",    "celsius",
                                                          "F", "°F", "Fahrenheit", "fahrenheit"};
  const auto scale = std::ranges::find(scales, name) - scales.begin();
  const auto meant =
      scale < 8 ? std::optional<std::string>(scale < 4 ? "degC" : "degF") : closest(name, usual_names());
  throw Error("unknown unit '{}'.{}", name, meant ? fmt::format(" Did you mean '{}'?", *meant) : "");
}

/// Grammar: product = power { ["*" | " "] power | "/" power };
/// power = (symbol | "1" | "(" product ")") [["^"] integer]
class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : all_(text), rest_(text) {}

  Unit parse() {
    Unit unit = product();
    if (!rest_.empty()) fail();
    // A scale with an offset cannot be a factor.
    if (factors_ > 1 || powers_) unit.offset = 0;
    return unit;
  }

 private:
  [[noreturn]] void fail() const {
    if (rest_.empty()) throw Error("the unit '{}' is incomplete.", all_);
    throw Error("cannot parse the unit '{}' at '{}'.", all_, rest_);
  }
  void skip_blanks() { rest_ = rest_.substr(std::min(rest_.find_first_not_of(" \t"), rest_.size())); }
  bool take(std::string_view token) {
    skip_blanks();
    if (!rest_.starts_with(token)) return false;
    rest_.remove_prefix(token.size());
    return true;
  }

  Unit product() {
    Unit result;
    if (rest_.find_first_not_of(" \t") == std::string_view::npos) return result;
    skip_blanks();
    bool divide = take("/");
    if (divide) powers_ = true;
    if (!divide) result = power();
    for (;;) {
      if (!divide) {
        skip_blanks();
        if (rest_.empty() || rest_.front() == ')') return result;
        divide = take("/");
        if (!divide && !take("*")) take("·");
      }
      const Unit next = power();
      const int sign = divide ? -1 : 1;
      result.factor *= divide ? 1 / next.factor : next.factor;
      for (std::size_t i = 0; i < result.dimension.size(); ++i)
        result.dimension[i] += sign * next.dimension[i];
      divide = false;
    }
  }

  Unit power() {
    Unit unit = base();
    int exponent = 1;
    if (take("²")) {
      exponent = 2;
    } else if (take("³")) {
      exponent = 3;
    } else {
      const bool caret = take("^");
      const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), exponent);
      if (error != std::errc{}) {
        if (caret) fail();
        return unit;
      }
      rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    }
    powers_ = powers_ || exponent != 1;
    unit.factor = std::pow(unit.factor, exponent);
    for (int& d : unit.dimension) d *= exponent;
    return unit;
  }

  Unit base() {
    ++factors_;
    if (take("(")) {
      // Limits nested brackets, because each one is a recursive call.
      if (++depth_ > deepest)
        throw Error("the unit '{:.20}...' has more than {} nested brackets.", all_, deepest);
      const Unit unit = product();
      if (!take(")")) fail();
      --depth_;
      return unit;
    }
    if (take("1")) return {};
    std::size_t n = 0;
    const auto letter = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '%' || c == '_';
    };
    while (n < rest_.size()) {
      if (letter(rest_[n])) {
        ++n;
      } else if (rest_.substr(n).starts_with("µ")) {
        n += std::string_view("µ").size();
      } else {
        break;
      }
    }
    if (n == 0) fail();
    // The 2 of mmH2O is not a power.
    if (rest_[n - 1] == 'H' && rest_.substr(n).starts_with("2O")) n += 2;
    const std::string_view name = rest_.substr(0, n);
    rest_.remove_prefix(n);
    return symbol_unit(name);
  }

  std::string_view all_, rest_;
  static constexpr int deepest = 20;
  int factors_ = 0, depth_ = 0;
  bool powers_ = false;
};

/// Returns a number without unit, or throws Error if it requires one.
double bare_number(double number, std::string_view text, std::string_view unit) {
  if (!needs_unit(unit) || (number == 0 && unit != "K")) return number;
  throw Error("'{0}' has no unit, but one is required: write {0} {1} or {0} {2}.", text,
              unit == "K"     ? "degC"
              : unit == "rad" ? "deg"
                              : "deg/s",
              unit);
}

/// Throws Error if a temperature and a difference are confused.
void check_kind(const Unit& given, std::string_view given_text, double number, std::string_view text,
                std::string_view unit) {
  if (unit == kelvin_difference && given.offset != 0)
    throw Error("'{}' is a temperature, but a temperature difference is expected: write {:.10g} K.", text,
                given.factor * number);
  if (unit != "K") return;
  if (given_text == kelvin_difference)
    throw Error("'{}' is a temperature difference, but a temperature is expected.", text);
  const double kelvin = given.factor * number + given.offset;
  if (kelvin < 0) throw Error("'{}' is {:.10g} K, below absolute zero.", text, kelvin);
}

}  // namespace

Unit parse_unit(std::string_view text) {
  return UnitParser(trim(text) == kelvin_difference ? "K" : trim(text)).parse();
}

Unit parse_unit(std::string_view text, std::string_view wanted) {
  const Unit unit = parse_unit(text), target = parse_unit(wanted);
  if (unit.dimension == target.dimension) return unit;
  const bool is_turns = target.dimension.back() == 1 && unit.dimension.back() == 0;
  throw Error("the unit '{}' is not convertible to {}{}.", text, wanted.empty() ? "a plain number" : wanted,
              is_turns ? " (a turn is 6.2832 rad or 360 deg)" : "");
}

std::optional<Quantity> split_quantity(std::string_view text) {
  text = trim(text);
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const std::string_view unsigned_part = digits.substr(digits.starts_with('-') ? 1 : 0);
  // Excludes "inf" and "nan", which from_chars would accept.
  if (unsigned_part.empty() || unsigned_part.find_first_of("0123456789.") != 0) return std::nullopt;
  Quantity result;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), result.number);
  if (error != std::errc{}) return std::nullopt;
  result.unit = trim(digits.substr(static_cast<std::size_t>(end - digits.data())));
  return result;
}

double parse_quantity(std::string_view text, std::string_view unit) {
  const auto quantity = split_quantity(text);
  const Unit wanted = parse_unit(unit);
  if (!quantity)
    throw Error("'{}' is not a number; expected {}.", text,
                wanted.is_number() ? "a plain number" : fmt::format("a number in {} or with its unit", unit));
  if (quantity->unit.empty()) return bare_number(quantity->number, text, unit);
  if (quantity->unit.front() == ',') throw Error("'{}' has a decimal comma; use a decimal point.", text);
  if (unit.empty() && quantity->unit != "%")
    throw Error("'{}' contains more than a number ('{}'); expected a plain number.", text, quantity->unit);
  const Unit given = [&] {
    try {
      return parse_unit(quantity->unit, unit);
    } catch (const Error& error) {
      throw Error("'{}': {} Expected {} or a unit convertible to it.", text, error.what(),
                  unit.empty() ? "a plain number" : unit);
    }
  }();
  check_kind(given, quantity->unit, quantity->number, text, unit);
  const double si = given.factor * quantity->number + given.offset;
  return (si - wanted.offset) / wanted.factor;
}

std::string format_quantity(double value, std::string_view unit) {
  return unit.empty() || unit == "1" ? fmt::format("{}", value) : fmt::format("{} {}", value, unit);
}

}  // namespace couplet::base
