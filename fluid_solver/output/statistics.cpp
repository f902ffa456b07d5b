// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/derived.hpp"

#include <cmath>
#include <limits>

namespace couplet::fluid {
namespace {

/// Round-off may make a square negative; NaN is kept.
double root(double square) { return square < 0 ? 0.0 : std::sqrt(square); }

}  // namespace

template <int D>
RunningStatistics<D>::RunningStatistics(std::size_t cells, std::size_t faces)
    : cells_(cells),
      velocity_(cells + faces, Vec<D>::Zero()),
      normal_(cells + faces, Vec<D>::Zero()),
      shear_(cells * n_shear, 0.0),
      pressure_(cells + faces, 0.0),
      pressure_square_(cells + faces, 0.0) {}

template <int D>
RunningStatistics<D> RunningStatistics<D>::nothing_yet(std::size_t cells, std::size_t faces) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  RunningStatistics none(cells, faces);
  for (Vectors<D>* v : {&none.velocity_, &none.normal_}) v->assign(v->size(), Vec<D>::Constant(unknown));
  for (auto* v : {&none.shear_, &none.pressure_, &none.pressure_square_}) v->assign(v->size(), unknown);
  none.duration_ = 1;
  return none;
}

template <int D>
void RunningStatistics<D>::add(std::size_t i, const Vec<D>& velocity, double dt) {
  const double share = dt / duration_;
  const Vec<D> before = velocity - velocity_[i];
  velocity_[i] += share * before;
  const Vec<D> after = velocity - velocity_[i];
  normal_[i] += dt * before.cwiseProduct(after);
  if (i >= cells_) return;
  double* shear = shear_.data() + i * n_shear;
  for (int a = 0; a < D; ++a)
    for (int b = a + 1; b < D; ++b) *shear++ += dt * before[a] * after[b];
}

template <int D>
void RunningStatistics<D>::add_pressure(std::size_t i, double pressure, double dt) {
  const double before = pressure - pressure_[i];
  pressure_[i] += dt / duration_ * before;
  pressure_square_[i] += dt * before * (pressure - pressure_[i]);
}

template <int D>
void RunningStatistics<D>::add(const State<D>& s, const PressureLevel<D>* pressure, double dt) {
  duration_ += dt;
  for (std::size_t c = 0; c < cells_; ++c) add(c, s.u[c], dt);
  for (std::size_t b = 0; b < s.u_boundary.size(); ++b) add(cells_ + b, s.u_boundary[b], dt);
  if (!pressure) return;
  for (std::size_t c = 0; c < cells_; ++c) add_pressure(c, pressure->p[c], dt);
  for (std::size_t b = 0; b < pressure->boundary.size(); ++b)
    add_pressure(cells_ + b, pressure->boundary[b], dt);
}

template <int D>
Vectors<D> RunningStatistics<D>::velocity_rms() const {
  Vectors<D> rms(normal_.size(), Vec<D>::Zero());
  if (duration_ > 0)
    for (std::size_t c = 0; c < rms.size(); ++c) rms[c] = (normal_[c] / duration_).unaryExpr(&root);
  return rms;
}

template <int D>
std::vector<double> RunningStatistics<D>::pressure_rms() const {
  std::vector<double> rms(pressure_.size(), 0.0);
  if (duration_ > 0)
    for (std::size_t c = 0; c < rms.size(); ++c) rms[c] = root(pressure_square_[c] / duration_);
  return rms;
}

template <int D>
std::vector<double> RunningStatistics<D>::reynolds_shear() const {
  std::vector<double> shear = shear_;
  if (duration_ > 0)
    for (double& value : shear) value /= duration_;
  return shear;
}

/// `use`: called with entries, name and values, first of cells and then of boundary faces.
template <int D>
template <class Self, class Use>
void RunningStatistics<D>::visit(Self& self, const Use& use) {
  const auto both = [&](const std::string& name, auto values, std::size_t width) {
    use(mesh::Entries::cells, "statistics-" + name, values.first(self.cells_ * width));
    use(mesh::Entries::owned_boundary, "statistics-boundary-" + name, values.subspan(self.cells_ * width));
  };
  both("velocity", flat<D>(self.velocity_), D);
  both("normal", flat<D>(self.normal_), D);
  both("pressure", std::span(self.pressure_), 1);
  both("pressure-square", std::span(self.pressure_square_), 1);
  use(mesh::Entries::cells, "statistics-shear", std::span(self.shear_));
}

template <int D>
void RunningStatistics<D>::save(io::CheckpointWriter& file) const {
  file.write_scalar("statistics-duration", duration_);
  visit(*this,
        [&](auto entries, const std::string& name, auto values) { file.write(entries, name, values); });
}

template <int D>
void RunningStatistics<D>::load(io::CheckpointReader& file) {
  duration_ = file.read_scalar("statistics-duration");
  visit(*this, [&](auto entries, const std::string& name, auto values) { file.read(entries, name, values); });
}

template class RunningStatistics<2>;
template class RunningStatistics<3>;

}  // namespace couplet::fluid
