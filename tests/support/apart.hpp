// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"

namespace couplet::support {

/// Adds a mesh with the same patches and zones, which shares no points with `raw`.
inline void add_apart(mesh::RawMesh& raw, const mesh::RawMesh& other) {
  const auto shift = static_cast<Index>(raw.points.size());
  raw.points.insert(raw.points.end(), other.points.begin(), other.points.end());
  const auto append = [shift](mesh::Csr& to, const mesh::Csr& from) {
    for (Index i = 0; i < from.size(); ++i) {
      std::vector<Index> row(from[i].begin(), from[i].end());
      for (Index& p : row) p += shift;
      to.push_row(row);
    }
  };
  append(raw.cell_points, other.cell_points);
  append(raw.boundary_points, other.boundary_points);
  raw.cell_type.insert(raw.cell_type.end(), other.cell_type.begin(), other.cell_type.end());
  raw.cell_zone.insert(raw.cell_zone.end(), other.cell_zone.begin(), other.cell_zone.end());
  raw.boundary_patch.insert(raw.boundary_patch.end(), other.boundary_patch.begin(),
                            other.boundary_patch.end());
}

}  // namespace couplet::support
