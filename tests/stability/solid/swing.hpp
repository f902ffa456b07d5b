// SPDX-License-Identifier: Apache-2.0
// Free swings of a sheet and the largest energy that they reach.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

/// A sheet held at xmin that starts with a velocity; undamped.
inline SolidParameters free_swing(time::TimeScheme scheme, FaceGradient gradient) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e5, 0.3};
  p.time_scheme.type = scheme;
  p.method.face_gradient = gradient;
  p.method.relative_tolerance = 1e-12;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.initial_velocity = {{"0.1*x*sin(9*y)"}, {"0.2*x*x"}};
  p.output.energies = true;
  return p;
}

struct Swing {
  double growth =
      0;  ///< largest energy (kinetic, and the smaller of strain energy and work) over the first, minus 1
  bool ended = false;  ///< by the energy guard of the program
  std::string cause;
};

/// `steps`: one after the other, again and again; the balance of energies is looked at every 20 of them.
inline Swing swing(const mesh::RawMesh& raw, const SolidParameters& p, const std::vector<double>& steps,
                   int count) {
  const auto solid = make_solid(raw, p);
  EnergyBalance balance(solid->view(), std::make_shared<StrainEnergy>(solid->view()));
  diagnostics::Report report;
  Swing result;
  double largest = 0, first = 1;
  try {
    for (int i = 0; i < count; ++i) {
      step(*solid, steps[std::size_t(i) % steps.size()]);
      const SolidEnergies e =
          solid->stepper().ledger().total(solid->stepper().state(), solid->fields().point_displacement());
      first = e.initial_kinetic;
      largest = std::max(largest, e.kinetic + std::max(0.0, std::min(e.strain, e.internal_work)));
      if (i % 20 == 19) balance.look(report);
    }
  } catch (const Error& error) {
    result.ended = true;
    result.cause = error.what();
  }
  result.growth = largest / first - 1;
  return result;
}

/// Ten cells along, four across; the middle leans, the ends stand.
inline mesh::RawMesh sheet(double lean) {
  mesh::RawMesh raw =
      mesh::make_box(mesh::BoxCells::quadrilaterals, {10, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0));
  for (Vec3& x : raw.points) x[0] += lean * (x[1] - 0.2) * std::sin(M_PI * x[0]);
  return raw;
}

}  // namespace couplet::testing
