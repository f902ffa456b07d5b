// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "coupler/acceleration/accelerator.hpp"
#include "coupler/acceleration/unknown.hpp"
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

bool converged(const Residual& residual, const ConvergenceParameters& parameters);
/// Suffix for a sentence with the relative residual; empty if only that one decides.
std::string absolute_too(const Residual& residual, const ConvergenceParameters& parameters);
/// Returns the residual of the datum with the largest relative one.
Residual worst(const std::vector<Residual>& residuals);
/// Returns the largest absolute residual over the `scale` of its datum. Data without a scale yet (0) are
/// omitted.
double largest(const std::vector<Residual>& residuals, const std::vector<double>& scales);

/// One pass through all participants, from x to H(x). Throws SolveFailure if one of them fails.
using FixedPointMap = std::function<Iterate(const Iterate&)>;
/// Residuals of H(x) - x, one for each unknown.
using ResidualMeasure = std::function<std::vector<Residual>(const Iterate& x, const Iterate& image)>;
/// After each pass: its number from 1, its residuals, and the share of the residual before that led to its x.
using IterationObserver = std::function<void(int, const std::vector<Residual>&, double)>;

struct FixedPointResult {
  Iterate x, image;  ///< x and H(x) of the last pass
  Residual residual;
  int iterations = 0;
  bool converged = true;  ///< false: accepted without convergence
};

/// Solves x = H(x) by accelerated passes from the guess x, until the residual of every unknown is below its
/// bound. Throws SolveFailure if it does not converge within the allowed iterations or a residual is not
/// finite.
FixedPointResult solve_fixed_point(Iterate x, const FixedPointMap& map, const ResidualMeasure& measure,
                                   const ConvergenceParameters& parameters, Accelerator& accelerator,
                                   const IterationObserver& observer);

}  // namespace couplet::coupler
