// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/statistics.hpp"

#include <cmath>

namespace couplet::fluid {

template <int D>
RunningStatistics<D>::RunningStatistics(std::size_t cells)
    : velocity_(cells, Vec<D>::Zero()),
      normal_(cells, Vec<D>::Zero()),
      shear_(cells * n_shear, 0.0),
      pressure_(cells, 0.0),
      pressure_square_(cells, 0.0) {}

template <int D>
void RunningStatistics<D>::add(const State<D>& s, double dt) {
  duration_ += dt;
  const double share = dt / duration_;
  for (std::size_t c = 0; c < velocity_.size(); ++c) {
    const Vec<D> before = s.u[c] - velocity_[c];
    velocity_[c] += share * before;
    const Vec<D> after = s.u[c] - velocity_[c];
    normal_[c] += dt * before.cwiseProduct(after);
    double* shear = shear_.data() + c * n_shear;
    for (int i = 0; i < D; ++i)
      for (int j = i + 1; j < D; ++j) *shear++ += dt * before[i] * after[j];
  }
  if (!s.pressure[0]) return;
  for (std::size_t c = 0; c < pressure_.size(); ++c) {
    const double before = s.pressure[0]->p[c] - pressure_[c];
    pressure_[c] += share * before;
    pressure_square_[c] += dt * before * (s.pressure[0]->p[c] - pressure_[c]);
  }
}

template <int D>
Vectors<D> RunningStatistics<D>::velocity_rms() const {
  Vectors<D> rms(normal_.size(), Vec<D>::Zero());
  if (duration_ > 0)
    for (std::size_t c = 0; c < rms.size(); ++c) rms[c] = (normal_[c] / duration_).cwiseMax(0.0).cwiseSqrt();
  return rms;
}

template <int D>
std::vector<double> RunningStatistics<D>::pressure_rms() const {
  std::vector<double> rms(pressure_.size(), 0.0);
  if (duration_ > 0)
    for (std::size_t c = 0; c < rms.size(); ++c)
      rms[c] = std::sqrt(std::max(0.0, pressure_square_[c] / duration_));
  return rms;
}

template <int D>
std::vector<double> RunningStatistics<D>::reynolds_shear() const {
  std::vector<double> shear = shear_;
  if (duration_ > 0)
    for (double& value : shear) value /= duration_;
  return shear;
}

template <int D>
void RunningStatistics<D>::save(CheckpointWriter& file) const {
  file.write_scalar("statistics-duration", duration_);
  file.write("statistics-velocity", flat<D>(velocity_));
  file.write("statistics-normal", flat<D>(normal_));
  file.write("statistics-shear", shear_);
  file.write("statistics-pressure", pressure_);
  file.write("statistics-pressure-square", pressure_square_);
}

template <int D>
void RunningStatistics<D>::load(CheckpointReader& file) {
  duration_ = file.read_scalar("statistics-duration");
  file.read("statistics-velocity", flat<D>(velocity_));
  file.read("statistics-normal", flat<D>(normal_));
  file.read("statistics-shear", shear_);
  file.read("statistics-pressure", pressure_);
  file.read("statistics-pressure-square", pressure_square_);
}

template class RunningStatistics<2>;
template class RunningStatistics<3>;

}  // namespace couplet::fluid
