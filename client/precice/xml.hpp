// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace couplet::dropin {

/// XML element with its name as written ("data:scalar"), line and contents. Texts between elements are not
/// kept.
struct Element {
  std::string name;
  int line = 0;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<Element> children;

  /// Value of an attribute. Empty if there is none.
  std::string attribute(const std::string& key) const;
  std::vector<const Element*> all(const std::string& name) const;
};

/// Digest "xml-" and 16 hexadecimal digits (64-bit FNV-1a) of names and trimmed attributes, in order. Skips
/// elements that do not affect the result (log, export, ...). `couplet import` computes the same.
std::string digest(const Element& element);

/// Reads the outermost element. Throws precice::Error with file and line.
Element read_xml(const std::string& file);

}  // namespace couplet::dropin
