// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::thermocline {
namespace {

/// Standard deviations from the middle of a diffusive front to where a `share` of its step remains.
double deviations(double share) {
  double low = 0, high = 10;
  for (int i = 0; i < 50; ++i) {
    const double z = 0.5 * (low + high);
    (0.5 * std::erfc(z / std::numbers::sqrt2) > share ? low : high) = z;
  }
  return low;
}

/// Change of a profile by a spread of s cells (standard deviation), summed over the cells.
double change_by_spreading(const std::vector<double>& profile, double s) {
  const int n = int(profile.size());
  std::vector<double> weights{1 - s * s, 0.5 * s * s};  // within a cell: the second difference
  if (s > 1) {
    weights.clear();
    for (int k = 0; k <= 4 * s; ++k) weights.push_back(std::exp(-0.5 * (k / s) * (k / s)));
  }
  const int last = int(weights.size()) - 1;
  const double whole = 2 * std::accumulate(weights.begin(), weights.end(), 0.0) - weights[0];
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    double mean = 0;
    for (int k = -last; k <= last; ++k)
      mean += weights[std::size_t(std::abs(k))] * profile[std::size_t(std::clamp(i + k, 0, n - 1))];
    sum += std::abs(mean / whole - profile[std::size_t(i)]);
  }
  return sum;
}

/// Error of the profile. Upwind advection spreads a front like a diffusion v dz/2, implicit steps like v^2
/// dt/2: over a way w by s^2 = dz w and v dt w. The error is estimated by spreading the profile once more.
/// w is the way at the largest flow since time 0, at most the height. The limited scheme spreads by a cell.
/// Relative to the profile's distance from its mean, as sums over the height. With a plant at least the
/// storage capacity lost by spreading.
class FrontError final : public TankDiagnostic {
 public:
  using TankDiagnostic::TankDiagnostic;
  void conclude(diagnostics::Report& report) override {
    report.errors = spread_profile();
    if (const double unused = unused_by_spreading(); unused > 0 && !(report.errors.mesh > unused))
      report.errors.mesh = unused;
    report.errors.dimension = 1, report.errors.field = "profile of temperature";
  }

 private:
  Advection scheme() const { return view_.parameters().bed.advection; }
  /// Share of the bed that can have been crossed at the largest flow.
  double crossed() const { return std::min(1., seen_->flow * view_.time() / crossing_mass()); }

  diagnostics::ErrorParts spread_profile() const {
    std::vector<double> t;
    bed().filler_temperature(t);
    const std::size_t n = t.size();
    if (n < 3 || !(seen_->flow > 0)) return {};
    const double mean = std::accumulate(t.begin(), t.end(), 0.0) / double(n);
    double size = 0;
    for (const double value : t) size += std::abs(value - mean);
    if (!(size > 1e-9 * std::abs(mean) * double(n))) return {};  // uniform temperature does not spread
    const double way = double(n) * crossed();                    // in cells
    const auto by = [&](double variance) {
      return change_by_spreading(t, std::min(std::sqrt(variance), double(n))) / size;
    };
    diagnostics::ErrorParts parts{.mesh = by(scheme() == Advection::tvd ? 1 : std::max(1., way))};
    if (scheme() == Advection::implicit) parts.step = by(seen_->advance / crossing_mass() * double(n) * way);
    return parts;
  }

  /// A plant ends charging or discharging when the outlet deviates by the cut-off, while the front's middle
  /// is still some deviations inside. That part of the bed stays unused at both ends. Returns the
  /// contribution of the scheme, besides that of film and grains.
  double unused_by_spreading() const {
    const FlowParameters& flow = view_.parameters().flow;
    if (flow.type != FlowParameters::Type::plant || !(seen_->flow > 0)) return 0;
    const double n = double(bed().grid().size()), way = n * crossed();
    double variance = 1;  // in cells
    if (scheme() != Advection::tvd)
      variance = way * (1 + (scheme() == Advection::implicit ? seen_->advance / crossing_mass() * n : 0));
    // A new front in each charge adds variances; tails that remain in the bed between cycles add widths. The
    // map tank-plant and configs/thermocline-rock-air are in between, so the mean is used.
    const double of_scheme = std::sqrt(variance) / n, of_grains = std::sqrt(variance_of_grains());
    const double added = 0.5 * (of_scheme + std::hypot(of_scheme, of_grains) - of_grains);
    return 2 * deviations(flow.plant.cut_off / (flow.plant.hot - flow.plant.cold)) * added;
  }
};

}  // namespace

diagnostics::Made front_error(const RunOfTank& run) { return std::make_shared<FrontError>(run); }

}  // namespace couplet::thermocline
