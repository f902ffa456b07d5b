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

/// Parts of a run's error as far as the run can estimate them cheaply, relative to the size of the solution
/// [1]. They are good to a factor of a few. NaN means unknown.
struct ErrorParts {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double mesh = unknown;      ///< spatial discretization error
  double step = unknown;      ///< time discretization error
  double linear = unknown;    ///< error of linear (or Newton) solvers below their tolerance
  double coupling = unknown;  ///< error of the coupling iteration below its tolerance
  /// Error from neglected effects: the sum of the findings that state a share.
  double model = unknown;
  std::string model_by{};    ///< the largest of these and its remedy, in words
  std::string omittable{};   ///< effects with negligible influence, and their cost, in words
  std::string field{};       ///< field that mesh and step speak of, in words: "velocity"
  std::string unit{};        ///< of this field
  double size = 0;           ///< its root mean square over the body, the largest of the run [unit]
  double level = 0;          ///< value from which the field is counted [unit]
  int dimension = 0;         ///< of the mesh, 0 if unknown
  bool misses_step = false;  ///< a run in time whose step is not estimated
  bool known() const;
  /// Text "mesh 0.0013 step 2e-05 model 0.1 | thermal strain neglected: ... | ". Empty if nothing is known.
  std::string text() const;
  /// Parses text(). Throws Error if it is not such a text.
  static ErrorParts of(const std::string& text);
};

/// Error contributions of one participant of a job.
struct NamedErrors {
  std::string name;
  ErrorParts parts;
};

/// Sentences such as "estimated error 0.013 of the solution: mesh 0.013, step 4.9e-05", and effects that could be omitted. For several
/// participants the largest of each kind counts and is named. Empty if nothing is known.
std::vector<std::string> error_sentences(const std::vector<NamedErrors>& participants);

/// Error budget of a job: the largest of each contribution over the participants.
ErrorParts largest(const std::vector<NamedErrors>& participants);

/// Sum of mesh, step, solver and coupling errors of one participant; NaN if the mesh or the step is unknown.
double known_error(const ErrorParts& parts);
/// Sum of the largest mesh, step, solver and coupling errors; 0 if none is known. Neglected effects are excluded, because
/// they have findings of their own.
double total_error(const std::vector<NamedErrors>& participants);
/// Finding if the error is as large as the solution. It is `wrong` if one part alone is so large. Parts are
/// accurate to a factor of a few, so a sum that large only gives a warning.
constexpr double as_large_as_the_solution = 1;
std::optional<Finding> worthless(const std::vector<NamedErrors>& participants);

}  // namespace couplet::diagnostics
