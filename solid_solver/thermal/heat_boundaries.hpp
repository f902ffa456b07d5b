// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/fv/conduction.hpp"
#include "common/fv/expression.hpp"
#include "solid_solver/parameters/heat_parameters.hpp"

namespace couplet::solid {

/// What the YAML says of the temperature on the patches of the mesh.
class HeatBoundaries final {
 public:
  /// `symmetry_patches`: patches that are symmetry planes unless the YAML says otherwise. Throws Error.
  HeatBoundaries(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const HeatParameters& parameters,
                 const std::vector<std::string>& symmetry_patches);

  /// One a patch.
  const std::vector<fv::HeatCondition>& conditions() const { return conditions_; }
  /// Something fixes the level of the temperature: a steady field needs that.
  bool fix_the_level() const;
  bool any_transfer() const;
  bool transfer_uses_time() const;

  /// Prescribed temperatures at time t, in the order of the operator's known columns.
  void known(const fv::ConductionOperator& conduction, double t, std::span<double> values) const;
  /// The same places: 1 on `patch`, 0 elsewhere; a vertex belongs to the patch that it has its temperature from.
  void mark_known(const fv::ConductionOperator& conduction, const std::string& patch,
                  std::span<double> values) const;
  /// Per entry of conduction.flux_faces(): heat that does not depend on the face's temperature,
  /// |S| (q + h T_inf) [W], and h [W/(m^2 K)]; `transfer` may be empty when there is no convection.
  void fluxes(double t, std::span<double> heat, std::span<double> transfer) const;
  /// Per entry: what the value at the face's centre leaves out of a prescribed flux over the face [W]; 0 elsewhere.
  void fluxes_missed(const fv::ConductionOperator& conduction, double t, std::span<double> missed) const;

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
  std::vector<fv::HeatCondition> conditions_;
};

}  // namespace couplet::solid
