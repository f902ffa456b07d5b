// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/fixed_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"

namespace couplet::coupler {

bool converged(const Residual& residual, const ConvergenceParameters& parameters) {
  const bool relative = residual.relative <= parameters.relative,
             absolute = residual.absolute <= parameters.absolute;
  return parameters.both ? relative && absolute : relative || absolute;
}

std::string absolute_too(const Residual& residual, const ConvergenceParameters& parameters) {
  if (!parameters.both) return "";
  return fmt::format(", the absolute one {:.2e} ({:.1e})", residual.absolute, parameters.absolute);
}

Residual worst(const std::vector<Residual>& residuals) {
  Residual all;
  for (const Residual& r : residuals)  // not a number stays not a number
    if (!(r.relative <= all.relative) && !std::isnan(all.relative)) all = r;
  return all;
}

double largest(const std::vector<Residual>& residuals, const std::vector<double>& scales) {
  double most = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (scales[i] > 0) most = std::max(most, residuals[i].absolute / scales[i]);
  return most;
}

FixedPointResult solve_fixed_point(Iterate x, const FixedPointMap& map, const ResidualMeasure& measure,
                                   const ConvergenceParameters& parameters, Accelerator& accelerator,
                                   const IterationObserver& observer) {
  FixedPointResult result;
  accelerator.start_step();
  for (int k = 1; k <= parameters.max_iterations; ++k) {
    Iterate image = map(x);
    const std::vector<Residual> residuals = measure(x, image);
    result.residual = worst(residuals);
    result.iterations = k;
    observer(k, residuals, accelerator.relaxation());
    if (!std::ranges::all_of(residuals, [](const Residual& r) { return std::isfinite(r.absolute); }))
      throw SolveFailure("the interface values are not finite after {} coupling iterations.", k);
    result.converged =
        std::ranges::all_of(residuals, [&](const Residual& r) { return converged(r, parameters); });
    const bool as_it_is =
        k == parameters.max_iterations && parameters.at_maximum == ConvergenceParameters::AtMaximum::accept;
    if ((result.converged && k >= parameters.min_iterations) || as_it_is) {
      accelerator.accept(x, image);
      result.x = std::move(x);
      result.image = std::move(image);
      return result;
    }
    x = accelerator.next(std::move(x), image);
  }
  throw SolveFailure(
      "the coupling did not converge in {} iterations: the relative residual is {:.2e} (tolerance {:.1e}){}.",
      parameters.max_iterations, result.residual.relative, parameters.relative,
      absolute_too(result.residual, parameters));
}

}  // namespace couplet::coupler
