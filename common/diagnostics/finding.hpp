// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/base/severity.hpp"

namespace couplet::diagnostics {

/// What a run found out about its own answer. Printed as "<sentence>; <advice> [<id>]", where the sentence has the form
/// "effect: number (limit): verdict".
struct Finding {
  std::string id{};  ///< one of finding_ids()
  base::Severity severity = base::Severity::warning;
  double number = std::numeric_limits<double>::quiet_NaN(), limit = number;  ///< NaN: none
  std::string sentence{};
  std::string advice{};  ///< what to do; empty: the sentence says it
  /// Part of the answer that a neglected effect changes [1]; its part of the error budget. NaN: not known.
  double share = std::numeric_limits<double>::quiet_NaN();
  /// Above 0: time that the run would save without this effect [1], which does next to nothing here.
  double saves = 0;
  std::string effect{};   ///< "thermal strain neglected"; empty: the finding is not about an effect
  std::string subject{};  ///< tells findings of one id apart: a probe, a participant

  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(id, severity, number, limit, sentence, advice, share, saves, effect, subject);
  }
};

/// Logs a finding and keeps it. Called on every rank; rank 0 prints. An id that finding_ids() lacks is a std::logic_error.
void finding(int rank, Finding f);
/// All findings of this process so far.
const std::vector<Finding>& findings();
/// Adds what an earlier part of this run had found before it was interrupted. Findings that the resumed run has
/// already made again (those of its start) are not repeated.
void resume_findings(int rank, const std::vector<Finding>& earlier);

/// Findings that the user lets pass; they are logged, and neither end a run with exit code 4 nor fail it with --strict.
void accept(std::span<const std::string> ids);
bool is_accepted(const std::string& id);

/// Number of findings about the answer that are not accepted and at least so severe; `with_neglected`: opinions on
/// neglected effects among them.
int count(base::Severity least, bool with_neglected);
/// Warnings and worse, opinions on neglected effects included.
int doubts();

/// As a JSON list of objects with id, severity, number, limit, sentence, advice, neglected-effect and accepted.
std::string findings_as_json();

/// Ids that exist, with what they mean: the list of docs/findings.md. `about` neglected effects: an opinion, which
/// --strict=effects counts and plain --strict does not.
struct FindingId {
  enum class About { answer, neglected } about;
  const char* id;
  const char* meaning;
};
std::span<const FindingId> finding_ids();
/// Throws std::logic_error where there is no such id.
const FindingId& finding_id(const std::string& id);
/// Why `ids` cannot be accepted: those that do not exist, with the nearest and all allowed ones; empty if all exist.
std::string unknown_ids(std::span<const std::string> ids);

}  // namespace couplet::diagnostics
