// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/inp/inp_elements.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace couplet::mesh {
namespace {

constexpr InpShape triangle{CellType::triangle, 2, 3, 3, {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}}}};
constexpr InpShape quadrilateral{
    CellType::quadrilateral, 2, 4, 4, {{{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}}}};
constexpr InpShape tetrahedron{
    CellType::tetrahedron, 3, 4, 4, {{{0, 1, 2, -1}, {0, 3, 1, -1}, {1, 3, 2, -1}, {2, 3, 0, -1}}}};
constexpr InpShape hexahedron{
    CellType::hexahedron,
    3,
    8,
    6,
    {{{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}}}};
constexpr InpShape prism{
    CellType::prism, 3, 6, 5, {{{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}}};
constexpr InpShape pyramid{
    CellType::pyramid, 3, 5, 5, {{{0, 1, 2, 3}, {0, 4, 1, -1}, {1, 4, 2, -1}, {2, 4, 3, -1}, {3, 4, 0, -1}}}};

struct Row {
  std::string_view family;
  int n_nodes;
  const InpShape* shape;
};
constexpr Row rows[] = {{"C3D", 4, &tetrahedron},   {"C3D", 10, &tetrahedron}, {"C3D", 8, &hexahedron},
                        {"C3D", 20, &hexahedron},   {"C3D", 6, &prism},        {"C3D", 15, &prism},
                        {"C3D", 5, &pyramid},       {"CPS", 3, &triangle},     {"CPS", 6, &triangle},
                        {"CPS", 4, &quadrilateral}, {"CPS", 8, &quadrilateral}};

// Bars and beams with their numbers of nodes; 0: what has no part in a mesh.
constexpr std::pair<std::string_view, int> others[] = {
    {"T2D2", 2},    {"T2D3", 3},    {"T3D2", 2},     {"T3D3", 3},   {"B21", 2},    {"B22", 3},
    {"B31", 2},     {"B32", 3},     {"B31R", 2},     {"B32R", 3},   {"MASS", 0},   {"SPRINGA", 0},
    {"SPRING1", 0}, {"SPRING2", 0}, {"DASHPOTA", 0}, {"GAPUNI", 0}, {"ROTARYI", 0}};

}  // namespace

InpType inp_type(std::string_view name) {
  for (const auto& [other, n] : others)
    if (name == other) return {n > 0 ? InpType::Use::edge : InpType::Use::nothing, nullptr, n};
  if (name.size() < 4) return {};
  const std::string_view family = name.starts_with("CPE") ? "CPS" : name.substr(0, 3);
  std::string_view rest = name.substr(3);
  int n = 0;
  for (; !rest.empty() && rest[0] >= '0' && rest[0] <= '9' && n < 100; rest.remove_prefix(1))
    n = 10 * n + (rest[0] - '0');
  // What follows is how they are integrated: reduced, hybrid, incompatible modes, modified.
  if (rest.find_first_not_of("RHIMS") != std::string_view::npos) return {};
  for (const Row& row : rows)
    if (row.family == family && row.n_nodes == n) return {InpType::Use::cell, row.shape, n};
  return {};
}

std::string why_not_read(std::string_view name) {
  const auto begins = [&](std::initializer_list<const char*> all) {
    return std::ranges::any_of(all, [&](const char* n) { return name.starts_with(n); });
  };
  const char* reason = begins({"CAX", "DCAX"}) ? "axisymmetric elements are not supported"
                       : begins({"S3", "S4", "S6", "S8", "STRI", "SC", "M3D"})
                           ? "shells and membranes are not supported; mesh the wall as a solid"
                       : begins({"DC", "AC", "F", "U"}) ? "it is not a solid element"
                                                        : "it is unknown";
  return fmt::format(
      "elements of type '{}' are not supported ({}). Supported: C3D4, C3D5, C3D6, C3D8, C3D10, C3D15, "
      "C3D20, CPS3, CPS4, CPS6, CPS8 and their CPE equivalents; second-order ones by their corners.",
      name.substr(0, 40), reason);
}

}  // namespace couplet::mesh
