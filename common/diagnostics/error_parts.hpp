// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/diagnostics/finding.hpp"

namespace couplet::diagnostics {

/// Scale of a relative error: the largest `size` of the solution over body and run, but no less than what round-off leaves of
/// a solution of the size `load`, which the loads would give if nothing balanced them.
constexpr double scale_of(double size, double load) { return size > 1e-8 * load ? size : 1e-8 * load; }

/// What a run's error is made of, as the run itself can know it cheaply, each over the size of the solution [1].
/// Good to a factor of a few; NaN: not known.
struct ErrorParts {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double mesh = unknown;      ///< what cells leave
  double step = unknown;      ///< what time steps leave
  double linear = unknown;    ///< what solvers of linear (or Newton's) systems leave below their tolerance
  double coupling = unknown;  ///< what the iteration between participants leaves below its tolerance
  /// What neglected effects change: the sum of the verdicts on them that say so.
  double model = unknown;
  std::string model_by{};                 ///< the largest of these and its cure, in words
  std::string omittable{};                ///< effects that do next to nothing, and what they cost, in words
  int dimension = 0;                      ///< of the mesh, 0: not known
  double mesh_order = 2, step_order = 2;  ///< by which the parts fall with cell size and step
  bool known() const;
  /// "mesh 0.0013 step 2e-05 model 0.1 | thermal strain neglected: ... | ": the known ones, for messages; empty: none.
  std::string text() const;
  /// Throws Error if it is no such text.
  static ErrorParts of(const std::string& text);
};

/// The parts of one participant of a job.
struct NamedErrors {
  std::string name;
  ErrorParts parts;
};

/// "estimated error 0.013: mesh 0.013, step 4.9e-05", which part dominates, with the cheapest change that lowers it and what
/// that gains and costs, and which effects could be omitted. Of several participants the largest of each kind counts and is
/// named. Empty if nothing is known.
std::vector<std::string> error_sentences(const std::vector<NamedErrors>& participants);

/// Of each kind the largest of the participants: the budget of a whole job.
ErrorParts largest(const std::vector<NamedErrors>& participants);

/// Of mesh, steps, solvers and coupling; 0 if nothing is known. What neglected effects change is not in it: it is judged by
/// findings of its own.
double total_error(const std::vector<NamedErrors>& participants);
/// From an error as large as the solution on the answer is useless. `wrong` where one part alone is so large: parts are good to
/// a factor of a few, and a sum of several that just reaches it proves nothing; it is a warning. Nothing below.
constexpr double as_large_as_the_solution = 1;
std::optional<Finding> worthless(const std::vector<NamedErrors>& participants);

}  // namespace couplet::diagnostics
