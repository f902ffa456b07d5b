// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::config {

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
