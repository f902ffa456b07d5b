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

/// Everyone who takes part in the coupling, and one pass through them: each is asked with what the others have given, in
/// the order of the schedule. All calls are collective over the coupler's ranks, which do the same with their own parts
/// of the interfaces.
class Pass {
 public:
  /// `channels`: to everyone of the schedule, in any order.
  Pass(MPI_Comm comm, const CouplingParameters& parameters,
       std::vector<std::unique_ptr<coupling::Channel>> channels);

  /// Gets to know all interfaces and links them. Throws Error if they do not fit together.
  void initialise(const CouplingParameters& parameters);
  /// Values before the first step, from those that gave any to those that take them.
  void exchange_initial_values();
  /// Sends one command to everyone.
  void ask_all(const coupling::Command& command);

  /// One pass from what is `known` to what all give. `first`: of the step. Throws SolveFailure if a participant fails.
  std::vector<coupling::Exchange> operator()(std::vector<coupling::Exchange> known, bool first,
                                             coupling::Scheme scheme);
  /// Returns what a pass gave to the channels, for their next replies.
  void give_back(std::vector<coupling::Exchange> given);
  /// Called after each answer in a pass.
  void on_answer(
      std::function<void(std::size_t, const coupling::Exchange& taken, const coupling::Exchange& given)>
          call) {
    answered_ = std::move(call);
  }

  const Schedule& schedule() const { return schedule_; }
  const std::vector<Partner>& partners() const {
    return partners_;
  }  ///< in the order of Schedule::everyone()
  std::vector<Partner*> everyone();
  std::size_t index_of(const std::string& name) const;
  const std::vector<std::size_t>& group() const { return group_; }  ///< indices of those that are iterated
  const std::vector<Side>& sides() const { return sides_; }
  const Links& links() const { return *links_; }
  bool has_closed_fluid() const { return volume_level_.has_value(); }
  VolumeLevel* volume_level() {
    return volume_level_ ? &*volume_level_ : nullptr;
  }  ///< nullptr: no closed fluid
  /// Answer of each in the last pass of the last solved step.
  const std::vector<coupling::Exchange>& given() const { return given_; }
  const std::vector<coupling::Exchange>& taken() const { return taken_; }
  void set_given(std::vector<coupling::Exchange> given) {
    give_back(std::exchange(given_, std::move(given)));
  }
  /// Tells whether somebody began to answer otherwise in the last pass (Participant::answered_anew).
  bool answered_anew() const { return answered_anew_; }

  /// State of the coupling's own parts: levels of closed fluids, displacements of foreign structures.
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  void ask(std::size_t i, const std::vector<coupling::Exchange>& known, bool move_mesh);
  void answer(std::size_t i, coupling::Exchange& given, bool move_mesh);
  std::vector<coupling::Exchange> side_by_side(const std::vector<coupling::Exchange>& known, bool move_mesh);
  void hold_volume(std::size_t i, std::vector<coupling::Exchange>& known);
  void require_finite_answer(std::size_t i, const coupling::Exchange& given) const;

  MPI_Comm comm_;
  Schedule schedule_;
  std::vector<Partner> partners_;
  std::vector<std::size_t> group_;
  std::vector<Side> sides_;
  std::optional<Links> links_;
  std::optional<VolumeLevel> volume_level_;
  std::vector<coupling::Exchange> given_, taken_;
  coupling::Exchange guess_;  // of the motion, which the mover has been given
  bool answered_anew_ = false;
  std::function<void(std::size_t, const coupling::Exchange&, const coupling::Exchange&)> answered_ =
      [](std::size_t, const coupling::Exchange&, const coupling::Exchange&) {};
};

}  // namespace couplet::coupler
