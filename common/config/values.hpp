// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::config {

/// Writes the node's value to the member, in the key's unit and range. Throws Error with a sentence without
/// location. Files of tables are relative to `folder`.
void read_value(const YAML::Node& node, const Key::Facts& facts, const Slot& slot,
                const std::filesystem::path& folder = {});

/// Text "unknown key. Did you mean ...?", or the location where this program expects the key.
std::string unknown_key(std::string_view name, const std::vector<std::string>& known);

/// Describes the values of a slot: "number", "list of texts", "one word".
std::string describe_type(const Slot& slot);

/// Current value of the member as in the YAML, with its unit if needed. "" for an empty optional.
std::string format_value(const Slot& slot, std::string_view unit);

/// Reasons why a pair of individually plausible values is implausible, or empty; for Section::doubt.

/// Checks sqrt(modulus/density): 1 m/s (gels) to 20 km/s (diamond).
std::string check_wave_speed(double modulus, double density);
/// Checks viscosity/density, which is rarely below 5e-8 m^2/s (mercury: 1e-7, water: 1e-6).
std::string check_kinematic_viscosity(double viscosity, double density);

/// Plausible magnitudes of a key: "1e3 to 1e13 Pa". Empty if it has none.
std::string describe_plausible(const Key::Facts& facts);

/// Reason why the current value is implausible, or empty. Judges the largest component of a vector, the
/// largest and smallest entry of a list, and the values of a table, but no expression.
std::string check_magnitude(const Key::Facts& facts, const Slot& slot);

/// Declarations as data for generated documents: reference, schema, effective values.
struct Item {
  Declaration::Kind kind = Declaration::Kind::key;
  KeyFacts facts;
  Slot slot = static_cast<double*>(nullptr);
  std::string type, value;         ///< of a key: "number", text of its current value ("" if none)
  std::vector<std::string> words;  ///< of a choice
  std::string what;                ///< of a map: kind of its names
  std::vector<Item> items;         ///< of a section, optional, map entry or list entry
  std::vector<std::pair<std::string, std::vector<Item>>> cases;    ///< of a variant
  std::vector<std::pair<std::string, std::vector<Item>>> present;  ///< current entries of a map or list
  bool is_present = true;                                          ///< of an optional
};

enum class Describe {
  everything,  ///< includes absent parts: adds sample entries to maps, lists and effects
  present,     ///< only what the members hold; changes nothing
};
std::vector<Item> describe(const Section::Declare& declare, Describe extent);

}  // namespace couplet::config
