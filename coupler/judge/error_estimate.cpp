// SPDX-License-Identifier: Apache-2.0
#include "coupler/judge/error_estimate.hpp"

#include <algorithm>

namespace couplet::coupler {
namespace {

// Of a residual that hardly falls nothing is known but that the error is large.
constexpr double slowest = 0.99;
// Where one pass was enough.
constexpr double unseen = 0.5;

}  // namespace

void CouplingErrorEstimate::accepted(const Residual& last, const Residual& change, double dt) {
  if (!(last.relative > 0) || !(dt > 0)) return;
  const double c = before_ > 0 ? std::min(residual_ / before_, slowest) : unseen;
  const double size = last.absolute / last.relative;
  errors_.add({.error = c / (1 - c) * last.absolute, .rate = change.absolute / dt, .size = size, .dt = dt});
}

}  // namespace couplet::coupler
