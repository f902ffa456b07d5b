// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/body/stress_recovery.hpp"

namespace couplet::solid {

/// Force on the solid at a constrained patch [N] and its moment about the origin [N m]. Moment arms are
/// undeformed at small strain and deformed at large strain.
struct PatchForce : elastic::Wrench {
  std::string patch;
};

/// Largest gradient, strain and rotation of a displacement over the faces; NaN if unknown.
struct Deformation {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double gradient = unknown;  ///< Frobenius norm
  double strain = unknown;    ///< likewise
  double rotation = unknown;  ///< angle [rad]
};

/// Fields derived from the accepted state. `points`: result of point_displacement(). All functions are collective.
class SolidFields final {
 public:
  /// Keeps references. `last`: contains the loads for the forces.
  SolidFields(const SolidBody& body, const SolidState& state, const LastSolve& last);

  /// Values at all local points.
  std::vector<double> point_displacement() const;
  std::vector<double> point_velocity() const;
  /// Requires wants_acceleration().
  std::vector<double> point_acceleration() const;
  /// On each side of the joints of materials: at small strain recovered from patches of cells (StressRecovery), else interpolated from the
  /// stress in the cells and on the boundary faces. `wanted`: flags of local points, empty means all; others may hold anything.
  SidedTensors stress_sides(std::span<const double> points, std::span<const std::uint8_t> wanted = {}) const;
  /// The recovery of a body with recovers_stress(), and what it starts from.
  const StressRecovery& recovery() const;
  DiscreteStress discrete_stress(std::span<const double> points) const;
  std::vector<double> point_stress(std::span<const double> points) const {
    return worst_side(stress_sides(points));
  }
  /// On boundary faces of owned cells, `dim` values each, out of the body [Pa]: as the loads have it where it is known (at
  /// small strain), else sigma n of the mean of `sides` of its cell's material over the face's points, of which those on a patch
  /// suffice for its faces. `places`: positions of the local points; the normal is that of the deformed face at large strain.
  std::vector<double> traction(std::span<const Vec3> places, const SidedTensors& sides) const;
  SidedTensors strain_sides(std::span<const double> points) const;
  /// Stress of the local faces first, first + 1, ... (`count` of them) [Pa].
  std::vector<Tensor3> face_stress(Index first, Index count, std::span<const double> points) const;
  /// Stress of owned cells [Pa] by cell_gradient(); exact for linear displacements.
  std::vector<Tensor3> cell_stress(std::span<const double> points) const;
  /// Strains of faces and cells, as for the stress.
  std::vector<Tensor3> face_strain(Index first, Index count, std::span<const double> points) const;
  std::vector<Tensor3> cell_strain(std::span<const double> points) const;
  /// Forces on the solid at fixed and symmetry patches, from the stress.
  std::vector<PatchForce> reactions(std::span<const double> points) const;
  /// Sum of all loads of the last solve: tractions, pressures, interface, body forces.
  Vec3 total_load() const;
  Deformation deformation(std::span<const double> points) const;
  /// Loads at the accepted time; the interface's are those of the last solve.
  elastic::ElasticLoads loads_now() const;

 private:
  BodyField displacement(std::span<const double> points) const {
    return {state_.cell_u, state_.face_u, points};
  }
  std::vector<double> known_acceleration() const;
  std::vector<Tensor3> cell_gradient(std::span<const double> points) const;
  const PointTensors& point_tensors() const;
  std::vector<SurfaceTraction> known_tractions() const;
  std::vector<PatchForce> reactions_by_trial_functions() const;
  Displaced displaced(std::span<const double> points) const;

  const SolidBody& body_;
  const SolidState& state_;
  const LastSolve& last_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const SolidParameters& parameters_;
  const elastic::ElasticOperator& elastic_;
  mutable std::unique_ptr<PointTensors> point_tensors_;  // created on first use
  mutable std::unique_ptr<StressRecovery> recovery_;     // likewise
};

/// True if the stress at points is recovered: at small strain, except for a body of revolution.
bool recovers_stress(const SolidBody& body);

}  // namespace couplet::solid
