// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "coupler/acceleration/volume_level.hpp"
#include "coupler/exchange/partners.hpp"
#include "coupler/mapping/links.hpp"
#include "coupler/parameters/parameters.hpp"
#include "coupler/parameters/schedule.hpp"

namespace couplet::coupler {

/// Participants of a coupling, and one pass through them. Each is solved with the data given by the others,
/// in the order of the schedule. All calls are collective over the coupler's ranks, each with its parts of
/// the interfaces.
class Pass {
 public:
  /// `channels`: channels to all participants of the schedule, in any order.
  Pass(MPI_Comm comm, const CouplingParameters& parameters,
       std::vector<std::unique_ptr<coupling::Channel>> channels);

  /// Receives all interfaces and links them. Throws Error if they are incompatible.
  void initialise(const CouplingParameters& parameters);
  /// Transfers values given before the first step.
  void exchange_initial_values();
  /// Sends one command to all participants.
  void command_all(const coupling::Command& command);

  /// Begins a step. The mesh moves in its first pass and, unless the scheme is semi-implicit, in all others.
  void begin_step(const coupling::Step& step);
  /// True until the first pass of a step.
  bool is_first() const { return first_; }
  /// Performs one pass from `data` to new data, valid until the next pass. Throws SolveFailure if a participant
  /// fails.
  const std::vector<coupling::Exchange>& operator()(std::vector<coupling::Exchange> data);
  /// Sets a callback for each participant's solution in a pass.
  void on_solved(
      std::function<void(std::size_t, const coupling::Exchange& taken, const coupling::Exchange& given)>
          call) {
    solved_ = std::move(call);
  }

  const Schedule& schedule() const { return schedule_; }
  /// In the order of Schedule::everyone().
  const std::vector<Partner>& partners() const { return partners_; }
  std::vector<Partner*> everyone();
  std::size_t index_of(const std::string& name) const;
  const std::vector<std::size_t>& group() const { return group_; }  ///< indices of the iterated participants
  const std::vector<Side>& sides() const { return sides_; }
  const Links& links() const { return *links_; }
  /// nullptr if there is no closed fluid.
  VolumeLevel* volume_level() { return volume_level_ ? &*volume_level_ : nullptr; }
  /// Data given by each in the last pass of the last solved step.
  const std::vector<coupling::Exchange>& given() const { return given_; }
  const std::vector<coupling::Exchange>& taken() const { return taken_; }
  void set_given(std::vector<coupling::Exchange> given) { reuse(std::exchange(given_, std::move(given))); }
  /// Ends a solved step: given() are the data of its last pass.
  void keep_outputs() { set_given(std::move(outputs_)); }
  /// True if some participant renewed its prediction in the last pass (Participant::renewed_prediction).
  bool renewed_prediction() const { return renewed_prediction_; }

  /// Saves or loads the coupling's own state: levels of closed fluids, displacements of foreign structures.
  void visit(io::Archive& archive);

 private:
  void send_solve(std::size_t i, const std::vector<coupling::Exchange>& data, bool move_mesh);
  void receive_solution(std::size_t i, coupling::Exchange& given, bool move_mesh);
  std::vector<coupling::Exchange> in_sequence(std::vector<coupling::Exchange> data, bool move_mesh);
  std::vector<coupling::Exchange> side_by_side(const std::vector<coupling::Exchange>& data, bool move_mesh);
  void enforce_volume(std::size_t i, std::vector<coupling::Exchange>& data);
  void require_finite_data(std::size_t i, const coupling::Exchange& given) const;
  /// Returns data to the channels, as buffers for later replies.
  void reuse(std::vector<coupling::Exchange> data);

  MPI_Comm comm_;
  Schedule schedule_;
  std::vector<Partner> partners_;
  std::vector<std::size_t> group_;
  std::vector<Side> sides_;
  std::optional<Links> links_;
  std::optional<VolumeLevel> volume_level_;
  std::vector<coupling::Exchange> given_, taken_, outputs_;  // outputs: of the last pass
  coupling::Exchange guess_;                                 // of the motion, as given to the mover
  coupling::Scheme scheme_ = coupling::Scheme::implicit;     // of the current step
  bool first_ = false, renewed_prediction_ = false;
  std::function<void(std::size_t, const coupling::Exchange&, const coupling::Exchange&)> solved_ =
      [](std::size_t, const coupling::Exchange&, const coupling::Exchange&) {};
};

}  // namespace couplet::coupler
