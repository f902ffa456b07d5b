// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pugixml.hpp>
#include <string>

namespace couplet::dropin {

/// A configuration of preCICE: its elements, and its text, which has their lines.
class XmlFile {
 public:
  /// Throws precice::Error with file and line.
  explicit XmlFile(std::string file);
  pugi::xml_node root() const { return document_.document_element(); }
  /// Throws precice::Error with the file and the line of an element.
  [[noreturn]] void refuse(pugi::xml_node element, const std::string& why) const;
  /// Digest "xml-" and 16 hexadecimal digits (64-bit FNV-1a) of names and trimmed attributes, in order. Skips
  /// elements that do not affect the result (log, export, ...). `couplet import` computes the same.
  std::string digest() const;

 private:
  [[noreturn]] void refuse_at(std::ptrdiff_t offset, const std::string& why) const;

  std::string file_, text_;
  pugi::xml_document document_;
};

}  // namespace couplet::dropin
