// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/config/load.hpp"

namespace couplet::config {

struct Document::Content {
  std::string name, text;
  YAML::Node root;
  std::vector<std::pair<std::string, std::string>> overrides;  ///< dotted path, "--set path=value"
};

/// Location that a message refers to. Overridden values come after everything in the file.
struct Origin {
  int line = 0, column = 0;   ///< 1-based; 0 if unknown
  std::string override_text;  ///< "--set a.b=v" if the value comes from there
};

struct Message {
  Origin place;
  std::string path, text;
};

Origin place_of(const YAML::Node& node);
/// Formats "case.yaml:12:5: participants.solid: text".
std::string format(const std::string& file, const Message& message);
/// Sorts the messages in file order and removes duplicates.
std::vector<std::string> format_all(const std::string& file, std::vector<Message> messages);

/// Joins "a.b" and "c" to "a.b.c". An empty parent gives "c".
std::string join_path(const std::string& parent, std::string_view name);

/// Returns true if `path` is `above` or lies below it.
bool is_below(std::string_view path, std::string_view above);

/// Keys of a mapping in file order.
std::vector<std::string> key_names(const YAML::Node& map);

/// Entry of a mapping. `found` is false if it does not exist.
struct MapEntry {
  bool found = false;
  Origin place;     ///< of the key
  YAML::Node node;  ///< of the value
};
MapEntry find(const YAML::Node& map, std::string_view name);

/// All scalar values of the document including --set, by dotted path: "participants.solid.mesh",
/// "participants.solid.boundaries.top.value[0]". Empty mappings and lists appear as "{}" and "[]".
std::map<std::string, std::string> leaves(const Document& document);

/// Returns true if two texts have the same value: "20 ms", "0.02 s" and "0.02" (which is in SI).
bool same_value(const std::string& a, const std::string& b);

}  // namespace couplet::config
