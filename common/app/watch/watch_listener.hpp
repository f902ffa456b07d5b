// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/app/watch/watch_board.hpp"

namespace couplet::app::watching {

/// What one process notices of the others' silence, look by look.
class Listener {
 public:
  explicit Listener(double patience);
  /// Between two looks [s]: a 120th of the patience, 5 s at most.
  double period() const { return period_; }

  /// Ends the job if a process is silent: it is stopped, or nothing has been heard of it although it is not one that
  /// waits. The coupler is named only if nobody else can be.
  void look();

 private:
  /// Processor time of a process in work that gives no sign, and when it last went on.
  struct Work {
    double seconds = 0, since = 0;  // since 0: it does no such work
  };
  void hear(int i);
  bool is_asleep(int i) const;
  bool is_silent(int i) const;
  void speak(bool any_asleep, bool any_busy) const;

  double patience_, period_, last_look_, started_;
  std::vector<double> asleep_since_;  // 0: awake
  std::vector<Work> work_;
};

}  // namespace couplet::app::watching
