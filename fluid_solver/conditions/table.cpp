// SPDX-License-Identifier: Apache-2.0
// All conditions, in the order of the documentation.
#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "common/base/text.hpp"
#include "fluid_solver/conditions/condition.hpp"

namespace couplet::fluid {
namespace {

using Entry = std::pair<BoundaryType, Condition>;

const auto& condition_table() {
  static const std::array table{
      Entry{BoundaryType::inlet, conditions::inlet()},
      Entry{BoundaryType::outlet, conditions::outlet()},
      Entry{BoundaryType::convective_outlet, conditions::convective_outlet()},
      Entry{BoundaryType::no_slip, conditions::no_slip()},
      Entry{BoundaryType::moving_wall, conditions::moving_wall()},
      Entry{BoundaryType::partial_slip, conditions::partial_slip()},
      Entry{BoundaryType::slip, conditions::slip()},
      Entry{BoundaryType::symmetry, conditions::symmetry()},
      Entry{BoundaryType::periodic, conditions::periodic()},
      Entry{BoundaryType::interface, conditions::interface()},
      Entry{BoundaryType::body, conditions::body()},
  };
  return table;
}

}  // namespace

const Condition& condition_of(const BoundaryParameters& boundary) {
  return std::ranges::find(condition_table(), boundary.type, &Entry::first)->second;
}

std::string condition_names(const std::string& last) {
  std::vector<std::string> names;
  for (const auto& [type, condition] : condition_table()) names.push_back(condition.name);
  const std::string end = names.back();
  names.pop_back();
  return base::join(names) + last + end;
}

void declare_boundary(config::Section& s, BoundaryParameters& b) {
  std::vector<std::tuple<std::string, BoundaryType, config::Section::Declare>> cases;
  std::vector<std::string> about;
  for (const auto& [type, condition] : condition_table()) {
    cases.emplace_back(condition.name, type, [&b, declare = condition.declare](config::Section& v) {
      if (declare) declare(v, b);
    });
    if (!condition.about.empty()) about.push_back(condition.about);
  }
  s.variant("type", b.type, cases, base::join(about, "; "), true);
}

}  // namespace couplet::fluid
