// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/types.hpp"
#include "common/coupling/participant.hpp"
#include "common/io/checkpoint.hpp"

namespace couplet::coupling {

/// Which step comes next. Nominal steps end at multiples of the nominal dt (the last one at the end time); a
/// step that fails is halved; after a while the halves grow back, later each time that was too early; nominal
/// times are always met. All sizes are the nominal one divided by a power of two, exactly: a solver that
/// keeps a factorised matrix for each dt meets few different ones.
class StepPlan {
 public:
  /// More nominal steps than this are refused: times would no longer be told apart.
  static constexpr double most_steps = 1e12;

  /// max_halvings: a step is halved at most this often (0 to 30). Throws Error for more than `most_steps`.
  StepPlan(double end_time, double nominal_dt, int max_halvings);

  bool finished() const { return nominal_ >= n_nominal_; }
  double time() const;   ///< t^n [s]
  double dt() const;     ///< of the step to try next; never beyond the next nominal time
  bool is_last() const;  ///< whether the step to try next ends the run
  /// Advice of the participants: the next steps are not longer than this if max_halvings allows.
  void limit(double largest_dt) { largest_dt_ = largest_dt; }
  void accepted();
  /// False if the step may not be halved any more.
  bool halve();
  /// True right after a nominal step was completed (outputs and checkpoints are made then).
  bool at_nominal_time() const { return tick_ == 0; }
  GlobalIndex steps_accepted() const { return accepted_; }
  int halvings() const { return level(); }

  /// For checkpoints.
  std::array<double, 6> state() const;
  /// `time`: the checkpoint's. The nominal dt may differ from that of the run that was saved if `time` is one
  /// of the new nominal times; throws Error otherwise.
  void restore(const std::array<double, 6>& state, double time);

 private:
  int level() const;  // halvings in force, made to fit the grid of ticks and the advice
  double nominal_time(GlobalIndex i) const;
  double nominal_length() const;  // of the nominal step under way [s]

  double end_time_, nominal_dt_;
  int max_halvings_;
  GlobalIndex n_nominal_;
  double largest_dt_;
  GlobalIndex nominal_ = 0;  // nominal steps completed
  long tick_ = 0;            // within the nominal step, in units of length / 2^max_halvings
  int wanted_level_ = 0;
  int calm_ = 0;      // steps accepted since the last failure or growth
  int patience_ = 2;  // so many calm steps before the next growth
  GlobalIndex accepted_ = 0;
};

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
  // Numbers and how many, here.
  std::map<Interface::Place, std::pair<std::vector<GlobalIndex>, std::size_t>> places_;
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
