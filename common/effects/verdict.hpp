// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/severity.hpp"

namespace couplet::effects {

/// What a run found out about an effect that its scene left out, or about one that it has and that may not do
/// what it should there (a turbulence model beside walls that are not resolved).
struct EffectVerdict {
  std::string effect;    ///< the name on its card
  double number = 0;     ///< how large what was left out would have been, of the whole run so far
  double threshold = 0;  ///< neglecting it is justified up to here
  std::string sentence;  ///< what the number is, with its unit, without verdict: "max |grad u| = 0.29"
  std::string recommendation{};  ///< what to switch on, or to do, where it was not sound
  bool left_out = true;          ///< false: a verdict on an effect that the scene has
  /// The number is a mean over the run so far: only the last one counts, and nothing is told before the end (while a flow
  /// starts, its pressures compress much and walls have hardly moved).
  bool cumulative = false;
  /// From here on (or NaN) the answer is useless, not only questionable; infinite: never.
  double wrong_from = std::numeric_limits<double>::infinity();
  /// What that changes in the answer, as a share of it [1], good to a factor of two or so: its part of the error budget.
  /// NaN: the number says nothing of it.
  double share = std::numeric_limits<double>::quiet_NaN();
  /// Above 0: of an effect that the scene has and that does next to nothing up to the threshold: what the run would save
  /// without it, of its time [1]. Such a verdict is advice, and never unsound.
  double saves = 0;
  /// NaN is never sound.
  bool sound() const { return number <= threshold || saves > 0; }
  bool could_be_omitted() const { return saves > 0 && number <= threshold; }
  /// Of a verdict that is not sound.
  base::Severity severity() const {
    return number < wrong_from || std::isinf(wrong_from) ? base::Severity::warning : base::Severity::wrong;
  }
  /// The name of the effect in lower case with hyphens: "waves-of-pressure".
  std::string id() const;
};

/// The part of the error that is the model's: what the verdicts make of the answer, each as a share of it.
struct ModelError {
  double sum = std::numeric_limits<double>::quiet_NaN();  ///< NaN: nothing is known
  std::string largest;    ///< "thermal strain neglected: use 'thermal-expansion'"
  std::string omittable;  ///< "turbulence model (... saves 44 %)": what could be omitted
};
/// Sum over the verdicts that know their share, and what could be omitted.
ModelError model_error(const std::vector<EffectVerdict>& verdicts);

/// Of the number of a run, without the name of its effect; none where the number is not known. `share`: see EffectVerdict.
std::optional<EffectVerdict> verdict(double number, double threshold, std::string sentence,
                                     std::string recommendation,
                                     double share = std::numeric_limits<double>::quiet_NaN());

/// One line: "<effect> neglected: <sentence> (limit <threshold>): <justified, not justified or wrong>", and where it
/// is not justified the recommendation.
std::string text(const EffectVerdict& verdict);
/// "<effect> neglected: <sentence> (limit <threshold>): <verdict>".
std::string without_advice(const EffectVerdict& verdict);

/// Which effects have become unsound since the last look; each is told once. A run asks now and then, so that a
/// long one does not hide its bad news until its end, and what was bad in its midst is still known there.
class AuditTrail {
 public:
  /// The verdicts that are unsound for the first time, or wrong for the first time; cumulative ones only at the `end` of the run.
  std::vector<EffectVerdict> news(const std::vector<EffectVerdict>& verdicts, bool end = false);
  /// Of each effect the worst: of those of an instant the one with the largest number so far, of cumulative ones the last; in
  /// the order of their first appearance.
  std::vector<EffectVerdict> worst() const;
  bool all_sound() const { return told_.empty(); }
  /// Names of all that were unsound so far.
  const std::vector<std::string>& unsound() const { return told_; }

 private:
  struct Seen {
    std::optional<EffectVerdict> largest;  ///< of those of an instant
    std::optional<EffectVerdict> mean;     ///< the last cumulative one
  };
  void keep(const EffectVerdict& verdict);

  std::vector<std::string> told_, wrong_, order_;
  std::map<std::string, Seen> seen_;
};

}  // namespace couplet::effects
