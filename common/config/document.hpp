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

/// Where a message points. Overridden values come after everything in the file.
struct Place {
  int line = 0, column = 0;   ///< 1-based; 0: unknown
  std::string override_text;  ///< "--set a.b=v" if the value comes from there
};

struct Message {
  Place place;
  std::string path, text;
};

Place place_of(const YAML::Node& node);
/// "case.yaml:12:5: participants.solid: text".
std::string format(const std::string& file, const Message& message);
/// In file order, equal ones once.
std::vector<std::string> format_all(const std::string& file, std::vector<Message> messages);

/// "a.b" and "c" give "a.b.c"; an empty parent gives "c".
std::string join_path(const std::string& parent, std::string_view name);

/// Is `path` the same as `above`, or something in it?
bool is_below(std::string_view path, std::string_view above);

/// The names of a mapping's keys in file order.
std::vector<std::string> key_names(const YAML::Node& map);

/// One entry of a mapping; found is false if it is not there.
struct Entry {
  bool found = false;
  Place place;      ///< of the key
  YAML::Node node;  ///< of the value
};
Entry find(const YAML::Node& map, std::string_view name);

/// Every single value of the document with the overrides of --set, under its dotted path: "participants.solid.mesh",
/// "participants.solid.boundaries.top.value[0]". Empty mappings and lists stand as "{}" and "[]".
std::map<std::string, std::string> leaves(const Document& document);

/// Whether two texts of a value say the same: "20 ms" and "0.02 s" do, and so does "0.02", which is in SI.
bool same_value(const std::string& a, const std::string& b);

}  // namespace couplet::config
