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

/// Chooses the next time step. Nominal steps end at multiples of the nominal dt, the last one at the end
/// time. A failed step is halved. Step sizes grow back after some accepted steps, more slowly after each
/// premature growth. Nominal times are always met. All sizes are the nominal one divided by a power of two,
/// so a solver can reuse few factorizations.
class StepPlan {
 public:
  /// Limit on nominal steps, beyond which times could not be distinguished.
  static constexpr double most_steps = 1e12;

  /// A step is halved at most `max_halvings` times (0 to 30). Throws Error for more than `most_steps`.
  StepPlan(double end_time, double nominal_dt, int max_halvings);

  bool finished() const { return nominal_ >= n_nominal_; }
  double time() const;   ///< t^n [s]
  double dt() const;     ///< of the next step to try; never beyond the next nominal time
  bool is_last() const;  ///< true if the next step to try ends the run
  /// Sets the participants' limit on the next steps, as far as max_halvings allows.
  void limit(double largest_dt) { largest_dt_ = largest_dt; }
  void accepted();
  /// Halves the step. Returns false if it may not be halved any more.
  bool halve();
  /// Returns true right after a nominal step was completed, when outputs and checkpoints are due.
  bool at_nominal_time() const { return tick_ == 0; }
  GlobalIndex steps_accepted() const { return accepted_; }
  int halvings() const { return level(); }

  /// State for checkpoints.
  std::array<double, 6> state() const;
  /// Restores the state at the checkpoint's `time`. The nominal dt may differ from that of the saved run if
  /// `time` is one of the new nominal times; throws Error otherwise.
  void restore(const std::array<double, 6>& state, double time);

 private:
  int level() const;  // current halvings, adapted to the grid of ticks and the participants' limit
  double nominal_time(GlobalIndex i) const;
  double nominal_length() const;  // of the current nominal step [s]

  double end_time_, nominal_dt_;
  int max_halvings_;
  GlobalIndex n_nominal_;
  double largest_dt_;
  GlobalIndex nominal_ = 0;  // nominal steps completed
  long tick_ = 0;            // within the nominal step, in units of length / 2^max_halvings
  int wanted_level_ = 0;
  int calm_ = 0;      // steps accepted since the last failure or growth
  int patience_ = 2;  // calm steps before the next growth
  GlobalIndex accepted_ = 0;
};

/// Participant that takes several steps within a coupling step. It is restored to state n in memory before
/// each further pass. Its input is linear in time between the values of the last accepted step and the
/// current ones, which keeps the coupling second-order. Output amounts (N, W)
/// are means over the sub-steps, other data are taken from the last. With one step per coupling step (the
/// default) it forwards everything and stores nothing.
class SubStepping final : public Participant {
 public:
  explicit SubStepping(Participant& inner) : inner_(inner) {}
  /// Sets the number of steps within a coupling step. Must be called before load.
  void set(int steps) { steps_ = steps; }

  Interface initialise() override;
  double suggest_dt() override { return steps_ * inner_.suggest_dt(); }
  void begin_step(const Step& step) override;
  Exchange solve(const Exchange& in) override;
  bool renewed_prediction() const override { return inner_.renewed_prediction(); }
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
  bool has_start_ = false;         // start_ holds state n
  mutable bool moved_on_ = false;  // the participant has accepted steps beyond it
  Exchange before_, given_;        // input of the last accepted step, of the current pass
  long iterations_ = 0;
};

/// Values of a datum within a step, for participants with sub-steps. An Exchange holds them beside the values
/// at the end of the step as "datum@share" with share in (0, 1), for example "displacement@0.25". A
/// participant requests them by announcing "datum@" beside "datum" (docs/protocol.md).
struct WithinStep {
  static constexpr char mark = '@';
  static std::string name(const std::string& datum, double share);
  /// Datum and share encoded in a name, or nothing if it is not such a name.
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
