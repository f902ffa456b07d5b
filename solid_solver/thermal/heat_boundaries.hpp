// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/fv/conduction.hpp"
#include "common/fv/expression.hpp"
#include "solid_solver/parameters/heat_parameters.hpp"

namespace couplet::solid {

/// Thermal boundary conditions of a case on the patches of the mesh.
class HeatBoundaries final {
 public:
  /// `symmetry_patches`: symmetry planes unless the YAML file differs. Throws Error.
  HeatBoundaries(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const HeatParameters& parameters,
                 const std::vector<std::string>& symmetry_patches);

  /// One per patch.
  const std::vector<fv::HeatCondition>& conditions() const { return conditions_; }
  /// Returns true if a patch has a given temperature.
  bool gives_temperature() const;
  bool any_transfer() const;
  /// Patches where another participant gives the heat.
  const std::vector<std::string>& interface_patches() const { return interface_patches_; }
  bool transfer_uses_time() const;

  /// Prescribed temperatures at time t, in the order of the operator's known columns.
  void known(const fv::ConductionOperator& conduction, double t, std::span<double> values) const;
  /// Sets 1 at known columns on `patch`, 0 elsewhere; a vertex belongs to the patch of its value.
  void mark_known(const fv::ConductionOperator& conduction, const std::string& patch,
                  std::span<double> values) const;
  /// Per entry of conduction.flux_faces(): heat independent of the face temperature, |S| (q + h T_inf) [W],
  /// and h [W/(m^2 K)]. `transfer` may be empty without convection.
  void fluxes(double t, std::span<double> heat, std::span<double> transfer) const;

 private:
  struct OnPatch {
    HeatBoundary::Type type = HeatBoundary::Type::adiabatic;
    fv::Expression value, coefficient, ambient;
  };
  template <class Value>
  void each_known(const fv::ConductionOperator& conduction, std::span<double> values,
                  const Value& value) const;
  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::vector<OnPatch> on_patch_;
  std::vector<std::string> interface_patches_;
  std::vector<fv::HeatCondition> conditions_;
};

}  // namespace couplet::solid
