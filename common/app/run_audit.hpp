// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/effects/position.hpp"

namespace couplet::app {

/// A verdict that is not sound as a finding.
void report(int rank, double time, const effects::EffectVerdict& verdict);

/// Asks a participant during its run what it left out. What has become unsound is a finding (common/log/finding.hpp), told
/// at once.
class RunAudit {
 public:
  RunAudit(int rank, const coupling::Participant& participant)
      : rank_(rank),
        participant_(participant),
        placed_(dynamic_cast<const effects::KnowsItsPlace*>(&participant)) {}
  /// After an accepted step. Asks at outputs, after 1, 2, 4, 8 ... steps and after each hundredth: a part of a
  /// per cent of a run, and early where it matters most. Collective.
  void accepted(double time, bool output);
  /// Asks a last time; a line for each verdict, the worst of the run. `with_sound`: else only those that were not: of a run
  /// that failed, what was seen until then proves nothing sound. Collective.
  std::vector<std::string> closing_lines(bool with_sound = true);
  /// What that makes of the answer, by the worst of the run: for the error budget.
  effects::ModelError model() const { return effects::model_error(trail_.worst()); }
  /// Where the run stands on the maps of its physics, the nearest to each limit that was seen.
  const std::vector<effects::Coordinate>& position() const { return position_; }

 private:
  void look(bool end = false);

  int rank_;
  const coupling::Participant& participant_;
  const effects::KnowsItsPlace* placed_;  // null: by its verdicts alone
  long steps_ = 0;
  double time_ = 0;
  effects::AuditTrail trail_;
  std::vector<effects::Coordinate> position_;
};

}  // namespace couplet::app
