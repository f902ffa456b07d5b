// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::base {

/// How much a finding says about the answer of a run.
enum class Severity {
  note,     ///< worth knowing
  warning,  ///< the answer may be off: --strict fails the run
  wrong     ///< the answer is useless: the run ends with exit code 4, unless the finding is accepted
};

constexpr const char* name(Severity s) {
  return s == Severity::note ? "note" : s == Severity::warning ? "warning" : "wrong";
}

}  // namespace couplet::base
