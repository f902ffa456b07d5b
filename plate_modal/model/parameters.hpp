// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/contact/contact.hpp"
#include "common/diagnostics/choices.hpp"
#include "common/time/time_scheme.hpp"
#include "plate_modal/model/body_parameters.hpp"
#include "plate_modal/model/plate_model.hpp"

namespace couplet::plate {

using contact::ContactParameters;
using contact::ContactRule;

struct PlateMaterial {
  double density = 0, youngs_modulus = 0, poissons_ratio = 0.3;
};

struct EdgeSupport {
  Support support = Support::free;
};

/// Zone of the mesh that differs from the rest of the plate.
struct Zone {
  std::optional<double> thickness, density, youngs_modulus;
};

/// Damping ratio of each mode: ratio + (mass / omega + stiffness omega) / 2.
struct Damping {
  double ratio = 0, mass = 0, stiffness = 0;
};

/// Pressures on both sides in a run without a fluid [Pa]; each pushes into the plate.
struct Load {
  std::optional<config::ExpressionText> upper, lower;
};

struct PlateProbe {
  Vec3 point = Vec3::Zero();
};

struct PlateOutput {
  bool modes = false;
  bool fields = true;
};

struct Parameters {
  enum class Analysis { modal, static_, dynamic };
  Analysis analysis = Analysis::dynamic;
  std::optional<std::string> mesh, modes_file;  // one of the two
  bool cavity = false;                          // the file's surface encloses the outside
  std::map<std::string, double> mesh_parameters;
  double mesh_scale = 1;  // scale of all lengths of the mesh file
  PlateMaterial material;
  double thickness = 0;
  std::map<std::string, Zone> zones;
  std::map<std::string, EdgeSupport> boundaries;
  PlateFrame placement;
  Wetted wetted = Wetted::both;
  std::optional<double> number;  // number of modes of a mesh
  int n_modes() const { return number ? static_cast<int>(*number) : 15; }
  time::TimeSchemeParameters time_scheme;
  std::optional<Damping> damping;
  std::vector<double> gravity;  // [m/s^2]; empty if there is none
  std::optional<Load> load;
  std::optional<ContactParameters> contact;
  std::optional<BodyParameters> body;  // instead of modes
  Vec3 initial_velocity = Vec3::Zero();
  std::vector<double> initial_amplitudes;
  std::map<std::string, PlateProbe> probes;
  PlateOutput output;
};

/// Declares the keys of `participants.<name>` of a plate_modal.
void declare(config::Section& section, Parameters& parameters);

}  // namespace couplet::plate
