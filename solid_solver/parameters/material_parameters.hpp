// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "solid_solver/material/orthotropic.hpp"
#include "solid_solver/parameters/heat_parameters.hpp"

namespace couplet::solid {

struct SolidMaterial {
  double density = 0;         // [kg/m^3]
  double youngs_modulus = 0;  // [Pa]
  double poissons_ratio = 0;
  HeatMaterial heat{};
  std::optional<double> yield_strength{};    // [Pa]; for the verdict on yielding alone
  std::string law{};                         // of finite strain, see laws/; empty: Saint Venant-Kirchhoff
  std::vector<double> law_coefficients{};    // beside E and nu
  std::optional<Orthotropic> orthotropic{};  // in place of E and nu
};

/// One of several materials.
struct ZoneMaterial : SolidMaterial {
  std::vector<std::string>
      zones;  ///< physical volumes (2-D: surfaces) of the mesh; empty: the one of its own name
};

using ZoneMaterials = std::map<std::string, ZoneMaterial>;

/// `is_elastic`: the elastic constants are needed.
void declare(config::Section& section, SolidMaterial& material, bool is_elastic = true);
void declare(config::Section& section, ZoneMaterial& material, bool is_elastic = true);

/// The zones of each material, as the mesh wants them (RawMesh::materials).
std::vector<std::vector<std::string>> zones_of(const ZoneMaterials& materials);

}  // namespace couplet::solid
