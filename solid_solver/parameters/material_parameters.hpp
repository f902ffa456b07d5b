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

/// A material with three planes of symmetry, and where its axes lie.
struct Orthotropic {
  std::vector<double> youngs_moduli, poissons_ratios, shear_moduli;  // 1 2 3; 12 23 13; 12 23 13 [Pa]
  /// Of x, y, z, any length; empty: x and y. In the plane the first alone; the third is z there. Of the second counts
  /// what lies across the first.
  std::vector<config::ExpressionText> first_axis, second_axis;
};

/// The keys of `material.orthotropic`.
void declare(config::Section& section, Orthotropic& material);

/// In the axes of the material.
elastic::ElasticMatrix matrix_of(const Orthotropic& material);

/// Axes of a material at places.
class MaterialAxes {
 public:
  /// `dimension` 2 or 3.
  MaterialAxes(const Orthotropic& material, int dimension);
  /// They are the same everywhere.
  bool is_constant() const { return is_constant_; }
  /// Columns 1, 2, 3, orthonormal. Throws Error where they are no axes.
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
