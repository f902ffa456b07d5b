// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet::base {

/// Severity of a finding about the result of a run.
enum class Severity {
  note,     ///< informational
  warning,  ///< the result may be inaccurate: --strict fails the run
  wrong     ///< the result is useless: the run ends with exit code 4, unless the finding is accepted
};

constexpr const char* name(Severity s) {
  return s == Severity::note ? "note" : s == Severity::warning ? "warning" : "wrong";
}

}  // namespace couplet::base
