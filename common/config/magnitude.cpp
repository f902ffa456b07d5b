// SPDX-License-Identifier: Apache-2.0
#include "common/config/magnitude.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/text.hpp"
#include "common/base/units.hpp"

namespace couplet::config {
namespace {

/// Values of table(t, [clamp|error,] 0, 0, 2, 300000), which follow their positions. None for a table in a
/// file or of a function.
std::vector<double> values_of_table(const std::string& text) {
  std::vector<double> values;
  if (!text.starts_with("table(") || text.find_first_of("()", 6) != text.size() - 1) return values;
  const std::vector<std::string> parts = base::split(text.substr(6, text.size() - 7), ',');
  const std::size_t first = parts.size() > 1 && !base::split_quantity(parts[1]) ? 3 : 2;
  for (std::size_t i = first; i < parts.size(); i += 2) {
    const auto number = base::split_quantity(parts[i]);
    if (!number || !number->unit.empty() || !base::split_quantity(parts[i - 1])) return {};
    values.push_back(number->number);
  }
  return values;
}

std::vector<double> values_of(const ExpressionText& text) {
  const auto number = base::split_quantity(text.text);
  if (number && number->unit.empty()) return {number->number};
  return values_of_table(text.text);
}

std::vector<double> values_of(const Slot& slot) {
  const auto single = [](double v) { return std::vector<double>{v}; };
  return std::visit(
      Overloaded{[&](double* v) { return single(*v); }, [&](int* v) { return single(*v); },
                 [&](std::optional<double>* v) { return *v ? single(**v) : std::vector<double>{}; },
                 [&](Vec3* v) { return single(v->cwiseAbs().maxCoeff()); },
                 [](std::vector<double>* v) { return *v; }, [](ExpressionText* v) { return values_of(*v); },
                 [](std::optional<ExpressionText>* v) { return *v ? values_of(**v) : std::vector<double>{}; },
                 [](std::vector<ExpressionText>* v) {
                   // In a vector, values that are small compared to its largest component count as zero.
                   double largest = 0;
                   for (const ExpressionText& component : *v)
                     for (const double value : values_of(component))
                       largest = std::max(largest, std::abs(value));
                   return std::vector<double>{largest};
                 },
                 [](std::map<std::string, double>* v) {
                   std::vector<double> values;
                   for (const auto& [name, value] : *v) values.push_back(value);
                   return values;
                 },
                 [](auto) { return std::vector<double>{}; }},
      slot);
}

}  // namespace

std::string describe_plausible(const Key::Facts& facts) {
  if (!facts.plausible) return "";
  return fmt::format("{:g} to {:g} {}", facts.plausible->first, facts.plausible->second, facts.unit);
}

std::string doubt_of_magnitude(const Key::Facts& facts, const Slot& slot) {
  if (!facts.plausible) return "";
  for (const double value : values_of(slot)) {
    const double magnitude = std::abs(value);
    if (magnitude == 0 || (magnitude >= facts.plausible->first && magnitude <= facts.plausible->second))
      continue;
    return fmt::format("{:.6g} {} (usual: {}): implausible; check the number and its unit.", value,
                       facts.unit, describe_plausible(facts));
  }
  return "";
}

}  // namespace couplet::config
