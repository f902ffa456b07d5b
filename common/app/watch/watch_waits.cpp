// SPDX-License-Identifier: Apache-2.0
#include "common/app/watch/watch_waits.hpp"

#include <cstdio>
#include <cstring>

#include "common/app/watch/watch_board.hpp"
#include "common/coupling/wait.hpp"

namespace couplet::app::watching {
namespace {

constexpr double patience = 4;   // [s] that nothing changes while all wait, each for more than a second
constexpr double is_recent = 2;  // [s]: whoever waits looks four times a second

/// Since when all wait for the same as now; 0: not all do.
struct Stillness {
  double since = 0, sum = 0;  // sum: of the times at which the waits began, which tells them from later ones
};

/// The sum of Stillness, or 0 if somebody does not wait.
double all_wait(double t) {
  double sum = 0;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending || slot.terminating) return 0;
    if (slot.finished) continue;
    if (slot.waits_since == 0 || t - slot.looked > is_recent) return 0;
    sum += slot.waits_since;
  }
  return sum;
}

[[noreturn]] void name_the_circle() {
  Line line;
  line << "couplet: deadlock: all programs of the job wait for each other: ";
  const char* separator = "";
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.finished || slot.rank > 0) continue;
    line << separator << "'" << slot.participant << "' waits for "
         << (slot.waits_for[0] ? slot.waits_for : "the next command");
    separator = "; ";
  }
  line << ". All programs of the job end.\n";
  std::fflush(nullptr);
  end_job_with(line);
}

void lasts(const char* what) {
  static Stillness still;
  Slot& slot = board.slots[board.mine];
  const double t = now();
  if (slot.waits_since == 0) {
    std::strncpy(slot.waits_for, what, sizeof slot.waits_for - 1);
    slot.waits_since = t;
  }
  slot.looked = slot.alive = t;
  if (!board.whole_job || board.has_guests || board.count < 2) return;
  const double sum = all_wait(t);
  if (sum == 0 || sum != still.sum)
    still = {t, sum};
  else if (t - still.since > patience)
    name_the_circle();
}

void over() { board.slots[board.mine].waits_since = 0; }

}  // namespace

void watch_waits() {
  if (board.slots) coupling::observe_waits({lasts, over});
}

}  // namespace couplet::app::watching
