// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>

#include "common/mesh/msh/msh_file.hpp"

namespace couplet::mesh {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

}  // namespace

void MshCursor::fail(const std::string& what) const {
  const std::size_t at = std::min(at_, text_.size());
  if (binary)
    throw Error("{}, byte {}, in ${}: {}", file_.string(), at, section_.empty() ? "MeshFormat" : section_,
                what);
  // The cursor stands behind what it read last; a line break just before it belongs to that line.
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(at > 0 && text_[at - 1] == '\n' ? at - 1 : at);
  throw Error("{}:{}: {}", file_.string(), 1 + std::count(text_.begin(), end, '\n'), what);
}

std::string MshCursor::line() {
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string result = text_.substr(at_, end - at_);
  at_ = std::min(end + 1, text_.size());
  while (!result.empty() && is_space(result.back())) result.pop_back();
  const auto first = std::find_if_not(result.begin(), result.end(), is_space);
  return {first, result.end()};
}

std::string MshCursor::next_section() {
  while (!at_end()) {
    const std::string text = line();
    if (text.empty()) continue;
    if (text[0] != '$') fail(fmt::format("Expected a section such as $Nodes here, found '{:.40}'.", text));
    return section_ = text.substr(1);
  }
  return "";
}

void MshCursor::skip_section() {
  const std::size_t end = text_.find("$End" + section_, at_);
  if (end == std::string::npos)
    fail(fmt::format("Section ${0} has no $End{0}. The file is incomplete.", section_));
  at_ = end;
  line();
}

void MshCursor::end_section() {
  std::string text;
  while (!at_end() && text.empty()) text = line();
  if (text != "$End" + section_)
    fail(fmt::format(
        "Expected $End{} here, found '{:.40}'. The counts in the section do not match its content, or the "
        "file is incomplete.",
        section_, text));
}

std::string_view MshCursor::word() {
  while (!at_end() && is_space(text_[at_])) ++at_;
  const std::size_t first = at_;
  while (!at_end() && !is_space(text_[at_])) ++at_;
  if (first == at_) fail("The file ends here in the middle of its data. It is incomplete.");
  return std::string_view(text_).substr(first, at_ - first);
}

long MshCursor::text_integer() {
  const std::string_view w = word();
  long value = 0;
  const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
  if (error != std::errc() || end != w.data() + w.size())
    fail(fmt::format("Expected a whole number, found '{:.40}'.", w));
  return value;
}

double MshCursor::text_real() {
  const std::string_view w = word();
  double value = 0;
  const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
  if (error != std::errc() || end != w.data() + w.size())
    fail(fmt::format("Expected a number, found '{:.40}'.", w));
  return value;
}

std::size_t MshCursor::count() {
  const std::size_t n = size();
  if (n > text_.size()) fail(fmt::format("{} entries do not fit into this file; the count is wrong.", n));
  return n;
}

std::string MshCursor::quoted() {
  const std::size_t first = text_.find('"', at_);
  const std::size_t last = first == std::string::npos ? first : text_.find('"', first + 1);
  if (last == std::string::npos) fail("Expected a name in quotation marks.");
  at_ = last + 1;
  return text_.substr(first + 1, last - first - 1);
}

void MshCursor::end_of_line() { line(); }

const MshElementType* find_msh_type(int gmsh) {
  static constexpr std::array<MshElementType, 8> types{{{1, 1, 2, "line"},
                                                        {2, 2, 3, "triangle"},
                                                        {3, 2, 4, "quadrilateral"},
                                                        {4, 3, 4, "tetrahedron"},
                                                        {5, 3, 8, "hexahedron"},
                                                        {6, 3, 6, "prism"},
                                                        {7, 3, 5, "pyramid"},
                                                        {15, 0, 1, "point"}}};
  const auto found = std::find_if(types.begin(), types.end(), [&](const auto& t) { return t.gmsh == gmsh; });
  return found == types.end() ? nullptr : &*found;
}

const MshElementType& msh_type_or_fail(const MshCursor& cursor, int gmsh) {
  if (const MshElementType* type = find_msh_type(gmsh)) return *type;
  cursor.fail(fmt::format(
      "Element type {} is not supported: expected a first-order line, triangle, quadrilateral, tetrahedron, "
      "hexahedron, prism or pyramid. For curved elements, remesh with Mesh.ElementOrder = 1.",
      gmsh));
}

Index point_or_fail(const MshCursor& cursor, const MshContent& content, std::size_t tag) {
  const auto found = content.point_of_tag.find(tag);
  if (found == content.point_of_tag.end())
    cursor.fail(fmt::format("An element uses node {}, which is not in $Nodes.", tag));
  return found->second;
}

}  // namespace couplet::mesh
