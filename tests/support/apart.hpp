// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"

namespace couplet::support {

/// Both meshes in one, whose patches and zones have the same names. They share no points.
inline mesh::RawMesh beside(mesh::RawMesh raw, const mesh::RawMesh& other) {
  const auto first = Index(raw.points.size());
  const auto append = [&](mesh::Csr& to, const mesh::Csr& rows) {
    for (Index i = 0; i < rows.size(); ++i) {
      std::vector<Index> row(rows[i].begin(), rows[i].end());
      for (Index& v : row) v += first;
      to.push_row(row);
    }
  };
  append(raw.cell_points, other.cell_points);
  append(raw.boundary_points, other.boundary_points);
  raw.points.insert(raw.points.end(), other.points.begin(), other.points.end());
  raw.cell_type.insert(raw.cell_type.end(), other.cell_type.begin(), other.cell_type.end());
  raw.cell_zone.insert(raw.cell_zone.end(), other.cell_zone.begin(), other.cell_zone.end());
  raw.boundary_patch.insert(raw.boundary_patch.end(), other.boundary_patch.begin(),
                            other.boundary_patch.end());
  return raw;
}

}  // namespace couplet::support
