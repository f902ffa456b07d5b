// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

/// A static box at the given temperature with thermal strain from 300 K on: alpha = 1.2e-5 1/K, symmetry at
/// xmin, ymin, zmin, free elsewhere.
inline SolidParameters warm_box(int dim, const std::string& temperature) {
  SolidParameters p = box_parameters(dim);
  p.temperature = config::ExpressionText{temperature};
  p.expansion = ThermalExpansion{300};
  p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
  for (const char* name : {"xmin", "ymin", "zmin"})
    if (p.boundaries.contains(name)) p.boundaries[name] = boundary(Type::symmetry);
  return p;
}

inline mesh::RawMesh distorted_box(mesh::BoxCells cells) {
  mesh::RawMesh raw = mesh::make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  mesh::perturb_interior(raw, 0.25, 11);
  return raw;
}

}  // namespace couplet::testing
