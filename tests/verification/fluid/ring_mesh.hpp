// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::fluid::test {

/// Between circles of radius 1 and 2, n cells across.
inline mesh::RawMesh ring_mesh(int n) {
  if (parallel::comm_rank(MPI_COMM_WORLD) > 0) return {};
  const int around = 8 * n;
  mesh::RawMesh raw;
  raw.dim = 2;
  raw.patches = {"inner", "outer"};
  raw.zones = {"fluid"};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < around; ++i) {
      const double r = 1 + double(j) / n, angle = 2 * std::numbers::pi * i / around;
      raw.points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < around; ++i) {
      const Index a = j * around + i, b = j * around + (i + 1) % around;
      raw.cell_type.push_back(mesh::CellType::quadrilateral);
      raw.cell_points.push_row(std::vector<Index>{a, a + around, b + around, b});
      raw.cell_zone.push_back(0);
    }
  for (const int j : {0, n})
    for (int i = 0; i < around; ++i) {
      raw.boundary_points.push_row(std::vector<Index>{j * around + i, j * around + (i + 1) % around});
      raw.boundary_patch.push_back(j == 0 ? 0 : 1);
    }
  return raw;
}

}  // namespace couplet::fluid::test
