// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/diagnostics/effects.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::io {
class Archive;
}

namespace couplet::diagnostics {

/// Collects what diagnostics say.
struct Report {
  /// Findings of an effect or of the answer. A note is a sound one: it is told at the end of the run only.
  std::vector<diagnostics::Finding> findings;
  std::vector<std::string> sentences;  ///< for the end of the log
  diagnostics::ErrorParts errors;      ///< parts of the estimated error, each over the size of the solution
  std::vector<diagnostics::Coordinate> position;  ///< where the run stands on the maps of docs/stability.md
};

/// Looks at a run from outside and judges its answer. It reads what the program shows of itself (its view) and changes
/// nothing there. Each one keeps a reference to its view, which outlives it. All calls are collective over the ranks of
/// the program.
class Diagnostic {
 public:
  virtual ~Diagnostic() = default;
  /// After each accepted step.
  virtual void observe(Report&) {}
  /// After steps 1, 2, 4, 8, ... and each hundredth, at outputs and at the end: says what the accepted state shows. Of what
  /// it says over the run the worst counts.
  virtual void look(Report&) {}
  /// At the end of a run that was not given up, after the last look().
  virtual void conclude(Report&) {}
  /// Saves or loads its memory of the run. A resumed run must end with the findings of the unbroken one.
  virtual void visit(io::Archive&) {}
};

}  // namespace couplet::diagnostics
