// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/coupling/error_parts.hpp"
#include "common/coupling/participant.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/io/fields/field_writer.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/effects/effect_cards.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Something beside linear elasticity that loads the solid (thermal strain, ...). A scene has those that its
/// YAML asks for; Solid keeps them in a list and calls them in its order. As for a Participant, only
/// accept_step() changes the accepted state.
class SolidEffect {
 public:
  virtual ~SolidEffect() = default;
  /// A step from t^n is tried: an effect with equations of its own solves them here. Throws SolveFailure.
  virtual void begin_step(const coupling::Step& /*step*/) {}
  /// Elastic constants that the operator must get for the step now tried, one a local cell; empty: its own
  /// hold. The same answer on all ranks.
  virtual std::span<const elastic::LameConstants> stiffness() const { return {}; }
  /// The operator has got other constants since the last call. Collective.
  virtual void stiffness_changed() {}
  /// Adds its forces [N] at time t within the step to the rows of the kernel.
  virtual void add_loads(double t, const elastic::ElasticKernel& kernel, std::span<double> rhs) = 0;
  /// The stress - p I it stands for at time t, p [Pa] per local face; empty: none.
  virtual std::vector<double> pressure(double /*t*/) { return {}; }
  virtual void accept_step() {}
  /// An effect that wants_temperature() gets the centres of this rank's faces of the interface once, and what was given
  /// at these at the start of each solve (empty: nothing yet); begin_step() follows. Collective.
  virtual bool wants_temperature() const { return false; }
  virtual void set_interface(const std::vector<Vec3>& /*face_centres*/, const std::vector<Index>& /*faces*/) {
  }
  virtual void take_temperature(const std::vector<double>& /*faces*/) {}
  /// An effect that wants_stress() gets that of the owned cells after each accepted step [Pa].
  virtual bool wants_stress() const { return false; }
  virtual void take_stress(std::span<const Tensor3> /*stress*/) {}
  virtual void save(io::CheckpointWriter& /*file*/) const {}
  virtual void load(io::CheckpointReader& /*file*/) {}
  /// Adds its part of the stress of owned cells at the accepted time [Pa].
  virtual void add_cell_stress(std::span<Tensor3> /*stress*/) const {}
  /// Adds its part of the stress of the local faces first, first + 1, ... at the accepted time [Pa].
  virtual void add_face_stress(Index /*first*/, std::span<Tensor3> /*stress*/) const {}
  /// Appends fields at the accepted time; their values must live until the next call.
  virtual void add_fields(std::vector<io::OutputField>& /*fields*/) {}
  /// Appends fields of the boundary at the accepted time: of all local points, or (place "cells") of the boundary faces of
  /// owned cells; their values must live until the next call. Collective.
  virtual void add_surface_fields(std::vector<io::OutputField>& /*fields*/) {}
  /// Adds what it has seen, for the verdicts on what was left out. Collective.
  virtual void add_evidence(SolidEvidence& /*evidence*/) const {}
  /// Before the first step, if the run is to end with an estimate of its error; else nothing is collected.
  virtual void collect_errors() {}
  /// Of what it loads the solid with, over the size of that. Collective.
  virtual coupling::ErrorParts error_parts() const { return {}; }
  /// For Participant::finish(), beside the verdicts of the cards.
  virtual void judge(std::vector<std::string>& /*sentences*/) const {}
  /// The strain of the free body that it stands for at time t, one a local flux face; where the equilibrium takes it so
  /// (large strain): add_loads() and the stresses have nothing of it then. Empty: none.
  virtual std::vector<double> expansion(double /*t*/) { return {}; }
};

/// The effects the parameters ask for; none: an empty list.
std::vector<std::unique_ptr<SolidEffect>> make_effects(const mesh::Mesh& mesh,
                                                       const elastic::ElasticOperator& elastic,
                                                       const SolidParameters& parameters);

}  // namespace couplet::solid
