// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/fv/expression.hpp"
#include "common/fv/face_mean.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/boundary/loads.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Throws Error if an entry of `boundaries` names no patch of the mesh, or a patch has no entry. In a thermal
/// analysis a patch needs none.
void check_names(const mesh::Mesh& mesh, const SolidParameters& parameters);

/// Boundary conditions of a case on the faces of the mesh.
class SolidBoundaries {
 public:
  /// Throws Error if a patch has no boundary, a boundary no patch, a part no face, or an expression is
  /// invalid. Collective.
  SolidBoundaries(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const SolidParameters& parameters);

  /// Conditions in the form of the operator.
  elastic::ElasticBoundary elastic() const;
  /// Faces of owned cells of each condition that moves as a rigid body.
  std::vector<std::vector<Index>> rigid_faces() const;
  /// True if the force on a boundary face of an owned cell is known, provided its condition is a load.
  bool knows_traction(Index face) const { return !at(face - mesh_->n_interior).is_rigid; }
  const std::vector<std::string>& interface_patches() const { return interface_patches_; }
  /// True if the patch can hold the solid: some of its faces prescribe more than a force.
  bool holds(std::size_t patch) const { return holds_[patch] != 0; }

  /// Number of values that add_forces() takes.
  std::size_t n_forces() const;
  /// Adds tractions, pressures and total loads at time t as forces [N] on boundary faces of owned cells (see
  /// ElasticKernel::add_face_forces): thesis (2.64), reference configuration. Collective.
  void add_forces(double t, std::span<double> forces, bool with_pressure = true) const;
  /// Pressures at time t on the boundary faces of owned cells, moved by `shift` [Pa], see FollowerPressure::set().
  std::vector<double> pressures(double t, const Vec3& shift = Vec3::Zero()) const;

 private:
  friend class PrescribedDisplacement;
  /// One entry of the YAML file: a patch or a part of it.
  struct Condition {
    SolidCondition::Type type;
    bool is_load = true;                   ///< prescribes only the force
    std::vector<fv::Expression> known;     // vector g of the support, or displacement; empty if zero
    std::vector<fv::Expression> traction;  // empty if there is none
    fv::Expression pressure;
    std::vector<Index> faces;  // faces of owned cells
    fv::Expression stiffness;
    bool along_normal = false;
    /// Fixed displacement by component. If all components of a part are known, it holds its faces; `value`
    /// also holds their vertices.
    bool by_component = false;
    Vec3 known_components = Vec3::Zero(), normal = Vec3::Zero();
    // Loads given by their total.
    std::optional<DistributedForce> distributed;
    std::optional<BearingLoad> bearing;
    std::optional<HydrostaticPressure> liquid;
    bool is_rigid = false, presses = false;
    bool has_pressure() const { return presses || liquid; }
    /// True if its traction or pressure varies in space.
    bool varies() const;
    /// Pressure at a place, with the height of the free surface of a liquid [Pa].
    double pressure_at(const Vec3& x, double level, double t) const;
  };
  Condition make_condition(const SolidCondition& from, const std::string& where) const;
  void choose_faces(const mesh::Patch& patch, const SolidBoundary& boundary);
  void make_load(Condition& condition, const SolidCondition& from, const std::string& where) const;
  void make_point_loads(const SolidParameters& parameters);
  void add_varying_forces(const Condition& condition, double t, std::span<double> forces) const;
  fv::FaceMean mean_over(Index face, const std::function<Vec3(const Vec3&)>& load) const;
  elastic::BoundaryRow row_at(const Condition& condition, Index face) const;
  const Condition& at(Index entry) const { return conditions_[condition_of_face_[entry]]; }

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  bool is_ring_;
  std::vector<Condition> conditions_;
  std::vector<Index> condition_of_face_;  // per local boundary face; -1 if bonded
  std::vector<std::uint8_t> holds_;       // per patch
  std::vector<std::string> interface_patches_;
  std::vector<DistributedForce> point_loads_;
};

/// Known values of the operator in the order of its columns: displacements of vertices and faces, far ends of
/// springs.
class PrescribedDisplacement {
 public:
  PrescribedDisplacement(const mesh::Mesh& mesh, const SolidBoundaries& boundaries,
                         const elastic::ElasticOperator& elastic);

  std::size_t size() const { return size_; }
  bool is_zero() const { return groups_.empty(); }
  bool uses_time() const { return uses_time_; }
  /// Evaluates dim values per known column.
  void evaluate(double t, std::span<double> values) const;
  /// Throws Error if two conditions prescribe different displacements at a common point at time t. `values`:
  /// those of evaluate(). Collective.
  void check(double t, std::span<const double> values) const;
  /// Evaluates the time derivative by a central difference over 2e-3 dt.
  void evaluate_rate(double t, double dt, std::span<double> values) const;

 private:
  struct Group {  // all columns with values from one condition
    const std::vector<fv::Expression>* value;
    std::vector<Index> columns;
    std::vector<Vec3> places;
    std::vector<Tensor3> shares;  // one per place, after the places without (whose share is I)
  };
  /// Point with a known displacement that another condition prescribes, too.
  struct Shared {
    Index column;
    Vec3 place;
    Tensor3 along;  // directions that both prescribe
    const SolidBoundaries::Condition* condition;
    Index patch, other;  // of the known value, of `condition`
  };
  const mesh::Mesh* mesh_;
  std::vector<Shared> shared_;
  int dim_;
  std::size_t size_ = 0;
  bool uses_time_ = false;
  std::vector<Group> groups_;
};

}  // namespace couplet::solid
