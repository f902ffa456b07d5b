// SPDX-License-Identifier: Apache-2.0
#include "common/time/amplification.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace couplet::time {
namespace {

using Complex = std::complex<double>;
using Row =
    Eigen::Matrix<Complex, 1, 5>;  // a value as a combination of u, v, a, u_old, v_old at the step's start
using Step = Eigen::Matrix<Complex, 5, 5>;

Row combine(const Levels& l, const Row& x, const Step& levels) {
  return l.x * x + l.u * levels.row(0) + l.v * levels.row(1) + l.a * levels.row(2) + l.u_old * levels.row(3) +
         l.v_old * levels.row(4);
}

}  // namespace

// Each stage: a + alpha v + lambda (x + beta v) = 0 gives x as a combination of the levels before it.
double amplification(const TimeSchemeParameters& scheme, double dt, Complex eigenvalue,
                     const RayleighCoefficients& damping) {
  const Row nothing = Row::Zero();
  const Complex by_rate = damping.mass + eigenvalue * damping.stiffness;
  Step levels = Step::Identity();
  const Row start_u = levels.row(0), start_v = levels.row(1);
  // After the start-up: what a step does for ever.
  for (const Stage& s : second_order_stages(scheme, dt, {2, dt})) {
    if (s.start > 0) levels.row(3) = start_u, levels.row(4) = start_v;
    const Row known = combine(s.acceleration, nothing, levels) + by_rate * combine(s.rate, nothing, levels);
    const Row x = -known / (s.acceleration.x + by_rate * s.rate.x + eigenvalue);
    const Row u = combine(s.end_value, x, levels), v = combine(s.end_rate, x, levels),
              a = combine(s.end_acceleration, x, levels);
    levels.row(0) = u, levels.row(1) = v, levels.row(2) = a;
  }
  levels.row(3) = start_u, levels.row(4) = start_v;
  if (!uses_acceleration(scheme.type)) levels.row(2).setZero();
  if (!uses_old_level(scheme.type)) levels.bottomRows(2).setZero();
  // Scaled so that rates and values are alike, which the eigenvalues do not notice but their rounding does.
  const Eigen::Matrix<Complex, 5, 1> size{1, dt, dt * dt, 1, dt};
  const Step scaled = size.asDiagonal() * levels * size.cwiseInverse().asDiagonal();
  return Eigen::ComplexEigenSolver<Step>(scaled, false).eigenvalues().cwiseAbs().maxCoeff();
}

double growth_rate(Complex eigenvalue) { return std::abs(std::sqrt(eigenvalue).imag()); }

double growth_rate(const TimeSchemeParameters& scheme, double dt, Complex eigenvalue,
                   const RayleighCoefficients& damping) {
  return std::log(amplification(scheme, dt, eigenvalue, damping)) / dt;
}

}  // namespace couplet::time
