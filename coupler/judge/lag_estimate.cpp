// SPDX-License-Identifier: Apache-2.0
#include "coupler/judge/lag_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

constexpr double unknown_value = std::numeric_limits<double>::quiet_NaN();
// Participants solve to about 1e-8 of their values: an answer to less than this part of the velocity is noise.
constexpr double noise = 1e-6;
// An answer that nearly repeats the change says that the error is large, not how large.
constexpr double least_stiffness = 0.01;
// "Of late" is about this part of the time that has gone by.
constexpr double window = 0.25;
// Of the largest part of an error: less buys nothing.
constexpr double nothing = 0.1;

}  // namespace

LagEstimate::LagEstimate(MPI_Comm comm, const Unknown& unknown)
    : comm_(comm),
      possible_(!unknown.parts().empty() &&
                std::ranges::all_of(unknown.parts(), [](const auto& p) { return p.rides || p.velocity; })) {}

double LagEstimate::returned(const Look& look) const {
  double sums[3] = {0, 0, 0};  // (again - image).d, d.d, v.v
  for (std::size_t i = 0; i < look.image.rider.size(); ++i) {
    const double v = look.image.rider[i], d = v - look.x.rider[i];
    sums[0] += (look.again.rider[i] - v) * d;
    sums[1] += d * d;
    sums[2] += v * v;
  }
  sum_over(comm_, sums);
  return sums[1] > noise * noise * sums[2] ? -sums[0] / sums[1] : unknown_value;
}

void LagEstimate::looked(const Look& whole, const Look& half, double dt) {
  const double at_dt = returned(whole), at_half = returned(half);
  if (!std::isfinite(at_dt + at_half)) return;
  // Neither is negative: what seems so is noise, or other shapes of d in the shorter step.
  const double direct = std::clamp(2 * (at_dt - at_half), 0., std::max(at_dt, 0.));
  sums_.added = std::max(at_dt, at_half) - direct;
  sums_.rate = direct / dt;
  sums_.answer = std::max({sums_.answer, std::abs(at_dt), std::abs(at_half)});
  ++sums_.looks;
}

void LagEstimate::accepted(const Iterate& x, const Iterate& image, double dt) {
  for (auto* field : fields()) field->resize(image.rider.size());
  double sums[5] = {0, 0, 0, 0, 0};  // D.u, D.v, u.u, v.v, d.d
  for (std::size_t i = 0; i < image.rider.size(); ++i) {
    const double v = image.rider[i], u = image.unknown[i];
    const double d = v - x.rider[i];
    lag_[i] += dt * d;
    lags_[i] += dt * lag_[i];
    ways_[i] += dt * u;
    speeds_[i] += dt * v;
    sums[0] += lag_[i] * u;
    sums[1] += lag_[i] * v;
    sums[2] += u * u;
    sums[3] += v * v;
    sums[4] += d * d;
  }
  sum_over(comm_, sums);
  sums_.jumps += std::sqrt(sums[4]);
  sums_.time += dt;
  sums_.Du += dt * sums[0];
  sums_.Dv += dt * sums[1];
  sums_.uu += dt * sums[2];
  sums_.vv += dt * sums[3];
  sums_.late = std::max(std::sqrt(sums[3]), std::exp(-dt / (window * sums_.time)) * sums_.late);
  sums_.size = std::max(std::sqrt(sums[2]), sums_.size);
}

double LagEstimate::covariance(double xy, const std::vector<double>& x, const std::vector<double>& y) const {
  return xy - parallel::sum(comm_, dot(x, y)) / sums_.time;
}

LagEstimate::Range LagEstimate::over_size() const {
  const Sums& s = sums_;
  if (s.looks == 0 || !(s.size > 0)) return {};
  const double Du = covariance(s.Du, lags_, ways_), Dv = covariance(s.Dv, lags_, speeds_),
               uu = covariance(s.uu, ways_, ways_), vv = covariance(s.vv, speeds_, speeds_);
  if (!(uu > 0 && vv > 0)) return {};
  const double w = std::sqrt(vv / uu), stiff = std::max(1 + s.answer, least_stiffness);
  const double amplitude = s.time / 2 * (s.rate * Du - s.added * Dv) / uu;
  const double phase = w * s.time / 2 * (s.added * Du / uu + s.rate * Dv / vv);
  const double least = std::min(std::hypot(amplitude, phase) / stiff, 2.) * s.late / (w * s.size);
  const double most = s.answer * s.jumps * std::min(1 / w, s.time) / s.size;
  return {least, std::max(least, most)};
}

std::string LagEstimate::sentence(const std::vector<coupling::NamedErrors>& participants) const {
  const Range range = over_size();
  if (std::isnan(range.least))
    return "the error of explicit coupling is unknown (no step was examined; the first is the fourth).";
  double others = 0;
  for (const coupling::NamedErrors& of : participants)
    for (const double part : {of.parts.mesh, of.parts.step})
      if (part > others) others = part;  // not where it is NaN
  std::string text = fmt::format(
      "the error of explicit coupling is between {:.2g} and {:.2g} of the motion, not included "
      "in other estimates",
      range.least, range.most);
  if (range.most < nothing * others) return text + ": iterating would not help.";
  if (range.least > others)
    return text + ": an iterating 'scheme' or a shorter time step would reduce the error.";
  return text + "; a run with an iterating 'scheme' would show.";
}

std::string LagEstimate::not_possible() {
  return "the error of explicit coupling is unknown (it is estimated only for motions, without sub-steps "
         "and closed fluids).";
}

std::array<double*, LagEstimate::values> LagEstimate::list(Sums& s) {
  return {&s.Du,   &s.Dv,    &s.uu,   &s.vv,     &s.time,  &s.late,
          &s.size, &s.added, &s.rate, &s.answer, &s.looks, &s.jumps};
}

std::vector<double> LagEstimate::state() const {
  Sums copy = sums_;
  std::vector<double> state;
  for (const double* value : list(copy)) state.push_back(*value);
  return state;
}

void LagEstimate::restore(std::span<const double> state) {
  if (state.empty()) return;  // of a run that did not collect them
  if (state.size() != values) throw Error("The checkpoint's errors of explicit coupling are damaged.");
  std::size_t k = 0;
  for (double* value : list(sums_)) *value = state[k++];
}

}  // namespace couplet::coupler
