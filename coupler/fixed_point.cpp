// SPDX-License-Identifier: Apache-2.0
#include "coupler/fixed_point.hpp"

#include <cmath>

#include "common/base/error.hpp"

namespace couplet {
namespace {

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

Iterate iterate(const InterfaceState& x) { return {x.displacement, x.velocity}; }

}  // namespace

Residual measure(std::span<const double> residual, std::span<const double> image, int dim) {
  double r = 0, h = 0;
  for (const double v : residual) r += v * v;
  for (const double v : image) h += v * v;
  Residual result;
  result.relative = r == 0 ? 0 : std::sqrt(r / h);
  result.absolute = residual.empty() ? 0 : std::sqrt(r * dim / double(residual.size()));
  return result;
}

bool converged(const Residual& residual, const ConvergenceParameters& parameters) {
  return residual.relative <= parameters.relative || residual.absolute <= parameters.absolute;
}

FixedPointResult solve_fixed_point(InterfaceState x, int dim, const FixedPointMap& map,
                                   const ConvergenceParameters& parameters, Accelerator& accelerator,
                                   const IterationObserver& observer) {
  FixedPointResult result;
  accelerator.start_step();
  for (int k = 1; k <= parameters.max_iterations; ++k) {
    InterfaceState image = map(x);
    const std::vector<double> r = difference(image.displacement, x.displacement);
    result.residual = measure(r, image.displacement, dim);
    result.iterations = k;
    observer(k, result.residual, accelerator.relaxation());
    if (!std::isfinite(result.residual.absolute))
      throw SolveFailure("the interface displacement is not finite after {} coupling iterations.", k);
    if (converged(result.residual, parameters)) {
      accelerator.accept(iterate(x), iterate(image));
      result.x = std::move(x);
      result.image = std::move(image);
      return result;
    }
    Iterate next = accelerator.next(iterate(x), iterate(image));
    x = {std::move(next.unknown), std::move(next.rider)};
  }
  throw SolveFailure(
      "the coupling did not converge in {} iterations: the relative residual is {:.2e} ({:.1e} is asked "
      "for).",
      parameters.max_iterations, result.residual.relative, parameters.relative);
}

}  // namespace couplet
