// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "common/config/description.hpp"
#include "common/config/load.hpp"

namespace couplet::config {
namespace {

std::string key_text(const std::string& name) {
  YAML::Emitter emitter;
  emitter << name;
  return emitter.c_str();
}

/// First line of a list entry starts with "- ", everything else is indented.
void write(std::string& out, const std::vector<Item>& items, std::size_t indent) {
  const std::string blanks(indent, ' ');
  for (const Item& item : items) {
    const std::string name = key_text(item.facts.name);
    switch (item.kind) {
      case Item::Kind::key:
      case Item::Kind::variant:
        if (item.value.empty())
          out += fmt::format("{}# {}: not set\n", blanks, name);
        else
          out += fmt::format("{}{}: {}{}\n", blanks, name, item.value,
                             item.facts.unit.empty() ? "" : "  # " + item.facts.unit);
        for (const auto& [word, keys] : item.cases) write(out, keys, indent);
        break;
      case Item::Kind::section:
        out += fmt::format("{}{}:\n", blanks, name);
        write(out, item.items, indent + 2);
        break;
      case Item::Kind::optional:
        if (item.is_present) {
          out += fmt::format("{}{}:\n", blanks, name);
          write(out, item.items, indent + 2);
        } else {
          out += fmt::format("{}# {}: not there\n", blanks, name);
        }
        break;
      case Item::Kind::map:
        out += fmt::format("{}{}:{}\n", blanks, name, item.present.empty() ? " {}" : "");
        for (const auto& [entry, keys] : item.present) {
          out += fmt::format("{}  {}:\n", blanks, key_text(entry));
          write(out, keys, indent + 4);
        }
        break;
      case Item::Kind::list:
        out += fmt::format("{}{}:{}\n", blanks, name, item.present.empty() ? " []" : "");
        for (const auto& [entry, keys] : item.present) {
          out += fmt::format("{}  -\n", blanks);
          write(out, keys, indent + 4);
        }
        break;
    }
  }
}

}  // namespace

std::string effective(const Section::Declare& declare) {
  std::string out;
  write(out, describe(declare, Describe::present), 0);
  return out;
}

}  // namespace couplet::config
