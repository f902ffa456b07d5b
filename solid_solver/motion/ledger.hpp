// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_state.hpp"

namespace couplet::solid {

/// Between which states a stage led, and what was solved for it. The sums go into `after`.
struct SolvedStage {
  const StageWork& work;
  const LastSolve& last;
  const SolidState& before;
  SolidState& after;
};

/// Energies of a body and what is done to it; it keeps none. Sums are this rank's unless said.
class SolidLedger final {
 public:
  /// By reference.
  explicit SolidLedger(const SolidBody& body);

  /// [J]
  double kinetic(const SolidState& state) const;
  /// Kept in the springs of the seat, and what it kept when the body was placed; over all ranks [J]. Collective.
  double contact(const SolidState& state) const;
  double initial_contact() const;
  /// Of the state that a run starts from, its supports moving from then on: their rate from the first step's length. [J]
  double initial_kinetic(const SolidState& start, double dt) const;
  /// Energies over all ranks; needs output.energies. `points`: its displacement there. Collective.
  SolidEnergies total(const SolidState& state, std::span<const double> points) const;
  /// Work of a stage, damping and kinetic energy at its end. Collective.
  void add_work(const SolvedStage& stage) const;
  /// Work of body forces, tractions, pressures and the interface over a stage: what the audit holds against
  /// the energy found. Moving supports and effects do work that is not counted; no audit then. `before`: of
  /// cells and faces at the start of the stage.
  void add_load_work(const StageWork& work, const LastSolve& last, const BodyField& before,
                     SolidState& after) const;

 private:
  double kinetic(const SolidState& state, std::span<const double> known_rate) const;
  double stress_work(const BodyField& stressed, const BodyField& change, double* on_boundary) const;
  void add_face_work(const SolvedStage& stage) const;
  void add_symmetric_work(const SolvedStage& stage) const;
  void add_finite_work(const SolvedStage& stage) const;
  std::vector<double> change_over(const SolvedStage& stage) const;
  std::vector<double> mean_of_ends(const StageWork& work, const std::vector<double>& at_place) const;
  double known_work(const SolvedStage& stage) const;
  SolidEnergies summed(SolidEnergies local) const;

  const SolidBody& body_;
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const SolidParameters& parameters_;
  const elastic::ElasticOperator& elastic_;
  const elastic::ElasticKernel& kernel_;
};

}  // namespace couplet::solid
