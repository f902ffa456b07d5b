// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::solid {

struct SolidProbe {
  Vec3 point = Vec3::Zero();
  std::vector<std::string> fields{"displacement"};
};

/// A number that the run is made for, and whose error it estimates at its end.
struct SolidQuantity {
  std::vector<double> point;  // [m]; empty: where the equivalent stress is largest
  std::string field = "displacement";
  std::string patch{};    // of a heat flow
  std::string component;  // "x" of a displacement, "xx" of a stress; of an equivalent stress none
};

/// Fields written at the output interval, and the energies.
struct SolidOutputParameters {
  bool deformed = true;
  bool stress = true;
  bool strain = false;
  bool principal_stress = false;
  bool point_stress = false;
  bool acceleration = false;
  bool energies = false;
  bool large_strain_estimate = false;
  bool spectrum = false;
  bool moments = false;
  Vec3 moment_centre = Vec3::Zero();  // [m]
  std::vector<std::string> surfaces;  // patches, or "all"
  int modes = 0;                      // frequencies and shapes that are asked for
  int buckling = 0;                   // load factors and shapes
};

void declare(config::Section& section, SolidProbe& probe);
void declare(config::Section& section, SolidQuantity& quantity, int dimension);
void declare(config::Section& section, SolidOutputParameters& output);

}  // namespace couplet::solid
