// SPDX-License-Identifier: Apache-2.0
#include "common/time/time_scheme.hpp"

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace couplet::time {

namespace {

constexpr Levels x{1, 0, 0, 0, 0, 0}, u{0, 1, 0, 0, 0, 0}, v{0, 0, 1, 0, 0, 0}, a{0, 0, 0, 1, 0, 0},
    u_old{0, 0, 0, 0, 1, 0}, v_old{0, 0, 0, 0, 0, 1};

// Length of the first part of a Bathe step, for which both parts have the same matrix.
constexpr double bathe_part = 2 - std::numbers::sqrt2;

const std::vector<std::pair<std::string, TimeScheme>> scheme_words{
    {"euler", TimeScheme::euler},
    {"three-point", TimeScheme::three_point},
    {"trapezoidal", TimeScheme::trapezoidal},
    {"bathe", TimeScheme::bathe},
    {"generalised-alpha", TimeScheme::generalised_alpha}};

Stage euler(double dt) {
  Stage s{.dt = dt};
  s.rate = s.end_rate = 1 / dt * (x - u);
  s.acceleration = s.end_acceleration = 1 / dt * (s.rate - v);
  s.end_value = x;
  return s;
}

// Derivative at the end of the parabola through three levels, applied twice.
Stage three_point(double start, double dt, double dt_old) {
  Stage s{.start = start, .dt = dt};
  const double c1 = dt / (dt_old * (dt + dt_old)), c2 = -(dt + dt_old) / (dt * dt_old),
               c3 = 1 / dt + 1 / (dt + dt_old);
  s.rate = s.end_rate = c3 * x + c2 * u + c1 * u_old;
  s.acceleration = s.end_acceleration = c3 * s.rate + c2 * v + c1 * v_old;
  s.end_value = x;
  return s;
}

Stage trapezoidal(double dt) {
  Stage s{.dt = dt, .place = 0.5};
  s.rate = 2 / dt * (x - u);
  s.acceleration = s.end_acceleration = 2 / dt * (s.rate - v);
  s.acceleration_at_end = false;
  s.end_value = 2 * x - u;
  s.end_rate = 2 * s.rate - v;
  return s;
}

struct Alpha {
  double m, f, gamma, beta;
  explicit Alpha(double rho)
      : m((2 * rho - 1) / (rho + 1)),
        f(rho / (rho + 1)),
        gamma(0.5 - m + f),
        beta(0.25 * (1 - m + f) * (1 - m + f)) {}
};

// Inertia at t^{n+1} - m dt, all other terms at t^{n+1} - f dt, with Newmark's relations between the levels.
Stage generalised_alpha(double dt, double spectral_radius) {
  const Alpha alpha(spectral_radius);
  Stage s{.dt = dt, .place = 1 - alpha.f};
  s.end_value = 1 / s.place * (x - alpha.f * u);
  s.end_acceleration = 1 / (alpha.beta * dt * dt) * (s.end_value - u - dt * v) - (0.5 / alpha.beta - 1) * a;
  s.end_rate = v + dt * (1 - alpha.gamma) * a + dt * alpha.gamma * s.end_acceleration;
  s.rate = (1 - alpha.f) * s.end_rate + alpha.f * v;
  s.acceleration = (1 - alpha.m) * s.end_acceleration + alpha.m * a;
  return s;
}

std::vector<Stage> bathe(double dt) {
  const double first = bathe_part * dt;
  return {trapezoidal(first), three_point(first, dt - first, first)};
}

}  // namespace

void declare(config::Section& s, TimeSchemeParameters& p, const std::string& automatic) {
  auto words = scheme_words;
  if (!automatic.empty()) words.emplace(words.begin(), "auto", TimeScheme::automatic);
  s.choice("type", p.type, words)
      .doc(
          "time integration scheme; all but euler are second order, all but trapezoidal damp the highest modes" +
          automatic);
  s.value("spectral-radius", p.spectral_radius)
      .range(0, 1)
      .doc(
          "for generalised-alpha: spectral radius at high frequencies, the fraction of the amplitude of the highest modes that "
          "remains after a step; 1 means no damping");
}

std::vector<Stage> second_order_stages(const TimeSchemeParameters& scheme, double dt,
                                       const StepHistory& history) {
  const bool first = history.steps == 0;
  switch (scheme.type) {
    case TimeScheme::automatic:
      break;
    case TimeScheme::euler:
      return {euler(dt)};
    case TimeScheme::three_point:
      return {first ? trapezoidal(dt) : three_point(0, dt, history.dt_old)};
    case TimeScheme::trapezoidal:
      return {trapezoidal(dt)};
    case TimeScheme::bathe:
      return bathe(dt);
    case TimeScheme::generalised_alpha:
      return {first ? trapezoidal(dt) : generalised_alpha(dt, scheme.spectral_radius)};
  }
  throw std::logic_error("no time scheme is chosen");
}

bool uses_old_level(TimeScheme scheme) { return scheme == TimeScheme::three_point; }
bool uses_acceleration(TimeScheme scheme) { return scheme == TimeScheme::generalised_alpha; }

LocalError local_error(const TimeSchemeParameters& scheme) {
  switch (scheme.type) {
    case TimeScheme::automatic:
      break;
    case TimeScheme::euler:
      return {1, 0.5};
    case TimeScheme::three_point:
      return {2, 1. / 3};
    case TimeScheme::trapezoidal:
      return {2, 1. / 12};
    case TimeScheme::bathe:  // [bank1985]
      return {2, (3 * bathe_part * bathe_part - 4 * bathe_part + 2) / (12 * (2 - bathe_part))};
    case TimeScheme::generalised_alpha:
      // That of the frequency of free vibrations. A single step from an exact acceleration errs by beta - 1/6, which does not add up.
      return {2, 1. / 12 + 1.5 * std::pow(0.5 - Alpha(scheme.spectral_radius).f, 2)};
  }
  throw std::logic_error("no time scheme is chosen");
}

std::string name(TimeScheme scheme) {
  for (const auto& [word, value] : scheme_words)
    if (value == scheme) return word;
  return "auto";
}

namespace {

using Complex = std::complex<double>;
// Linear combination of u, v, a, u_old, v_old at the start of the step.
using Row = Eigen::Matrix<Complex, 1, 5>;
using Step = Eigen::Matrix<Complex, 5, 5>;

Row combine(const Levels& l, const Row& x, const Step& levels) {
  return l.x * x + l.u * levels.row(0) + l.v * levels.row(1) + l.a * levels.row(2) + l.u_old * levels.row(3) +
         l.v_old * levels.row(4);
}

}  // namespace

// In each stage, a + alpha v + lambda (x + beta v) = 0 gives x as a combination of the previous levels.
double amplification(const TimeSchemeParameters& scheme, double dt, Complex eigenvalue,
                     const RayleighCoefficients& damping) {
  const Row nothing = Row::Zero();
  const Complex by_rate = damping.mass + eigenvalue * damping.stiffness;
  Step levels = Step::Identity();
  const Row start_u = levels.row(0), start_v = levels.row(1);
  // Uses regular steps after the startup.
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
  // Scales rates and values to similar size, which reduces the round-off of the eigenvalues.
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
