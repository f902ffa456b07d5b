// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/base/severity.hpp"

namespace couplet::diagnostics {

/// Observation of a run about its own result. Printed as "<sentence>; <advice> [<id>]", where the sentence
/// has the form "effect: number (limit): verdict".
struct Finding {
  std::string id{};  ///< one of finding_ids()
  base::Severity severity = base::Severity::warning;
  double number = std::numeric_limits<double>::quiet_NaN(), limit = number;  ///< NaN if there is none
  std::string sentence{};
  std::string advice{};  ///< what to do; empty if the sentence states it
  /// Share of the result that a neglected effect changes [1], its part of the error budget. NaN if unknown.
  double share = std::numeric_limits<double>::quiet_NaN();
  /// Share of the run time saved by omitting this effect [1]. Positive only if its influence is negligible.
  double saves = 0;
  std::string effect{};   ///< "thermal strain neglected"; empty if the finding is not about an effect
  std::string subject{};  ///< distinguishes findings of one id: a probe, a participant

  /// Archives the members in checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(id, severity, number, limit, sentence, advice, share, saves, effect, subject);
  }
};

/// Logs (rank 0) and stores a finding. Call it on every rank. Throws std::logic_error for an unknown id.
void finding(int rank, Finding f);
/// Replaces the stored finding of the same id and subject by a worse one, without logging it.
void amend(const Finding& worse);
/// All findings of this process so far.
const std::vector<Finding>& findings();
/// Adds the findings of an earlier part of this run, before it was interrupted. Findings that the resumed run
/// has already repeated at its start are not duplicated.
void resume_findings(int rank, const std::vector<Finding>& earlier);

/// Accepts these findings, by id, and no others. They are logged, but neither end a run with exit code 4 nor fail it with --strict.
void accept(std::span<const std::string> ids);
bool is_accepted(const std::string& id);

/// Relative change of the result from which a neglected effect matters [1]; `simulation.neglected-limit`.
double& share_limit();

/// Number of findings about the result that are not accepted and have at least this severity.
/// `with_neglected` includes neglected effects.
int count(base::Severity least, bool with_neglected);
/// Number of warnings and worse, including neglected effects.
int doubts();

/// JSON list of objects with id, severity, number, limit, sentence, advice, neglected-effect and accepted, share.
std::string findings_as_json();

/// Existing ids and their meaning, as listed in docs/findings.md. Ids about neglected effects are opinions,
/// which --strict=effects counts and plain --strict does not.
struct FindingId {
  enum class About { answer, neglected } about;
  const char* id;
  const char* meaning;
  /// Facts of a neglected effect, which --explain and docs/effects.md print.
  struct Effect {
    const char* programs = "";  ///< that judge it, separated by blanks
    const char* key = "";       ///< that simulates it: "gravity", "analysis: dynamic"; empty if there is none
    const char* number = "";    ///< by which a run judges it
  } effect{};
};
std::span<const FindingId> finding_ids();
/// Throws std::logic_error for an unknown id.
const FindingId& finding_id(const std::string& id);
/// Lists the unknown `ids` with the closest and all valid ones. Empty if all exist.
std::string unknown_ids(std::span<const std::string> ids);

}  // namespace couplet::diagnostics
