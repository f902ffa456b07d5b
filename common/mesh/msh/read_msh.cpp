// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/mesh/msh/msh_entities.hpp"
#include "common/mesh/msh/msh_file.hpp"
#include "common/mesh/msh/msh_groups.hpp"

namespace couplet::mesh {
namespace {

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  if (!in) throw Error("Cannot open the mesh file '{}'. Check the path and the permissions.", file.string());
  std::string text(static_cast<std::size_t>(in.tellg()), '\0');
  in.seekg(0);
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in) throw Error("Cannot read the mesh file '{}'.", file.string());
  return text;
}

/// True for version 4.1, false for 2.2.
bool read_format(MshCursor& in) {
  if (in.at_end() || in.next_section() != "MeshFormat")
    in.fail("This is not a gmsh .msh file: it does not start with $MeshFormat.");
  const double version = in.text_real();
  const long mode = in.text_integer(), data_size = in.text_integer();
  if (version != 2.2 && version != 4.1)
    in.fail(fmt::format(
        "Version {} of the .msh format is not supported. Save the mesh as version 4.1 (gmsh -format msh41) "
        "or 2.2 (gmsh -format msh22).",
        version));
  if (data_size != 8) in.fail(fmt::format("Numbers of {} bytes are not supported; expected 8.", data_size));
  in.end_of_line();
  if (mode == 1) {
    in.binary = true;
    if (in.raw<int>() != 1)
      in.fail("The file was written on a machine with a different byte order. Save it as ASCII.");
  }
  in.end_section();
  return version == 4.1;
}

void read_names(MshCursor& in, MshContent& content) {
  for (long n = in.text_integer(); n > 0; --n) {
    const int dim = static_cast<int>(in.text_integer()), tag = static_cast<int>(in.text_integer());
    content.names.push_back({{dim, tag}, in.quoted()});
  }
  in.end_section();
}

int dimension(const MshContent& content) {
  int dim = 2;
  for (const auto& e : content.elements)
    if (find_msh_type(e.type)->dim == 3) dim = 3;
  return dim;
}

RawMesh to_raw(const MshContent& content, const std::filesystem::path& file) {
  RawMesh raw;
  raw.dim = dimension(content);
  raw.points = content.points;
  MshGroups zones(content.names, raw.dim), patches(content.names, raw.dim - 1);
  for (const auto& e : content.elements) {
    const MshElementType& type = *find_msh_type(e.type);
    const std::span<const Index> nodes(content.nodes.data() + e.first_node, std::size_t(type.n_nodes));
    const std::span<const int> groups(content.groups.data() + e.first_group, std::size_t(e.n_groups));
    if (type.dim == raw.dim) {
      const int zone = groups.empty() ? zones.use_default() : zones.use(groups[0]);
      for (const int other : groups)
        if (zones.use(other) != zone)
          throw Error("{}: a {} is in two physical groups, '{}' and '{}'. A cell must be in exactly one.",
                      file.string(), type.name, zones.name(zone), zones.name(zones.use(other)));
      raw.cell_type.push_back(msh_cell_type(e.type));
      raw.cell_points.push_row(nodes);
      raw.cell_zone.push_back(zone);
    } else if (type.dim == raw.dim - 1) {
      // An element in two groups goes in twice, and the check of the boundary names both with the place.
      for (const int tag : groups) {
        raw.boundary_points.push_row(nodes);
        raw.boundary_patch.push_back(patches.use(tag));
      }
    }
  }
  raw.zones = zones.finish(raw.cell_zone);
  raw.patches = patches.finish(raw.boundary_patch);
  return raw;
}

MshContent read_content(const std::filesystem::path& file) {
  MshCursor in(file, read_all(file));
  const bool is_41 = read_format(in);
  MshContent content;
  MshReader41 reader;
  bool nodes = false, elements = false;
  for (std::string section = in.next_section(); !section.empty(); section = in.next_section()) {
    nodes = nodes || section == "Nodes";
    elements = elements || section == "Elements";
    if (section == "PhysicalNames")
      read_names(in, content);
    else if (is_41)
      reader.read(in, section, content);
    else
      read_msh_2_2(in, section, content);
  }
  if (!nodes || !elements) in.fail("The file has no $Nodes or no $Elements. It is incomplete.");
  return content;
}

}  // namespace

RawMesh read_msh(const std::filesystem::path& file) { return to_raw(read_content(file), file); }

std::vector<int> read_boundary_entities(const std::filesystem::path& file) {
  const MshContent content = read_content(file);
  const int dim = dimension(content);
  std::vector<int> entities;
  for (const auto& e : content.elements)
    if (find_msh_type(e.type)->dim == dim - 1) entities.insert(entities.end(), e.n_groups, e.entity);
  return entities;
}

}  // namespace couplet::mesh
