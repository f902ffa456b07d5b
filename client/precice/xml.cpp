// SPDX-License-Identifier: Apache-2.0
#include "xml.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include "precice/Exceptions.hpp"

namespace couplet::dropin {

XmlFile::XmlFile(std::string file) : file_(std::move(file)) {
  std::ifstream in(file_, std::ios::binary);
  if (!in) throw ::precice::Error("The configuration file \"" + file_ + "\" cannot be opened.");
  text_.assign(std::istreambuf_iterator<char>(in), {});
  const pugi::xml_parse_result read =
      document_.load_buffer(text_.data(), text_.size(), pugi::parse_default | pugi::parse_doctype);
  if (!read) refuse_at(read.offset, std::string(read.description()) + ".");
  // A document type may define entities, whose text would be missing.
  for (const pugi::xml_node node : document_.children())
    if (node.type() == pugi::node_doctype) refuse(node, "document types are not supported.");
}

void XmlFile::refuse(pugi::xml_node element, const std::string& why) const {
  refuse_at(element.offset_debug(), why);
}

void XmlFile::refuse_at(std::ptrdiff_t offset, const std::string& why) const {
  const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ptrdiff_t(text_.size()));
  throw ::precice::Error(file_ + ":" + std::to_string(1 + std::count(text_.begin(), end, '\n')) + ": " + why);
}

namespace {

struct Fnv {
  std::uint64_t value = 0xcbf29ce484222325;

  void add(const std::string& text) {
    for (const char c : text)
      if (!std::isspace(static_cast<unsigned char>(c)))
        value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  void add(pugi::xml_node element) {
    const std::string name = element.name();
    for (const char* silent : {"m2n:", "intra-comm:", "export:", "watch-"})
      if (name.rfind(silent, 0) == 0) return;
    if (element.type() != pugi::node_element || name == "log" || name == "profiling") return;
    add("<" + name);
    std::vector<std::pair<std::string, std::string>> attributes;
    for (const pugi::xml_attribute a : element.attributes()) attributes.emplace_back(a.name(), a.value());
    std::sort(attributes.begin(), attributes.end());
    for (const auto& [key, text] : attributes) add(";" + key + "=" + text);
    for (const pugi::xml_node child : element.children()) add(child);
    add(">");
  }
};

}  // namespace

std::string XmlFile::digest() const {
  Fnv all;
  all.add(root());
  char text[24];
  std::snprintf(text, sizeof text, "xml-%016llx", static_cast<unsigned long long>(all.value));
  return text;
}

}  // namespace couplet::dropin
