// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/boundary/boundaries.hpp"
#include "solid_solver/boundary/loads.hpp"
#include "solid_solver/boundary/seat.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"
#include "solid_solver/equilibrium/finite_strain.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thermal/thermal_load.hpp"

namespace couplet::solid {

class UpdatedLagrangian;

/// A displacement, velocity etc. in all local cells, boundary faces and points, `dim` values each.
struct BodyField {
  std::span<const double> cells, faces, points;
};

/// Deformable body: mesh, material law, operator, boundary rows and loads except those of the interface. Has no time.
class SolidBody final {
 public:
  /// Throws Error for an invalid case. Collective over mesh.comm.
  SolidBody(mesh::LoadedMesh body, SolidParameters parameters);
  SolidBody(const SolidBody&) = delete;
  SolidBody& operator=(const SolidBody&) = delete;

  const mesh::Mesh& mesh() const { return mesh_; }
  /// Geometry of the undeformed body.
  const mesh::Geometry& geometry() const { return geometry_; }
  const SolidParameters& parameters() const { return parameters_; }
  const std::vector<SolidMaterial>& materials() const { return materials_; }
  const SolidBoundaries& boundaries() const { return boundaries_; }
  const elastic::ElasticOperator& elastic() const { return elastic_; }
  /// Rows of elastic() with the selected face gradient.
  const elastic::ElasticKernel& kernel() const { return kernel_; }
  /// Equilibrium equations; at small strain they use kernel().
  Equilibrium& equilibrium() const { return *equilibrium_; }
  /// Equilibrium at large strain; nullptr at small strain.
  LargeStrain* large_strain() const { return large_strain_; }
  /// Equilibrium that Newton's method solves by its tangent; nullptr for another one.
  FiniteStrain* finite_strain() const { return finite_strain_; }
  /// Equilibrium of the updated Lagrangian method, whose reference moves from step to step; nullptr for another one.
  UpdatedLagrangian* updated_lagrangian() const { return updated_lagrangian_; }
  /// Path whose load factor is an unknown; nullptr for fixed loads.
  LoadPath* load_path() const { return finite_strain_ ? finite_strain_->load_path() : nullptr; }
  /// Patches that move as rigid bodies.
  const RigidPatches& rigid() const { return rigid_; }
  /// Rigid seat that its faces may touch; nullptr if there is none.
  const Seat* seat() const { return seat_.get(); }
  const PrescribedDisplacement& prescribed() const { return prescribed_; }
  /// Load of the temperature, and the temperature itself; nullptr if the case has none.
  ThermalLoad* thermal() const { return thermal_.get(); }
  TemperatureField* temperature() const { return thermal_ ? &thermal_->temperature() : nullptr; }
  /// True if the kernel has its own mass, so that all its nodes have inertia.
  bool has_mass() const { return has_mass_; }
  bool is_dynamic() const { return parameters_.analysis == SolidParameters::Analysis::dynamic; }
  /// True if the acceleration is written or probed and must be stored.
  bool wants_acceleration() const;
  /// [kg/m^3]
  double density(Index cell) const { return materials_[mesh_.material_of(cell)].density; }

  /// Sets the temperature-dependent elastic constants. Returns true if data made for the old ones are invalid. Collective.
  bool apply_stiffness();
  /// Loads of the boundaries at time t that are no pressures of the equilibrium, see SolidBoundaries::add_forces().
  std::vector<double> dead_loads(double t) const;
  /// See FiniteStrain::lowest_stiffness(); without a tangent the stiffness of the body at rest. Collective.
  double lowest_stiffness(std::span<const double> unknowns, std::span<const double> known) const;
  /// Smooth forces on the rows of elastic() without symmetry, equal on any number of ranks. Start vector of a
  /// search for a soft motion. Collective.
  std::vector<double> any_start() const;
  /// Sets the factor of all loads except prescribed displacements.
  void set_load_factor(double factor) { load_factor_ = factor; }
  /// Sets the follower pressures at time t in the equilibrium. Collective.
  void place_pressures(double t) const {
    if (large_strain_) large_strain_->set_pressure(scaled(boundaries_.pressures(t)));
  }
  /// Sets the thermal strains at time t in the equilibrium (large strain). Collective.
  void place_expansion(double t) const;
  bool has_body_forces() const { return !body_force_.empty() || !parameters_.gravity.empty(); }
  /// Body forces and weight of the owned cells, moved by `shift`, at time t [N], `dim` values each; empty if there are none.
  std::vector<double> body_forces(double t, const Vec3& shift = Vec3::Zero()) const;
  /// Acceleration of the known columns over [start, start + dt], dim values each; empty at rest. Uses the
  /// change of velocity, not second differences, so that its work equals the growth of kinetic energy.
  std::vector<double> known_acceleration(double start, double dt) const;
  /// Change of displacement divided by dt; empty if they are at rest.
  std::vector<double> known_velocity(double start, double dt) const;

  /// Unknowns of elastic() in these fields.
  std::vector<double> unknowns_of(std::span<const double> cells, std::span<const double> faces) const;
  /// Known columns of elastic() in this field.
  std::vector<double> known_of(const BodyField& field) const;
  /// Values at all local points; `known`: one value per known column. Collective.
  std::vector<double> to_points(std::span<const double> cells, std::span<const double> faces,
                                std::span<const double> known) const;
  /// Values at these points by the interpolation of the operator, without communication.
  std::vector<double> at_points(std::span<const Index> points, std::span<const double> cells,
                                std::span<const double> faces, std::span<const double> known) const;
  /// Gradients of all flux faces. Collective.
  void visit_gradients(const BodyField& field, const elastic::ElasticKernel::TakeGradient& take) const;
  /// Gradients of the flux faces first, first + 1, ... (`count` of them). Collective.
  std::vector<Tensor3> face_gradients(Index first, Index count, const BodyField& field) const;

 private:
  void check_supports() const;
  void make_equilibrium();
  void find_mass();
  void make_seat();
  std::vector<double> scaled(std::vector<double> values) const;

  const mesh::Mesh mesh_;
  const mesh::Geometry geometry_;
  const SolidParameters parameters_;
  const std::vector<SolidMaterial> materials_;
  SolidBoundaries boundaries_;
  elastic::ElasticOperator elastic_;
  elastic::ElasticKernel kernel_;
  std::unique_ptr<Equilibrium> equilibrium_;
  LargeStrain* large_strain_ = nullptr;  // equilibrium_ by its kind, see above
  FiniteStrain* finite_strain_ = nullptr;
  UpdatedLagrangian* updated_lagrangian_ = nullptr;
  std::unique_ptr<Seat> seat_;
  bool has_mass_ = false;
  double load_factor_ = 1;
  mutable std::vector<double> dead_loads_;  // at the last time asked for, without the factor
  mutable double time_of_dead_loads_ = std::numeric_limits<double>::quiet_NaN();
  PrescribedDisplacement prescribed_;
  RigidPatches rigid_;
  std::vector<fv::Expression> body_force_;
  std::unique_ptr<ThermalLoad> thermal_;  // nullptr if there is no temperature
};

}  // namespace couplet::solid
