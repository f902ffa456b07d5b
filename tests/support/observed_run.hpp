// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "common/io/checkpoint.hpp"
#include "tests/support/test.hpp"

namespace couplet::support {

/// A participant that runs alone, with the diagnostics of its program.
template <class Participant>
class ObservedRun {
 public:
  explicit ObservedRun(Participant& participant)
      : participant_(participant), diagnostics_(0, diagnostics::When::in_full) {
    participant.initialise();
    add_diagnostics(participant.view(), diagnostics_);
  }
  /// Takes `steps` of length dt; `to_end`: the last of them is the last one of the run.
  void advance(int steps, double dt, bool to_end = true) {
    for (int i = 0; i < steps; ++i, ++number_) {
      participant_.begin_step({.time = number_ * dt,
                               .dt = dt,
                               .scheme = coupling::Scheme::standalone,
                               .number = number_,
                               .is_last = to_end && i + 1 == steps});
      participant_.solve({});
      participant_.accept_step();
      diagnostics_.accepted((number_ + 1) * dt);
    }
    if (to_end) sentences_ = diagnostics_.conclude(false);
  }
  /// Goes on from where an earlier run of the same scene is now.
  void resume(ObservedRun& earlier) {
    io::StateInMemory memory;
    io::CheckpointWriter writer(memory);
    earlier.participant_.save(writer);
    io::Archive saved(writer);
    earlier.diagnostics_.visit(saved);
    writer.close();
    io::CheckpointReader reader(memory);
    participant_.load(reader);
    io::Archive loaded(reader);
    diagnostics_.visit(loaded);
    number_ = earlier.number_;
  }
  /// The worst finding of this id, sound or not; a test fails where there is none.
  diagnostics::Finding finding(const std::string& id) const {
    for (const diagnostics::Finding& f : diagnostics_.findings())
      if (f.id == id) return f;
    ADD_FAILURE() << "no finding '" << id << "'";
    return {};
  }
  /// Ids of the findings that are no notes.
  std::vector<std::string> doubts() const {
    std::vector<std::string> ids;
    for (const diagnostics::Finding& f : diagnostics_.findings())
      if (f.severity > base::Severity::note) ids.push_back(f.id);
    return ids;
  }
  const std::vector<std::string>& sentences() const { return sentences_; }
  const diagnostics::Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  Participant& participant_;
  diagnostics::Diagnostics diagnostics_;
  GlobalIndex number_ = 0;
  std::vector<std::string> sentences_;
};

/// Findings of `steps` steps of length dt.
template <class Participant>
ObservedRun<Participant> observe(Participant& participant, int steps, double dt) {
  ObservedRun run(participant);
  run.advance(steps, dt);
  return run;
}

}  // namespace couplet::support
