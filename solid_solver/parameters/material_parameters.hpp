// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/elasticity/anisotropic.hpp"
#include "common/fv/expression.hpp"
#include "solid_solver/parameters/heat_parameters.hpp"

namespace couplet::solid {

/// Material with three planes of symmetry, and its axes.
struct Orthotropic {
  std::vector<double> youngs_moduli, poissons_ratios, shear_moduli;  // 1 2 3; 12 23 13; 12 23 13 [Pa]
  /// In x, y, z, of any length; empty means x and y. In 2-D only the first is used and the third is z. Only the
  /// part of the second normal to the first is used.
  std::vector<config::ExpressionText> first_axis, second_axis;
};

/// Declares the keys of `material.orthotropic`.
void declare(config::Section& section, Orthotropic& material);

/// Elastic matrix in the axes of the material.
elastic::ElasticMatrix matrix_of(const Orthotropic& material);

/// Axes of a material as a function of position.
class MaterialAxes {
 public:
  /// `dimension` 2 or 3.
  MaterialAxes(const Orthotropic& material, int dimension);
  /// True if the axes are uniform.
  bool is_constant() const { return is_constant_; }
  /// Axes 1, 2, 3 as orthonormal columns. Throws Error where they are undefined.
  Tensor3 at(const Vec3& place) const;

 private:
  std::vector<fv::Expression> first_, second_;
  int dimension_;
  bool is_constant_ = true;
};

struct SolidMaterial {
  double density = 0;         // [kg/m^3]
  double youngs_modulus = 0;  // [Pa]
  double poissons_ratio = 0;
  HeatMaterial heat{};
  std::optional<double> yield_strength{};  // [Pa]; only for the finding about yielding
  std::string law{};  // law of finite strain, see laws/; empty means Saint Venant-Kirchhoff
  std::vector<double> law_coefficients{};    // in addition to E and nu
  std::optional<Orthotropic> orthotropic{};  // instead of E and nu
};

/// One of several materials.
struct ZoneMaterial : SolidMaterial {
  /// Physical volumes (2-D: surfaces) of the mesh; empty for the zone of the material's own name.
  std::vector<std::string> zones;
};

using ZoneMaterials = std::map<std::string, ZoneMaterial>;

/// `is_elastic`: the elastic constants are required.
void declare(config::Section& section, SolidMaterial& material, bool is_elastic = true);
void declare(config::Section& section, ZoneMaterial& material, bool is_elastic = true);

/// Zones of each material, for RawMesh::materials.
std::vector<std::vector<std::string>> zones_of(const ZoneMaterials& materials);

}  // namespace couplet::solid
