// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/pressure_load.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::plate {
namespace {

/// A side of the plate: faces whose normal is within 60 degrees of that of the plate.
constexpr double least_cosine = 0.5;

bool is_on(const Vec3& area, const Vec3& normal, double sign) {
  return sign * area.dot(normal) > least_cosine * area.norm();
}

}  // namespace

PressureLoad::PressureLoad(const Share& share, const Load& load, const Vec3& normal)
    : share_(share), normal_(normal) {
  if (load.upper) upper_.emplace(*load.upper, "load.upper-pressure");
  if (load.lower) lower_.emplace(*load.lower, "load.lower-pressure");
  int i = 0;
  for (const auto& [side, sign, name] :
       {std::tuple{&upper_, 1., "upper"}, std::tuple{&lower_, -1., "lower"}}) {
    std::vector<double>& unit = of_one_pascal_[i++];
    if (!*side) continue;
    const auto faces =
        std::ranges::count_if(share.areas(), [&](const Vec3& area) { return is_on(area, normal_, sign); });
    if (couplet::sum(share.comm(), GlobalIndex(faces)) == 0)
      throw Error(
          "load.{}-pressure: the surface of the structure has no face on this side ({:g}, {:g}, {:g}).", name,
          sign * normal.x(), sign * normal.y(), sign * normal.z());
    if ((*side)->uses_space()) continue;
    unit.assign(share.n_modes(), 0);
    add_faces(Expression(1.0), sign, 0, unit);
  }
}

bool PressureLoad::changes_in_time() const {
  return (upper_ && upper_->uses_time()) || (lower_ && lower_->uses_time());
}
bool PressureLoad::is_uniform() const {
  return !(upper_ && upper_->uses_space()) && !(lower_ && lower_->uses_space());
}

double PressureLoad::push(const Vec3& area, const Vec3& x, double t) const {
  double sum = 0;
  if (upper_ && is_on(area, normal_, 1)) sum += (*upper_)(x, t);
  if (lower_ && is_on(area, normal_, -1)) sum += (*lower_)(x, t);
  return sum;
}

void PressureLoad::add_faces(const Expression& side, double sign, double t, std::span<double> load) const {
  std::vector<double> force(3 * share_.n_faces(), 0);
  for (std::size_t f = 0; f < share_.n_faces(); ++f) {
    const Vec3& area = share_.areas()[f];
    if (!is_on(area, normal_, sign)) continue;
    const double pressure = side(share_.centres()[f], t);
    for (int c = 0; c < 3; ++c) force[3 * f + c] = -pressure * area[c];
  }
  share_.add_load(force, load);
}

void PressureLoad::fill(double t, std::span<double> load) const {
  std::ranges::fill(load, 0);
  int i = 0;
  for (const auto& [side, sign] : {std::pair{&upper_, 1.}, std::pair{&lower_, -1.}}) {
    const std::vector<double>& unit = of_one_pascal_[i++];
    if (!*side) continue;
    if (unit.empty()) {
      add_faces(**side, sign, t, load);
      continue;
    }
    const double pressure = (**side)(Vec3::Zero(), t);
    for (std::size_t m = 0; m < unit.size(); ++m) load[m] += pressure * unit[m];
  }
}

void PressureLoad::at(double t, std::span<double> load) const {
  fill(t, load);
  share_.sum(load);
}

PressureLoad::Seen PressureLoad::seen(double t, double dt, int samples) const {
  const std::size_t n = share_.n_modes();
  std::vector<double> all((samples + 1) * n + 1, 0);  // in the middle, at each sample; failures
  try {
    fill(t + 0.5 * dt, std::span(all).first(n));
    for (int i = 0; i < samples; ++i)
      fill(t + (i + 0.5) / samples * dt, std::span(all).subspan((i + 1) * n, n));
  } catch (const Error&) {
    all.back() = 1;  // the scheme need not ask for it there
  }
  share_.sum(all);
  Seen seen;
  if (all.back() > 0) return seen;
  for (std::size_t m = 0; m < n; ++m) {
    double mean = 0;
    for (int i = 1; i <= samples; ++i) {
      mean += all[i * n + m] / samples;
      seen.size += all[i * n + m] * all[i * n + m] / samples;
    }
    seen.apart += (mean - all[m]) * (mean - all[m]);
  }
  return seen;
}

}  // namespace couplet::plate
