// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/readers/read_msh.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace couplet::mesh {
namespace {

constexpr std::size_t window = 1 << 25;  // bytes, a multiple of the page size

/// Types of one shape, as pairs of gmsh's number and the number of nodes.
struct MshShape {
  int dim;
  CellType cell;
  std::vector<std::array<int, 2>> types;
};
const std::vector<MshType>& msh_types() {
  static const std::vector<MshType> all = [] {
    using enum CellType;
    std::vector<MshType> types;
    for (const auto& [dim, cell, of_shape] : std::initializer_list<MshShape>{
             {0, triangle, {{15, 1}}},
             {1, triangle, {{1, 2}, {8, 3}, {26, 4}, {27, 5}, {28, 6}}},
             {2, triangle, {{2, 3}, {9, 6}, {20, 9}, {21, 10}, {22, 12}, {23, 15}, {24, 15}, {25, 21}}},
             {2,
              quadrilateral,
              {{3, 4}, {10, 9}, {16, 8}, {36, 16}, {37, 25}, {38, 36}, {39, 12}, {40, 16}, {41, 20}}},
             {3, tetrahedron, {{4, 4}, {11, 10}, {29, 20}, {30, 35}, {31, 56}}},
             {3, hexahedron, {{5, 8}, {12, 27}, {17, 20}, {92, 64}, {93, 125}}},
             {3, prism, {{6, 6}, {13, 18}, {18, 15}, {90, 40}, {91, 75}}},
             {3, pyramid, {{7, 5}, {14, 14}, {19, 13}, {118, 30}, {119, 55}}}})
      for (const auto& [gmsh, n_nodes] : of_shape) types.push_back({gmsh, n_nodes, dim, cell});
    return types;
  }();
  return all;
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

}  // namespace

MshCursor::MshCursor(std::filesystem::path file) : file_(std::move(file)) {
  const int fd = open(file_.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  void* data = MAP_FAILED;
  if (fd >= 0 && fstat(fd, &status) == 0 && status.st_size > 0)
    data = mmap(nullptr, std::size_t(status.st_size), PROT_READ, MAP_PRIVATE, fd, 0);
  if (fd >= 0) close(fd);
  if (fd < 0 || (data == MAP_FAILED && status.st_size > 0))
    throw Error("Cannot open the mesh file '{}'. Check the path and the permissions.", file_.string());
  if (status.st_size == 0) return;
  text_ = {static_cast<const char*>(data), std::size_t(status.st_size)};
  madvise(data, text_.size(), MADV_SEQUENTIAL);
}

MshCursor::~MshCursor() {
  if (!text_.empty()) munmap(const_cast<char*>(text_.data()), text_.size());
}

void MshCursor::give_back_pages() {
  const std::size_t end = at_ / window * window;
  if (end <= given_back_) return;
  madvise(const_cast<char*>(text_.data()) + given_back_, end - given_back_, MADV_DONTNEED);
  given_back_ = end;
}

void MshCursor::fail(const std::string& what) const {
  const std::size_t at = std::min(at_, text_.size());
  if (binary)
    throw Error("{}, byte {}, in ${}: {}", file_.string(), at, section_.empty() ? "MeshFormat" : section_,
                what);
  // The cursor is behind the last item. A line break just before it belongs to the item's line.
  const auto end = text_.begin() + static_cast<std::ptrdiff_t>(at > 0 && text_[at - 1] == '\n' ? at - 1 : at);
  throw Error("{}:{}: {}", file_.string(), 1 + std::count(text_.begin(), end, '\n'), what);
}

void MshCursor::go_to(std::size_t place, const std::string& section) {
  at_ = place;
  given_back_ = std::min(given_back_, at_ / window * window);
  section_ = section;
}

std::string MshCursor::line() {
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string result(text_.substr(at_, end - at_));
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
  if (end == std::string_view::npos)
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
  if (first == at_) fail(incomplete);
  if (at_ - given_back_ > 2 * window) give_back_pages();
  return text_.substr(first, at_ - first);
}

template <class T>
T MshCursor::text_number() {
  const std::string_view w = word();
  T value = 0;
  const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), value);
  if (error != std::errc() || end != w.data() + w.size())
    fail(fmt::format("Expected a {}number, found '{:.40}'.", std::is_integral_v<T> ? "whole " : "", w));
  return value;
}

template long MshCursor::text_number();
template double MshCursor::text_number();

void MshCursor::skip(std::size_t numbers, std::size_t bytes) {
  if (!binary) {
    for (; numbers > 0; --numbers) word();
    return;
  }
  if (numbers > (text_.size() - at_) / bytes) {
    at_ = text_.size();
    fail(incomplete);
  }
  at_ += numbers * bytes;
  give_back_pages();
}

std::size_t MshCursor::checked(std::size_t n) const {
  if (n > text_.size()) fail(fmt::format("{} entries do not fit into this file; the count is wrong.", n));
  return n;
}

std::string MshCursor::quoted() {
  const std::size_t first = text_.find('"', at_);
  const std::size_t last = first == std::string_view::npos ? first : text_.find('"', first + 1);
  if (last == std::string_view::npos) fail("Expected a name in quotation marks.");
  at_ = last + 1;
  return std::string(text_.substr(first + 1, last - first - 1));
}

const MshType& MshCursor::type_or_fail(int gmsh) const {
  const auto found = std::ranges::find(msh_types(), gmsh, &MshType::gmsh);
  if (found != msh_types().end()) return *found;
  fail(fmt::format(
      "Element type {} is not supported: expected a line, triangle, quadrilateral, tetrahedron, hexahedron, prism "
      "or pyramid.",
      gmsh));
}

}  // namespace couplet::mesh
