// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "common/mesh/msh/msh_file.hpp"

namespace couplet::mesh {
namespace {

void read_nodes(MshCursor& in, MshContent& content) {
  const auto n = static_cast<std::size_t>(in.text_integer());
  in.end_of_line();
  for (std::size_t i = 0; i < n; ++i) {
    const int tag = in.integer();
    if (!content.point_of_tag.emplace(tag, static_cast<Index>(content.points.size())).second)
      in.fail(fmt::format("Duplicate node {}.", tag));
    Vec3 x;
    for (double& value : x) value = in.real();
    content.points.push_back(x);
  }
}

void read_element(MshCursor& in, const MshElementType& type, int n_tags, MshContent& content) {
  MshContent::Element element{type.gmsh, static_cast<int>(content.groups.size()), 0, content.nodes.size(), 0};
  // Tags: physical group (0: none; negative: turned), elementary entity, then partitions.
  for (int t = 0; t < n_tags; ++t) {
    const int tag = in.integer();
    if (t == 1) element.entity = tag;
    if (t != 0 || tag == 0) continue;
    content.groups.push_back(std::abs(tag));
    element.n_groups = 1;
  }
  for (int i = 0; i < type.n_nodes; ++i)
    content.nodes.push_back(point_or_fail(in, content, static_cast<std::size_t>(in.integer())));
  content.elements.push_back(element);
}

void read_elements(MshCursor& in, MshContent& content) {
  const auto n = static_cast<std::size_t>(in.text_integer());
  in.end_of_line();
  for (std::size_t done = 0; done < n;) {
    if (in.binary) {
      // A header for a run of elements of one type.
      const MshElementType& type = msh_type_or_fail(in, in.integer());
      const int count = in.integer(), n_tags = in.integer();
      if (count < 1) in.fail("A block of elements is empty.");
      for (int i = 0; i < count; ++i) {
        in.integer();  // number of the element
        read_element(in, type, n_tags, content);
      }
      done += static_cast<std::size_t>(count);
    } else {
      in.integer();
      const MshElementType& type = msh_type_or_fail(in, in.integer());
      const int n_tags = in.integer();
      read_element(in, type, n_tags, content);
      ++done;
    }
  }
}

}  // namespace

void read_msh_2_2(MshCursor& in, const std::string& section, MshContent& content) {
  if (section == "Nodes") {
    read_nodes(in, content);
    in.end_section();
  } else if (section == "Elements") {
    read_elements(in, content);
    in.end_section();
  } else {
    in.skip_section();
  }
}

}  // namespace couplet::mesh
