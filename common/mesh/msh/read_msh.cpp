// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/mesh/msh/msh_entities.hpp"
#include "common/mesh/msh/msh_file.hpp"

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

/// Gives out patch (or zone) numbers for the physical groups of one dimension: names in the order of
/// $PhysicalNames, then unnamed groups as "physical_<tag>" in the order in which elements use them. Groups
/// without elements are left out.
class Groups {
 public:
  Groups(const MshContent& content, int dim) {
    for (const auto& [key, name] : content.names)
      if (key.first == dim) number(key.second, name);
  }
  int use(int tag) {
    const auto found = number_of_tag_.find(tag);
    const int g =
        found != number_of_tag_.end() ? found->second : number(tag, fmt::format("physical_{}", tag));
    used_[g] = true;
    return g;
  }
  int use_default() {
    if (default_ < 0) default_ = number(0, "default");
    used_[default_] = true;
    return default_;
  }
  /// Drops the unused names; `numbers` are renumbered.
  std::vector<std::string> finish(std::vector<int>& numbers) const {
    std::vector<std::string> kept;
    std::vector<int> renumbered(names_.size(), -1);
    for (std::size_t g = 0; g < names_.size(); ++g) {
      if (!used_[g]) continue;
      renumbered[g] = static_cast<int>(kept.size());
      kept.push_back(names_[g]);
    }
    for (int& n : numbers) n = renumbered[n];
    return kept;
  }

  const std::string& name(int number) const { return names_[number]; }

 private:
  /// Two tags may carry the same name: one patch.
  int number(int tag, const std::string& name) {
    const auto same = std::find(names_.begin(), names_.end(), name);
    const int g = static_cast<int>(same - names_.begin());
    if (same == names_.end()) {
      names_.push_back(name);
      used_.push_back(false);
    }
    return number_of_tag_[tag] = g;
  }
  std::vector<std::string> names_;
  std::vector<bool> used_;
  std::map<int, int> number_of_tag_;
  int default_ = -1;
};

CellType cell_type(int gmsh) {
  switch (gmsh) {
    case 2:
      return CellType::triangle;
    case 3:
      return CellType::quadrilateral;
    case 4:
      return CellType::tetrahedron;
    case 5:
      return CellType::hexahedron;
    case 6:
      return CellType::prism;
    default:
      return CellType::pyramid;
  }
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
  Groups zones(content, raw.dim), patches(content, raw.dim - 1);
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
      raw.cell_type.push_back(cell_type(e.type));
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
