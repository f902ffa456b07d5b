// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/laws/laws.hpp"

#include <algorithm>
#include <array>

namespace couplet::laws {
namespace {

const std::array entries{
    Entry{"saint-venant-kirchhoff", saint_venant_kirchhoff, 0, ""},
    Entry{"neo-hookean", neo_hookean, 0, ""},
    Entry{"nearly-incompressible-neo-hookean", nearly_incompressible_neo_hookean, 0, ""},
    Entry{"mooney-rivlin", mooney_rivlin, 1, "c01 / (c10 + c01)"},
    Entry{"yeoh", yeoh, 2, "c2 / c1, c3 / c1"},
};

}  // namespace

std::span<const Entry> all() { return entries; }

const Entry* find(const std::string& name) {
  const auto found = std::ranges::find(entries, name, [](const Entry& e) { return std::string(e.name); });
  return found == entries.end() ? nullptr : &*found;
}

const Entry* of(const std::string& name) { return name.empty() ? &entries.front() : find(name); }

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const Entry& e : entries) result.emplace_back(e.name);
  return result;
}

}  // namespace couplet::laws
