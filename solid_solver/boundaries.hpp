// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/fv/elasticity.hpp"
#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters.hpp"

namespace couplet {

/// The boundaries of the YAML on the patches of the mesh.
class SolidBoundaries {
 public:
  /// Throws Error if a patch has no boundary, a boundary no patch, or an expression is wrong.
  SolidBoundaries(const Mesh& mesh, const SolidParameters& parameters);

  /// One a patch.
  const std::vector<ElasticCondition>& conditions() const { return conditions_; }
  const std::vector<std::string>& interface_patches() const { return interface_patches_; }
  bool any_prescribed() const;
  bool any_symmetry() const;

  /// Adds tractions and pressures at time t as forces [N] on the boundary faces of owned cells (`dim` values
  /// a face): thesis (2.64), reference configuration.
  void add_forces(double t, std::span<double> forces) const;
  bool forces_use_time() const;

 private:
  friend class PrescribedDisplacement;
  struct OnPatch {
    SolidBoundary::Type type;
    std::vector<Expression> value;
    Expression pressure;
  };
  const Mesh* mesh_;
  std::vector<OnPatch> on_patch_;
  std::vector<ElasticCondition> conditions_;
  std::vector<std::string> interface_patches_;
};

/// Values of fixed-displacement patches in the order of the operator's known columns. A vertex on two such
/// patches takes the value of the first one (order of the mesh file).
class PrescribedDisplacement {
 public:
  PrescribedDisplacement(const Mesh& mesh, const SolidBoundaries& boundaries, const ElasticOperator& elastic);

  std::size_t size() const { return size_; }
  bool is_zero() const { return is_zero_; }
  bool uses_time() const { return uses_time_; }
  /// dim values a known column.
  void evaluate(double t, std::span<double> values) const;
  /// The time derivative, central difference over 2e-3 dt.
  void evaluate_rate(double t, double dt, std::span<double> values) const;

 private:
  struct Group {
    const std::vector<Expression>* value;
    std::vector<Index> columns;
    std::vector<Vec3> places;
  };
  int dim_;
  std::size_t size_ = 0;
  bool is_zero_ = true, uses_time_ = false;
  std::vector<Group> groups_;
};

}  // namespace couplet
