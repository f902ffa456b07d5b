// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

#include "common/config/document.hpp"

namespace couplet::config {

Place place_of(const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  if (mark.is_null()) return {};
  return {mark.line + 1, mark.column + 1, ""};
}

std::string join_path(const std::string& parent, std::string_view name) {
  return parent.empty() ? std::string(name) : fmt::format("{}.{}", parent, name);
}

bool is_below(std::string_view path, std::string_view above) {
  if (!path.starts_with(above)) return false;
  return path.size() == above.size() || path[above.size()] == '.' || path[above.size()] == '[';
}

std::vector<std::string> key_names(const YAML::Node& map) {
  std::vector<std::string> names;
  if (map.IsMap())
    for (const auto& item : map) names.push_back(item.first.Scalar());
  return names;
}

Entry find(const YAML::Node& map, std::string_view name) {
  if (map.IsMap())
    for (const auto& item : map)
      if (item.first.Scalar() == name) return {true, place_of(item.first), item.second};
  return {};
}

std::string format(const std::string& file, const Message& message) {
  const Place& place = message.place;
  std::string where = file;
  if (!place.override_text.empty())
    where = place.override_text;
  else if (place.line > 0)
    where = fmt::format("{}:{}:{}", file, place.line, place.column);
  return message.path.empty() ? fmt::format("{}: {}", where, message.text)
                              : fmt::format("{}: {}: {}", where, message.path, message.text);
}

std::vector<std::string> format_all(const std::string& file, std::vector<Message> messages) {
  const auto order = [](const Message& m) {
    return std::make_tuple(!m.place.override_text.empty(), m.place.line, m.place.column);
  };
  std::stable_sort(messages.begin(), messages.end(),
                   [&](const Message& a, const Message& b) { return order(a) < order(b); });
  std::vector<std::string> lines;
  std::set<std::string> seen;
  for (const Message& message : messages) {
    std::string line = format(file, message);
    if (seen.insert(line).second) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace couplet::config
