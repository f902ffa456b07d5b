// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "common/mesh/msh/msh_file.hpp"

namespace couplet::mesh {

void MshReader41::read_entities(MshCursor& in) {
  std::array<std::size_t, 4> counts;
  for (std::size_t& n : counts) n = in.count();
  for (int dim = 0; dim < 4; ++dim)
    for (std::size_t i = 0; i < counts[dim]; ++i) {
      const int tag = in.integer();
      for (int k = 0; k < (dim == 0 ? 3 : 6); ++k) in.real();  // point or bounding box
      std::vector<int>& groups = groups_of_entity_[{dim, tag}];
      for (std::size_t n = in.count(); n > 0; --n) groups.push_back(msh_group(in.integer()));
      if (dim == 0) continue;
      for (std::size_t n = in.count(); n > 0; --n) in.integer();  // entities that bound this one
    }
}

void MshReader41::read_nodes(MshCursor& in, MshContent& content) const {
  const std::size_t n_blocks = in.count(), n_nodes = in.count();
  in.size();  // smallest tag
  in.size();  // largest tag
  content.points.reserve(n_nodes);
  content.point_of_tag.reserve(n_nodes);
  for (std::size_t b = 0; b < n_blocks; ++b) {
    const int dim = in.integer();
    in.integer();  // entity
    const int n_parameters = in.integer() != 0 ? dim : 0;
    const std::size_t n = in.count();
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t tag = in.size();
      if (!content.point_of_tag.emplace(tag, static_cast<Index>(content.points.size() + i)).second)
        in.fail(fmt::format("Duplicate node {}.", tag));
    }
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 x;
      for (double& value : x) value = in.real();
      content.points.push_back(x);
      for (int k = 0; k < n_parameters; ++k) in.real();
    }
  }
}

void MshReader41::read_elements(MshCursor& in, MshContent& content) const {
  const std::size_t n_blocks = in.count();
  in.size();  // elements
  in.size();  // smallest tag
  in.size();  // largest tag
  for (std::size_t b = 0; b < n_blocks; ++b) {
    const int dim = in.integer(), tag = in.integer();
    const MshElementType& type = msh_type_or_fail(in, in.integer());
    MshContent::Element element{type.gmsh, static_cast<int>(content.groups.size()), 0, 0, tag};
    const auto entity = groups_of_entity_.find({dim, tag});
    if (entity != groups_of_entity_.end()) {
      content.groups.insert(content.groups.end(), entity->second.begin(), entity->second.end());
      element.n_groups = static_cast<int>(entity->second.size());
    }
    for (std::size_t n = in.count(); n > 0; --n) {
      in.size();  // number of the element
      element.first_node = content.nodes.size();
      for (int i = 0; i < type.n_nodes; ++i) content.nodes.push_back(point_or_fail(in, content, in.size()));
      content.elements.push_back(element);
    }
  }
}

void MshReader41::read(MshCursor& in, const std::string& section, MshContent& content) {
  if (section == "PartitionedEntities")
    in.fail("Partitioned meshes are not supported. Save the whole mesh; it is partitioned on loading.");
  if (section == "Entities")
    read_entities(in);
  else if (section == "Nodes")
    read_nodes(in, content);
  else if (section == "Elements")
    read_elements(in, content);
  else
    return in.skip_section();
  in.end_section();
}

}  // namespace couplet::mesh
