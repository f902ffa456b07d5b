// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace couplet::coupler {

/// What a participant did in a run.
struct Worker {
  std::string name;
  int ranks = 1;
  double seconds = 0;  ///< of wall time at work, on these ranks
};

/// `total` ranks for them, one at least for each. Work is taken to divide by the ranks. One after another (Gauss-Seidel) the
/// times add up: the sum of work / ranks is the least that whole numbers allow; side by side the longest of them is.
std::vector<int> divide_ranks(const std::vector<Worker>& workers, int total, bool side_by_side);

/// For the end of a run: who waited for whom, and, where another division of the same ranks would take a tenth less time, that
/// one; with one rank each, whose the next rank should be. Empty: one participant, or no work was measured.
std::string waiting_sentence(const std::vector<Worker>& workers, bool side_by_side);

}  // namespace couplet::coupler
