// SPDX-License-Identifier: Apache-2.0
#include "common/app/watch/watch_listener.hpp"

#include <algorithm>

namespace couplet::app::watching {
namespace {

/// Of the time since the last sign a busy process spends at least this share on a processor.
constexpr double least_share = 1e-3, least_seconds = 0.02;

bool is_coupler(const Slot& slot) { return std::string_view(slot.participant) == "coupler"; }

/// Processor time is its sign of life.
bool works_long(const Slot& slot) {
  switch (Phase(slot.phase.load())) {
    case Phase::initialise:
    case Phase::output:
    case Phase::save:
    case Phase::load:
    case Phase::finalise:
      return true;
    default:
      return slot.long_work > 0;
  }
}

}  // namespace

Listener::Listener(double patience)
    : patience_(patience),
      period_(std::clamp(patience / 120, 0.05, 5.)),
      last_look_(now()),
      started_(last_look_),
      asleep_since_(std::size_t(board.count), 0.),
      work_(std::size_t(board.count)) {}

void Listener::look() {
  const double t = now();
  // Whoever was stopped himself has heard nothing of anybody.
  if (t - last_look_ > 1 + 2 * period_) {
    started_ = t;
    std::fill(asleep_since_.begin(), asleep_since_.end(), 0.);
  }
  last_look_ = t;
  bool any_asleep = false, any_drowsy = false, any_busy = false;
  for (int i = 0; i < board.count; ++i) {
    const Slot& slot = board.slots[i];
    if (slot.ending || slot.terminating) return;
    hear(i);
    any_asleep = any_asleep || is_asleep(i);
    any_drowsy = any_drowsy || asleep_since_[std::size_t(i)] > 0;
    any_busy = any_busy || (is_silent(i) && !is_coupler(slot));
  }
  // Others wait for one that is stopped: it is given its time before any of them is blamed.
  if (any_drowsy && !any_asleep) return;
  speak(any_asleep, any_busy);
}

void Listener::hear(int i) {
  const Slot& slot = board.slots[i];
  double& asleep = asleep_since_[std::size_t(i)];
  if (i == board.mine || slot.finished || state_of(slot.pid) != 'T')
    asleep = 0;
  else if (asleep == 0)
    asleep = last_look_;
  Work& work = work_[std::size_t(i)];
  if (i == board.mine || slot.finished || !works_long(slot)) {
    work.since = 0;
    return;
  }
  const double seconds = processor_seconds_of(slot.pid);
  // A child that has ended and is not yet counted lets the sum fall.
  if (work.since == 0 || seconds < work.seconds ||
      seconds - work.seconds > least_seconds + least_share * (last_look_ - work.since))
    work = {seconds, last_look_};
}

void Listener::speak(bool any_asleep, bool any_busy) const {
  Line line;
  const char* separator = "couplet: ";
  for (int i = 0; i < board.count; ++i) {
    if (any_asleep ? !is_asleep(i) : !is_silent(i) || (is_coupler(board.slots[i]) && any_busy)) continue;
    line << separator;
    describe(line, board.slots[i], any_asleep ? "is stopped (as by SIGSTOP)" : "hangs");
    separator = "; ";
  }
  if (line.empty()) return;
  line << ". No sign of life for " << patience_
       << " s (simulation.hang-timeout). All programs of the job end.\n";
  end_job_with(line);
}

bool Listener::is_asleep(int i) const {
  const double since = asleep_since_[std::size_t(i)];
  return since > 0 && last_look_ - since > patience_;
}

bool Listener::is_silent(int i) const {
  const Slot& slot = board.slots[i];
  const double heard = std::max({started_, slot.alive.load(), work_[std::size_t(i)].since});
  return i != board.mine && !slot.finished && slot.phase != int(Phase::waiting) &&
         last_look_ - heard > patience_;
}

}  // namespace couplet::app::watching
