// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/boundary/boundaries.hpp"
#include "solid_solver/boundary/rigid_patches.hpp"
#include "solid_solver/boundary/seat.hpp"
#include "solid_solver/equilibrium/equilibrium.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thermal/thermal_strain.hpp"

namespace couplet::solid {

/// A displacement (or velocity, ...) in all local cells, boundary faces and points, `dim` values each.
struct BodyField {
  std::span<const double> cells, faces, points;
};

/// What is deformed and how it resists: mesh, material law, operator, boundary rows, loads that do not come
/// through the interface. It has no time of its own.
class SolidBody final {
 public:
  /// Throws Error for a scene that cannot be. Collective over mesh.comm.
  SolidBody(mesh::LoadedMesh body, SolidParameters parameters);
  SolidBody(const SolidBody&) = delete;
  SolidBody& operator=(const SolidBody&) = delete;

  const mesh::Mesh& mesh() const { return mesh_; }
  /// Of the undeformed body.
  const mesh::Geometry& geometry() const { return geometry_; }
  const SolidParameters& parameters() const { return parameters_; }
  const std::vector<SolidMaterial>& materials() const { return materials_; }
  const SolidBoundaries& boundaries() const { return boundaries_; }
  const elastic::ElasticOperator& elastic() const { return elastic_; }
  /// The rows of elastic() with the face gradient that was chosen.
  const elastic::ElasticKernel& kernel() const { return kernel_; }
  /// How it resists, at small strain by kernel().
  Equilibrium& equilibrium() const { return *equilibrium_; }
  /// Patches that move as rigid bodies.
  const RigidPatches& rigid() const { return rigid_; }
  /// What its faces may meet; null: nothing.
  const Seat* seat() const { return seat_.get(); }
  const PrescribedDisplacement& prescribed() const { return prescribed_; }
  /// Temperature and the load it makes; nullptr if the scene has no temperature.
  ThermalStrain* thermal() const { return thermal_.get(); }
  /// The kernel has its own mass, and all its nodes inertia.
  bool has_mass() const { return has_mass_; }
  bool is_dynamic() const { return parameters_.analysis == SolidParameters::Analysis::dynamic; }
  bool is_corrected() const { return kernel_.scheme() == elastic::FaceGradientScheme::corrected; }
  /// The acceleration is written or watched, so that it is kept.
  bool wants_acceleration() const;
  /// [kg/m^3]
  double density(Index cell) const { return materials_[mesh_.material_of(cell)].density; }

  /// Takes the elastic constants that the temperature has changed; true if all that was made for the old ones is
  /// of no use any more. Collective.
  bool apply_stiffness();
  /// Adds the loads of the boundaries at time t that the equilibrium does not take as pressures, as SolidBoundaries does.
  void add_dead_loads(double t, std::span<double> forces) const { add_scaled_loads(t, forces); }
  /// See Equilibrium::lowest_stiffness(). Collective.
  SoftMotion softest_motion(std::span<const double> unknowns, std::span<const double> known) const;
  /// Forces on the rows of elastic() without symmetry, smooth and the same on any number of ranks: the start of a search
  /// for a soft motion. Collective.
  std::vector<double> any_start() const;
  /// By which all loads but prescribed displacements are multiplied from here on.
  void set_load_factor(double factor) { load_factor_ = factor; }
  /// It knows the pressures at time t that follow the surface. Collective.
  void place_pressures(double t) const {
    if (equilibrium_->means().takes_pressure) equilibrium_->set_pressure(scaled(boundaries_.pressures(t)));
  }
  /// It knows the thermal strains at time t that it takes itself: large strain. Collective.
  void place_expansion(double t) const;
  bool has_body_forces() const { return !body_force_.empty() || !parameters_.gravity.empty(); }
  /// Body forces and weight of the owned cells at time t [N], `dim` values each; empty: none.
  std::vector<double> body_forces(double t) const;
  /// Of the known columns over [start, start + dt], one a component; empty: they rest. The change of the velocity,
  /// and not second differences of the displacement: the kinetic energy of the ends then grows by its work.
  std::vector<double> known_acceleration(double start, double dt) const;
  /// The change of the displacement by dt; empty: they rest.
  std::vector<double> known_velocity(double start, double dt) const;

  /// The unknowns of elastic() in these fields.
  std::vector<double> unknowns_of(std::span<const double> cells, std::span<const double> faces) const;
  /// The known columns of elastic() in this field.
  std::vector<double> known_of(const BodyField& field) const;
  /// Values at all local points; `known`: one a known column. Collective.
  std::vector<double> to_points(std::span<const double> cells, std::span<const double> faces,
                                std::span<const double> known) const;
  /// At these points by the interpolation of the operator, which needs no exchange.
  std::vector<double> at_points(std::span<const Index> points, std::span<const double> cells,
                                std::span<const double> faces, std::span<const double> known) const;
  /// Gradients of all flux faces. Collective.
  void visit_gradients(const BodyField& field, const elastic::ElasticKernel::TakeGradient& take) const;
  /// Those of the flux faces first, first + 1, ... (`count` of them). Collective.
  std::vector<Tensor3> face_gradients(Index first, Index count, const BodyField& field) const;

 private:
  void check_supports() const;
  void find_mass();
  void make_seat();
  void add_scaled_loads(double t, std::span<double> forces) const;
  std::vector<double> scaled(std::vector<double> values) const;

  const mesh::Mesh mesh_;
  const mesh::Geometry geometry_;
  const SolidParameters parameters_;
  const std::vector<SolidMaterial> materials_;
  SolidBoundaries boundaries_;
  elastic::ElasticOperator elastic_;
  elastic::ElasticKernel kernel_;
  std::unique_ptr<Equilibrium> equilibrium_;
  std::unique_ptr<Seat> seat_;
  bool has_mass_ = false;
  double load_factor_ = 1;
  PrescribedDisplacement prescribed_;
  RigidPatches rigid_;
  std::vector<fv::Expression> body_force_;
  std::unique_ptr<ThermalStrain> thermal_;  // nullptr: no temperature
};

}  // namespace couplet::solid
