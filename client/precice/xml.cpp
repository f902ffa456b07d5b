// SPDX-License-Identifier: Apache-2.0
// Subset of XML used by configurations: elements, attributes and comments, but no custom entities.
#include "xml.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "precice/Exceptions.hpp"

namespace couplet::dropin {
namespace {

constexpr int deepest = 64;  // a configuration has five levels

class Parser {
 public:
  Parser(std::string file, std::string text) : file_(std::move(file)), text_(std::move(text)) {}

  Element document() {
    skip_to_element();
    Element root = element(0);
    skip_to_element();
    if (at_ < text_.size()) fail("found content after the end of <" + root.name + ">");
    return root;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw ::precice::Error(file_ + ":" + std::to_string(line()) + ": " + why + ".");
  }
  int line() const {
    return 1 +
           int(std::count(text_.begin(), text_.begin() + std::ptrdiff_t(std::min(at_, text_.size())), '\n'));
  }
  bool starts(const char* what) const {
    return text_.compare(at_, std::char_traits<char>::length(what), what) == 0;
  }
  void skip_past(const char* what) {
    const std::size_t found = text_.find(what, at_);
    if (found == std::string::npos) fail(std::string("'") + what + "' is missing");
    at_ = found + std::char_traits<char>::length(what);
  }
  void blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  /// Skips texts, comments and declarations.
  void skip_to_element() {
    for (;;) {
      at_ = std::min(text_.find('<', at_), text_.size());
      if (starts("<!--"))
        skip_past("-->");
      else if (starts("<?"))
        skip_past("?>");
      else if (starts("<!"))
        fail("document types and CDATA are not read");
      else
        return;
    }
  }
  std::string name() {
    const std::size_t first = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) ||
                                  std::string("_-.:").find(text_[at_]) != std::string::npos))
      ++at_;
    if (first == at_) fail("a name is expected");
    return text_.substr(first, at_ - first);
  }
  std::string value() {
    const char quote = at_ < text_.size() ? text_[at_] : ' ';
    if (quote != '"' && quote != '\'') fail("a value in quotes is expected");
    const std::size_t end = text_.find(quote, at_ + 1);
    if (end == std::string::npos) fail("a value has no end");
    const std::string raw = text_.substr(at_ + 1, end - at_ - 1);
    if (raw.find("&#") != std::string::npos) fail("characters by their numbers (&#...;) are not read");
    at_ = end + 1;
    static const std::pair<const char*, const char*> named[] = {
        {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}};
    std::string plain;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const auto found = std::find_if(std::begin(named), std::end(named), [&](const auto& n) {
        return raw.compare(i, std::char_traits<char>::length(n.first), n.first) == 0;
      });
      if (found == std::end(named)) {
        plain += raw[i];
        continue;
      }
      plain += found->second;
      i += std::char_traits<char>::length(found->first) - 1;
    }
    return plain;
  }
  Element element(int depth) {
    if (depth > deepest) fail("elements are nested too deeply");
    if (at_ >= text_.size()) fail("an element is expected");
    Element e;
    e.line = line();
    ++at_;
    e.name = name();
    for (blanks(); at_ < text_.size() && text_[at_] != '>' && text_[at_] != '/'; blanks()) {
      std::string key = name();
      blanks();
      if (at_ >= text_.size() || text_[at_] != '=') fail("'=' is expected after '" + key + "'");
      ++at_;
      blanks();
      e.attributes.emplace_back(std::move(key), value());
    }
    if (starts("/>")) {
      at_ += 2;
      return e;
    }
    if (!starts(">")) fail("<" + e.name + "> has no end");
    ++at_;
    for (;;) {
      skip_to_element();
      if (at_ >= text_.size()) fail("<" + e.name + "> of line " + std::to_string(e.line) + " is not closed");
      if (!starts("</")) {
        e.children.push_back(element(depth + 1));
        continue;
      }
      at_ += 2;
      if (const std::string closed = name(); closed != e.name)
        fail("</" + closed + "> closes <" + e.name + "> of line " + std::to_string(e.line));
      blanks();
      if (!starts(">")) fail("'>' is expected");
      ++at_;
      return e;
    }
  }

  std::string file_, text_;
  std::size_t at_ = 0;
};

}  // namespace

std::string Element::attribute(const std::string& key) const {
  for (const auto& [name, value] : attributes)
    if (name == key) return value;
  return "";
}

std::vector<const Element*> Element::all(const std::string& of) const {
  std::vector<const Element*> list;
  for (const Element& child : children)
    if (child.name == of) list.push_back(&child);
  return list;
}

namespace {

struct Fnv {
  std::uint64_t value = 0xcbf29ce484222325;

  void add(const std::string& text) {
    for (const char c : text)
      if (!std::isspace(static_cast<unsigned char>(c)))
        value = (value ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  }
  void add(const Element& e) {
    for (const char* silent : {"m2n:", "intra-comm:", "export:", "watch-"})
      if (e.name.rfind(silent, 0) == 0) return;
    if (e.name == "log" || e.name == "profiling") return;
    add("<" + e.name);
    auto attributes = e.attributes;
    std::sort(attributes.begin(), attributes.end());
    for (const auto& [key, text] : attributes) add(";" + key + "=" + text);
    for (const Element& child : e.children) add(child);
    add(">");
  }
};

}  // namespace

std::string digest(const Element& element) {
  Fnv all;
  all.add(element);
  char text[24];
  std::snprintf(text, sizeof text, "xml-%016llx", static_cast<unsigned long long>(all.value));
  return text;
}

Element read_xml(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw ::precice::Error("The configuration file \"" + file + "\" cannot be opened.");
  std::ostringstream text;
  text << in.rdbuf();
  return Parser(file, text.str()).document();
}

}  // namespace couplet::dropin
