// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"

namespace couplet::solid {

/// Start and end states of a stage, and its solution. Energies are accumulated in `after`.
struct SolvedStage {
  const StageWork& work;
  const LastSolve& last;
  const SolidState& before;
  SolidState& after;
};

/// Computes energies of a body and work done on it; stores none. Sums are over this rank unless stated.
class SolidLedger final {
 public:
  /// Keeps a reference.
  explicit SolidLedger(const SolidBody& body);

  /// Kinetic energy [J].
  double kinetic(const SolidState& state) const;
  /// Energy in the springs of the seat, and its initial value; over all ranks [J]. Collective.
  double contact(const SolidState& state) const;
  double initial_contact() const;
  /// Kinetic energy of the initial state, with the support velocities of the first step [J].
  double initial_kinetic(const SolidState& start, double dt) const;
  /// Energies over all ranks; requires output.energies. `points`: displacement there. Collective.
  SolidEnergies total(const SolidState& state, std::span<const double> points) const;
  /// Adds work, damping loss and final kinetic energy of a stage. Collective.
  void add_work(const SolvedStage& stage) const;
  /// Adds the work of body forces, tractions, pressures and interface over a stage, for the audit. Work of
  /// moving supports and effects is not counted, so there is no audit then. `before`: cells and faces at the
  /// start of the stage.
  void add_load_work(const StageWork& work, const LastSolve& last, const BodyField& before,
                     SolidState& after) const;

 private:
  double kinetic(const SolidState& state, std::span<const double> known_rate) const;
  double stress_work(const BodyField& stressed, const BodyField& change, double* on_boundary) const;
  /// Internal and external work and damping loss [J].
  struct Work {
    double inside = 0, outside = 0, loss = 0;
  };
  Work face_work(const SolvedStage& stage) const;
  Work symmetric_work(const SolvedStage& stage) const;
  Work finite_work(const SolvedStage& stage) const;
  std::vector<double> change_over(const SolvedStage& stage) const;
  std::vector<double> mean_of_ends(const StageWork& work, const std::vector<double>& at_place) const;
  double known_work(const SolvedStage& stage) const;
  SolidEnergies summed(SolidEnergies local) const;

  const SolidBody& body_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const SolidParameters& parameters_;
  const SolidDamping damping_;
  const elastic::ElasticOperator& elastic_;
  const elastic::ElasticKernel& kernel_;
};

}  // namespace couplet::solid
