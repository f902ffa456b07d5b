// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/xdmf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"

namespace couplet::io::xdmf {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

struct CellKind {
  std::int64_t code;
  const char* name;
  std::uint64_t points;
};
/// In the order of mesh::CellType, followed by edges.
constexpr CellKind kinds[] = {{4, "Triangle", 3},        {5, "Quadrilateral", 4}, {6, "Tetrahedron", 4},
                              {9, "Hexahedron", 8},      {8, "Wedge", 6},         {7, "Pyramid", 5},
                              {edge_code, "Polyline", 2}};

const char* kind_name(std::int64_t code) {
  const auto kind = std::ranges::find(kinds, code, &CellKind::code);
  return kind == std::end(kinds) ? "Mixed" : kind->name;
}

std::string topology(const FieldIndex& s) {
  const std::string size =
      s.kind == 0 ? fmt::format("{}", s.topology_size) : fmt::format("{} {}", s.n_cells, points_of(s.kind));
  const char* width = s.kind == edge_code ? " NodesPerElement=\"2\"" : "";
  return fmt::format(
      "        <Topology TopologyType=\"{}\" NumberOfElements=\"{}\"{}>\n"
      "          <DataItem Format=\"HDF\" NumberType=\"Int\" Precision=\"8\" "
      "Dimensions=\"{}\">{}:/mesh/cells</DataItem>\n"
      "        </Topology>\n",
      kind_name(s.kind), s.n_cells, width, size, escaped(s.file));
}

std::string attribute(const FieldIndex& s, const OutputTime& entry, const Field& field) {
  const std::uint64_t n = field.on_cells ? s.n_cells : s.n_points;
  const std::string size =
      field.components == 1 ? fmt::format("{}", n) : fmt::format("{} {}", n, field.components);
  const std::string shown = field.unit.empty() ? field.name : fmt::format("{} [{}]", field.name, field.unit);
  const char* type = field.components == 1 ? "Scalar" : field.components == 3 ? "Vector" : "Matrix";
  return fmt::format(
      "        <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">\n"
      "          <DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" "
      "Dimensions=\"{}\">{}:/{}/{}/{}</DataItem>\n"
      "        </Attribute>\n",
      escaped(shown), type, field.on_cells ? "Cell" : "Node", size, escaped(s.file), entry.group,
      field.on_cells ? "cells" : "points", escaped(field.name));
}

std::string grid(const FieldIndex& s, const OutputTime& entry) {
  std::string text = fmt::format(
      "      <Grid Name=\"mesh\" GridType=\"Uniform\">\n        <Time Value=\"{}\"/>\n", entry.time);
  text += topology(s);
  text += fmt::format(
      "        <Geometry GeometryType=\"XYZ\">\n"
      "          <DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"{} "
      "3\">{}:/{}/coordinates</DataItem>\n"
      "        </Geometry>\n",
      s.n_points, escaped(s.file), s.moving ? entry.group : "mesh");
  for (const Field& field : *entry.fields) text += attribute(s, entry, field);
  return text + "      </Grid>\n";
}

}  // namespace

std::int64_t cell_code(mesh::CellType type) { return kinds[static_cast<std::size_t>(type)].code; }

std::uint64_t points_of(std::int64_t code) { return std::ranges::find(kinds, code, &CellKind::code)->points; }

void FieldIndex::add(std::string group, double time, std::vector<Field> fields) {
  auto shared = !entries.empty() && *entries.back().fields == fields
                    ? entries.back().fields
                    : std::make_shared<const std::vector<Field>>(std::move(fields));
  entries.push_back({std::move(group), time, std::move(shared)});
}

// The text of all outputs would take more memory than the run itself.
void write(const std::filesystem::path& index, const FieldIndex& series) {
  std::size_t parts = series.entries.size() + 2, next = 0;
  base::write_file(index, [=, text = std::string()]() mutable -> std::string_view {
    if (next == parts) return {};
    text = next == 0           ? "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
                                 "    <Grid Name=\"series\" GridType=\"Collection\" CollectionType=\"Temporal\">\n"
           : next + 1 == parts ? "    </Grid>\n  </Domain>\n</Xdmf>\n"
                               : grid(series, series.entries[next - 1]);
    ++next;
    return text;
  });
}

}  // namespace couplet::io::xdmf
