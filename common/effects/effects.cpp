// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "common/effects/card.hpp"

namespace couplet::effects {
namespace {

/// What it adds in words, then by the list of prices.
std::string cost_text(const Effect& effect) {
  std::string text(effect.adds);
  for (const Price& p : effect.prices)
    if (const std::string price = price_text(p); !price.empty())
      text += fmt::format("{}{}", text.empty() ? "" : "; ", price);
  return text.empty() ? "negligible" : text;
}

const char* verdict_word(const EffectVerdict& v) {
  if (v.sound()) return v.left_out ? "justified" : "adequate";
  if (v.severity() == base::Severity::wrong) return "wrong";
  return v.left_out ? "not justified" : "questionable";
}

}  // namespace

std::string text(const EffectVerdict& v) {
  return fmt::format("{}{}{}", without_advice(v), v.sound() ? "" : "; ", v.sound() ? "" : v.recommendation);
}

std::string without_advice(const EffectVerdict& v) {
  return fmt::format("{}{}: {} (limit {:.2g}): {}", v.effect, v.left_out ? " neglected" : "", v.sentence,
                     v.threshold, verdict_word(v));
}

std::optional<EffectVerdict> verdict(double number, double threshold, std::string sentence,
                                     std::string recommendation, double share) {
  if (std::isnan(number)) return {};
  EffectVerdict v{"", number, threshold, std::move(sentence), std::move(recommendation)};
  v.share = share;
  return v;
}

ModelError model_error(const std::vector<EffectVerdict>& verdicts) {
  ModelError model;
  double largest = 0;
  for (const EffectVerdict& v : verdicts) {
    if (v.could_be_omitted())
      model.omittable +=
          fmt::format("{}{} ({}; limit {:.2g}) saves about {:.0f} % of the time",
                      model.omittable.empty() ? "" : ", ", v.effect, v.sentence, v.threshold, 100 * v.saves);
    if (std::isnan(v.share)) continue;
    model.sum = std::isnan(model.sum) ? v.share : model.sum + v.share;
    if (!(v.share > largest)) continue;
    largest = v.share;
    model.largest = fmt::format("{}{}{}", v.effect, v.left_out ? " neglected" : "",
                                v.sound() && v.share < 0.1 ? ", which is justified"
                                : v.recommendation.empty() ? ""
                                                           : ": " + v.recommendation);
  }
  return model;
}

std::string EffectVerdict::id() const {
  std::string id;
  for (const unsigned char c : effect) {
    if (std::isalnum(c))
      id += char(std::tolower(c));
    else if (!id.empty() && id.back() != '-')
      id += '-';
  }
  return id;
}

namespace {
/// By how far over its limit; NaN is worse than any number.
bool exceeds(const EffectVerdict& a, const EffectVerdict& b) {
  return !(a.number / a.threshold <= b.number / b.threshold);
}
}  // namespace

std::vector<EffectVerdict> AuditTrail::news(const std::vector<EffectVerdict>& verdicts, bool end) {
  std::vector<EffectVerdict> result;
  for (const EffectVerdict& v : verdicts) {
    keep(v);
    if (v.sound() || (v.cumulative && !end)) continue;
    const bool is_wrong = v.severity() == base::Severity::wrong;
    const bool known = std::ranges::count(told_, v.effect) > 0;
    if (known && (!is_wrong || std::ranges::count(wrong_, v.effect) > 0)) continue;
    if (!known) told_.push_back(v.effect);
    if (is_wrong) wrong_.push_back(v.effect);
    result.push_back(v);
  }
  return result;
}

void AuditTrail::keep(const EffectVerdict& v) {
  if (!seen_.contains(v.effect)) order_.push_back(v.effect);
  Seen& seen = seen_[v.effect];
  if (v.cumulative)
    seen.mean = v;
  else if (!seen.largest || exceeds(v, *seen.largest))
    seen.largest = v;
}

std::vector<EffectVerdict> AuditTrail::worst() const {
  std::vector<EffectVerdict> result;
  for (const std::string& effect : order_) {
    const auto& [largest, mean] = seen_.at(effect);
    result.push_back(mean && (!largest || exceeds(*mean, *largest)) ? *mean : *largest);
  }
  return result;
}

std::string summary(const std::vector<Effect>& effects) {
  std::string on, off;
  for (const Effect& e : effects) {
    std::string& list = e.on() ? on : off;
    list += list.empty() ? "" : ", ";
    list += e.on() ? fmt::format("{} ({})", e.name, e.asked_by) : e.name;
  }
  return fmt::format("effects: {}{}{}", on.empty() ? "none" : on, off.empty() ? "" : "; neglected: ", off);
}

std::string explanation(const std::vector<Effect>& effects) {
  std::string lines;
  for (const bool on : {true, false})
    for (const Effect& e : effects)
      if (e.on() == on)
        lines +=
            on ? fmt::format("  on   {}: enabled by {}; adds {}\n", e.name, e.asked_by, cost_text(e))
               : fmt::format(
                     "  off  {}: {}{}\n", e.name, e.keys,
                     e.judged_when_on || e.judged_by.empty() ? "" : "; judged by the run: " + e.judged_by);
  const bool has_prices = std::ranges::any_of(effects, [](const Effect& e) {
    return e.on() && std::ranges::any_of(e.prices, [](const Price& p) { return !price_text(p).empty(); });
  });
  if (has_prices)
    lines +=
        "  (prices: from the least to the most in small scenes on one rank; share of a step without the "
        "effect; docs/effects.md)\n";
  return lines;
}

std::string markdown(const std::string& program, const std::vector<Effect>& effects) {
  std::string lines = fmt::format(
      "## {}\n\n| effect | enabled by | adds | memory per cell | time of a step | judged when neglected "
      "|\n|---|---|---|---|---|---|\n",
      program);
  for (const Effect& e : effects)
    lines += fmt::format("| {} | {} | {} | {} | {} | {} |\n", e.name, e.keys, e.adds,
                         column(e.prices, memory_text, "B"), column(e.prices, time_text, "%"), e.judged_by);
  return lines;
}

}  // namespace couplet::effects
