// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace couplet {

/// sigma = mu (grad u + grad u^T) + lambda tr(grad u) I [Pa]. Plane stress: lambda is 2 lambda mu / (lambda +
/// 2 mu).
struct LameConstants {
  double mu = 0, lambda = 0;
};

/// What acts on the strain without its volume part, in three dimensions: sigma = 2 mu dev(e) + K tr(e) I.
inline LameConstants deviatoric(const LameConstants& lame) { return {lame.mu, -2 * lame.mu / 3}; }
inline double bulk_modulus(const LameConstants& lame) { return lame.lambda + 2 * lame.mu / 3; }

}  // namespace couplet
