// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>

#include "common/log/progress.hpp"

namespace couplet::diagnostics {
namespace {

using base::Severity;

/// Returns true if a exceeds its limit by more than b. NaN counts as largest.
bool exceeds(const Finding& a, const Finding& b) {
  return a.limit == b.limit ? !(a.number <= b.number) : !(a.number / a.limit <= b.number / b.limit);
}

}  // namespace

void Diagnostics::take(Report& report) {
  for (Finding& f : report.findings) {
    const auto same = [&](const Finding& w) { return w.id == f.id && w.subject == f.subject; };
    const auto worst = std::ranges::find_if(worst_, same);
    const bool is_news = f.severity > (worst == worst_.end() ? Severity::note : worst->severity);
    const bool is_worse =
        is_news || worst == worst_.end() || (f.severity >= worst->severity && exceeds(f, *worst));
    if (!is_worse) continue;
    if (f.severity > Severity::note) {
      Finding told = f;
      if (!concluding_ || !f.effect.empty()) told.sentence = fmt::format("t = {:g} s: {}", time_, f.sentence);
      is_news ? finding(rank_, std::move(told)) : amend(told);
    }
    if (worst == worst_.end())
      worst_.push_back(std::move(f));
    else
      *worst = std::move(f);
  }
  keep_nearest(position_, report.position);
}

void Diagnostics::accepted(double time) {
  const log::ScopedTimer timer(log::timers(), "diagnostics");
  ++steps_;
  time_ = time;
  Report report;
  for (const Named& one : all_) one.diagnostic->observe(report);
  take(report);
  if (std::has_single_bit(static_cast<unsigned long>(steps_)) || steps_ % 100 == 0) look();
}

void Diagnostics::look() {
  if (steps_ == looked_at_) return;
  looked_at_ = steps_;
  Report report;
  for (const Named& one : all_) one.diagnostic->look(report);
  take(report);
}

std::vector<std::string> Diagnostics::conclude(bool failed) {
  const log::ScopedTimer timer(log::timers(), "diagnostics");
  look();
  concluding_ = true;
  Report report;
  if (!failed) {
    for (const Named& one : all_) one.diagnostic->conclude(report);
    take(report);
    if (most_ >= When::with_errors) {
      errors_ = report.errors;
      add_model(worst_, errors_);
    }
  }
  for (const Finding& f : worst_)
    if (!(f.saves > 0) && !f.effect.empty() && (!failed || f.severity > Severity::note))
      report.sentences.push_back(fmt::format("{}{}{}", f.sentence,
                                             f.severity > Severity::note && !f.advice.empty() ? "; " : "",
                                             f.severity > Severity::note ? f.advice : ""));
  return report.sentences;
}

void add_model(const std::vector<Finding>& findings, ErrorParts& errors) {
  double largest = 0;
  for (const Finding& f : findings) {
    if (f.saves > 0)
      errors.omittable += fmt::format("{}{} saves about {:.0f} % of the time",
                                      errors.omittable.empty() ? "" : ", ", f.sentence, 100 * f.saves);
    if (std::isnan(f.share) || is_accepted(f.id)) continue;
    errors.model = std::isnan(errors.model) ? f.share : errors.model + f.share;
    if (!(f.share > largest)) continue;
    largest = f.share;
    errors.model_by = f.effect + (f.severity == Severity::note ? ", which is justified"
                                  : f.advice.empty()           ? ""
                                                               : ": " + f.advice);
  }
}

std::optional<Finding> finding_of(const EffectFinding& e) {
  if (std::isnan(e.number)) return {};
  Finding f{.number = e.number, .limit = e.limit, .sentence = {}, .advice = e.advice};
  if (*e.id != '\0') f.id = e.id, f.subject = e.effect;
  for (const char* c = e.effect; *e.id == '\0' && *c != '\0'; ++c) {
    if (std::isalnum(static_cast<unsigned char>(*c)))
      f.id += char(std::tolower(static_cast<unsigned char>(*c)));
    else if (!f.id.empty() && f.id.back() != '-')
      f.id += '-';
  }
  f.effect = fmt::format("{}{}", e.effect, e.left_out ? " neglected" : "");
  f.share = e.share;
  if (e.left_out && !std::isnan(e.share)) {
    // As an error; 1 is a share that may be any above. What is assumed or holds at one place only is bounded by 1.
    f.number = e.share, f.limit = share_limit();
    f.severity = f.number < f.limit                    ? Severity::note
                 : f.number > as_large_as_the_solution ? Severity::wrong
                                                       : Severity::warning;
    f.sentence = fmt::format(
        "{}: {}; this changes the result by {} (limit {:.2g} %): {}", f.effect, e.what,
        f.number > as_large_as_the_solution ? "more than 100 %" : fmt::format("{:.2g} %", 100 * f.number),
        100 * f.limit,
        f.severity == Severity::note      ? "justified"
        : f.severity == Severity::warning ? "matters"
                                          : "not reliable");
    return f;
  }
  if (e.limit == no_verdict) {
    f.severity = Severity::note;
    f.sentence = fmt::format("{}: {} (for information)", f.effect, e.what);
    return f;
  }
  const bool is_sound = e.number <= e.limit || e.is_spare;
  f.severity = is_sound ? Severity::note : e.number < e.wrong_from ? Severity::warning : Severity::wrong;
  if (e.is_spare && e.number <= e.limit && e.saves > 0) {
    f.saves = e.saves;
    f.sentence = fmt::format("{} ({}; limit {:.2g})", e.effect, e.what, e.limit);
    return f;
  }
  const char* word = e.left_out                      ? "its effect on the result is unknown"
                     : e.is_spare                    ? (e.number <= e.limit ? "could be left out" : "needed")
                     : is_sound                      ? "adequate"
                     : f.severity == Severity::wrong ? "wrong"
                                                     : "questionable";
  f.sentence = fmt::format("{}: {} (limit {:.2g}): {}", f.effect, e.what, e.limit, word);
  return f;
}

void keep_nearest(std::vector<Coordinate>& kept, const std::vector<Coordinate>& seen) {
  for (const Coordinate& c : seen) {
    const auto before = std::ranges::find(kept, c.quantity, &Coordinate::quantity);
    if (before == kept.end())
      kept.push_back(c);
    else if (c.used() > before->used())
      *before = c;
  }
}

std::string position_sentence(const std::vector<Coordinate>& position) {
  if (position.empty()) return {};
  std::string list;
  for (const Coordinate& c : position)
    list += fmt::format("{}{} {:.3g} ({} {:.3g})", list.empty() ? "" : ", ", c.quantity, c.value,
                        c.floor ? "at least" : "limit", c.limit);
  const Coordinate& nearest = *std::ranges::max_element(position, {}, &Coordinate::used);
  return fmt::format("stability: {}: {} (docs/stability.md, {}).", list,
                     nearest.used() > 1 ? "beyond the tested range" : "within the tested range", nearest.map);
}

}  // namespace couplet::diagnostics
