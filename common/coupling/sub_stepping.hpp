// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/io/checkpoint.hpp"

namespace couplet::coupling {

/// A participant that takes several steps of its own within a coupling step, whatever it is: it is put back
/// to state n by save and load in memory before each further pass. Input is taken as a line in time through
/// the values of the last accepted step and those at hand (waveform: linear), so that the coupling keeps its
/// second order, or as constant. Of what it gives, amounts (N, W) are means over its steps, all else is the
/// last. With one step a coupling step (the rule) it hands everything through and keeps nothing.
class SubStepping final : public Participant {
 public:
  explicit SubStepping(Participant& inner) : inner_(inner) {}
  /// Steps within a coupling step; to be known before load.
  void set(int steps) { steps_ = steps; }

  Interface initialise() override;
  double suggest_dt() override { return steps_ * inner_.suggest_dt(); }
  void begin_step(const Step& step) override;
  Exchange solve(const Exchange& in) override;
  bool answered_anew() const override { return inner_.answered_anew(); }
  StepReport accept_step() override;
  void save(io::CheckpointWriter& file) const override;
  void load(io::CheckpointReader& file) override;
  void write_output(double time, int number) override { inner_.write_output(time, number); }
  void write_monitors(double time) override { inner_.write_monitors(time); }
  std::vector<std::string> finish() override { return inner_.finish(); }

 private:
  Exchange input_at(double share) const;
  void back_to_start();
  bool is_mean(const std::string& name) const;

  Participant& inner_;
  int steps_ = 1;
  Step step_;
  std::vector<Interface::Datum> takes_, gives_;
  std::map<Interface::Place, std::pair<std::vector<GlobalIndex>, std::size_t>>
      places_;                     // numbers and how many, here
  io::StateInMemory start_;        // state n
  bool has_start_ = false;         // it is in start_
  mutable bool moved_on_ = false;  // the participant has accepted steps beyond it
  Exchange before_, given_;        // input of the accepted step before, of the pass under way
  long iterations_ = 0;
};

/// Values of a datum within a step, of participants that subdivide it: in an Exchange they stand beside the values at
/// its end by the name "datum@share", share of the step in (0, 1), for example "displacement@0.25". A participant that
/// asks for them announces "datum@" beside "datum" (docs/protocol.md).
struct WithinStep {
  static constexpr char mark = '@';
  static std::string name(const std::string& datum, double share);
  /// The datum and the share that a name stands for; nothing if it is no such name.
  static std::optional<std::pair<std::string, double>> parse(std::string_view name);
};

/// Calls visit(share, name, values) for the values of a datum within the step.
template <class Visit>
void for_within(const Exchange& data, const std::string& datum, Visit visit) {
  const std::string begins = datum + WithinStep::mark;
  for (auto it = data.lower_bound(begins); it != data.end() && it->first.starts_with(begins); ++it)
    if (const auto found = WithinStep::parse(it->first); found && found->first == datum)
      visit(found->second, it->first, it->second);
}

}  // namespace couplet::coupling
