// SPDX-License-Identifier: Apache-2.0
#include "common/app/run_audit.hpp"

#include <fmt/format.h>

#include <bit>
#include <chrono>

#include "common/log/finding.hpp"
#include "common/log/timer.hpp"

namespace couplet::app {

void report(int rank, double time, const effects::EffectVerdict& v) {
  log::finding(rank, {.id = v.id(),
                      .severity = v.severity(),
                      .number = v.number,
                      .limit = v.threshold,
                      .sentence = fmt::format("t = {:g} s: {}", time, effects::without_advice(v)),
                      .advice = v.recommendation});
}

void RunAudit::accepted(double time, bool output) {
  ++steps_;
  time_ = time;
  if (output || std::has_single_bit(static_cast<unsigned long>(steps_)) || steps_ % 100 == 0) look();
}

std::vector<std::string> RunAudit::closing_lines(bool with_sound) {
  look(true);
  std::vector<std::string> lines;
  for (const effects::EffectVerdict& verdict : trail_.worst())
    if (!(verdict.saves > 0) && (with_sound || !verdict.sound())) lines.push_back(effects::text(verdict));
  return lines;
}

void RunAudit::look(bool end) {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<effects::EffectVerdict> verdicts = participant_.audit();
  for (const effects::EffectVerdict& verdict : trail_.news(verdicts, end)) report(rank_, time_, verdict);
  effects::keep_nearest(position_, effects::coordinates_of(verdicts));
  if (placed_ && steps_ > 0) effects::keep_nearest(position_, placed_->position());
  log::timers().add("audit", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

}  // namespace couplet::app
