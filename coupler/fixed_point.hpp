// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "coupler/accelerator.hpp"
#include "coupler/parameters.hpp"
#include "coupler/predictor.hpp"

namespace couplet {

struct Residual {
  double relative = 0;  ///< |r|_2 / |H(x)|_2; 0 if both vanish
  double absolute = 0;  ///< root mean square of the vectors r over the vertices [m]
};
Residual measure(std::span<const double> residual, std::span<const double> image, int dim);
bool converged(const Residual& residual, const ConvergenceParameters& parameters);

/// One pass through all participants: x to H(x). Throws SolveFailure if one of them fails.
using FixedPointMap = std::function<InterfaceState(const InterfaceState&)>;
/// After each pass: its number from 1, its residual, and the share of the residual before that led to its x.
using IterationObserver = std::function<void(int, const Residual&, double)>;

struct FixedPointResult {
  InterfaceState x, image;  ///< of the last pass: x and H(x)
  Residual residual;
  int iterations = 0;
};

/// x = H(x) by passes and accelerated updates from the guess x. Throws SolveFailure if it does not converge
/// within the allowed iterations or a residual is not finite.
FixedPointResult solve_fixed_point(InterfaceState x, int dim, const FixedPointMap& map,
                                   const ConvergenceParameters& parameters, Accelerator& accelerator,
                                   const IterationObserver& observer);

}  // namespace couplet
