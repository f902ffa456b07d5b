// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace couplet::dropin {

/// An element of an XML file: its name as written ("data:scalar"), where it stands, what it holds. Texts between
/// elements are not kept.
struct Element {
  std::string name;
  int line = 0;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<Element> children;

  /// Empty if there is none.
  std::string attribute(const std::string& key) const;
  std::vector<const Element*> all(const std::string& name) const;
};

/// Of what an element holds, "xml-" and 16 hexadecimal digits: names and attributes without blanks, in the elements' order (FNV-1a,
/// 64 bits). Not of what has no part in an answer (log, profiling, m2n, intra-comm, export, watch). `couplet import` has the same.
std::string digest(const Element& element);

/// The outermost element. Throws precice::Error with file and line.
Element read_xml(const std::string& file);

}  // namespace couplet::dropin
