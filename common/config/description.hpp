// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::config {

/// The declarations as data, for what is generated from them: reference, schema, values in force.
struct Item {
  Declaration::Kind kind = Declaration::Kind::key;
  KeyFacts facts;
  Slot slot = static_cast<double*>(nullptr);
  std::string type, value;         ///< of a key: "number", text of the value the member holds ("" for none)
  std::vector<std::string> words;  ///< of a choice
  std::string what;                ///< of a map: the kind of name
  std::vector<Item> items;         ///< of a section, optional, map entry or list entry
  std::vector<std::pair<std::string, std::vector<Item>>> cases;    ///< of a variant
  std::vector<std::pair<std::string, std::vector<Item>>> present;  ///< entries of a map or list now there
  bool is_present = true;                                          ///< of an optional
};

enum class Describe {
  everything,  ///< also what is not there: fills sample entries into maps, lists and effects
  present,     ///< only what the members hold; touches nothing
};
std::vector<Item> describe(const Section::Declare& declare, Describe extent);

}  // namespace couplet::config
