// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <limits>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/diagnostics/error_parts.hpp"

namespace couplet::diagnostics {

/// Row of the results at the end of a run.
struct Result {
  std::string name, unit;
  std::vector<double> values;
  /// Estimated, relative to the largest value. NaN if unknown, infinity if it has none.
  double error = std::numeric_limits<double>::quiet_NaN();
  std::string place{};  ///< "at (1, 0, 0) m"
  int rank = 0;  ///< 0: the case asks for it, 1: follows from what it asks for, 2: shows how the run went
  std::vector<double> errors{};  ///< of each value, relative to it; empty where `error` holds for all of them
  std::string text{};  ///< values with unit, error and place, as the run prints them; from results()
};
std::string place_text(const Vec3& place);

/// Hint on the unit of a mesh whose largest side [m] is unusual and that has no scale of its own, else "".
const char* hint_on_unit(double largest, double mesh_scale);
/// Shows the sides of the mesh [m] among the results, with that hint. On one rank.
void set_mesh_size(const Vec3& size, int dimension, double mesh_scale);

/// Adds the row of the largest value over the ranks, with its place. Collective.
void set_largest(MPI_Comm comm, const char* name, const char* unit, double value, const Vec3& place);
/// Adds a row, or replaces the one of this name. Call it on rank 0.
void set_result(Result result);
/// Sets the error of each value of a row, relative to that value, and of values that it does not show. Call it on rank 0.
void set_errors(const std::string& name, std::vector<double> errors);
/// Storage for the last row of a table whose columns ("tip x [m]") are results, such as probes.csv. nullptr
/// for any other table. Components of a vector share a row.
std::vector<double>* results_of_table(const std::string& file, const std::vector<std::string>& columns);
/// All rows, those that a case asks for first. Rows of the field that `errors` speak of have its error.
std::vector<Result> results(const ErrorParts& errors = {});

/// Block of at most `most` rows: results at `time` [s] of a participant, then `verdict`.
std::string results_text(const std::string& participant, double time, std::size_t most,
                         const ErrorParts& errors, const std::vector<std::string>& verdict);
/// "estimated error: velocity 1.3 % (mesh)", for each participant, or that it is unknown. Neglected effects are excluded.
std::string error_summary(const std::vector<NamedErrors>& participants);
/// Cheapest change that lowers the largest contribution, with its gain and price. Empty if there is none.
std::string best_change(const std::vector<NamedErrors>& participants);

/// Verdict in at most three lines: the error, warnings that were not accepted, and the best next change.
std::vector<std::string> verdict(const std::vector<NamedErrors>& participants);

}  // namespace couplet::diagnostics
