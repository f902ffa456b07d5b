// SPDX-License-Identifier: Apache-2.0
#include "common/config/leaves.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/config/document.hpp"

namespace couplet::config {
namespace {

void collect(const YAML::Node& node, const std::string& path, std::map<std::string, std::string>& found) {
  if (node.IsMap() && node.size() > 0) {
    for (const auto& item : node) collect(item.second, join_path(path, item.first.Scalar()), found);
  } else if (node.IsSequence() && node.size() > 0) {
    for (std::size_t i = 0; i < node.size(); ++i) collect(node[i], fmt::format("{}[{}]", path, i), found);
  } else {
    found[path] = node.IsMap() ? "{}" : node.IsSequence() ? "[]" : node.IsNull() ? "" : node.Scalar();
  }
}

struct Si {
  double value;
  std::optional<std::array<int, 4>> dimension;  // of a number with a unit
};

std::optional<Si> in_si(const std::string& text) {
  const auto quantity = base::split_quantity(text);
  if (!quantity) return {};
  if (quantity->unit.empty()) return Si{quantity->number, {}};
  try {
    const base::Unit unit = base::parse_unit(quantity->unit);
    return Si{unit.factor * quantity->number + unit.offset, unit.dimension};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

std::map<std::string, std::string> leaves(const Document& document) {
  std::map<std::string, std::string> found;
  collect(document.content().root, "", found);
  return found;
}

bool same_value(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto x = in_si(a), y = in_si(b);
  if (!x || !y) return false;
  if (x->dimension && y->dimension && *x->dimension != *y->dimension) return false;
  return std::abs(x->value - y->value) <= 1e-14 * std::max(std::abs(x->value), std::abs(y->value));
}

}  // namespace couplet::config
