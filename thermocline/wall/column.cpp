// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/column.hpp"

#include <cmath>

namespace couplet::thermocline {
namespace {

/// Film and half a cell in series [W/(m^2 K)].
double in_series(double film, double cell) {
  if (film <= 0) return 0;
  return std::isinf(film) ? cell : 1 / (1 / film + 1 / cell);
}

}  // namespace

Column::Column(const std::vector<ColumnLayer>& layers, double area) : area_(area) {
  double x = 0;
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const double dx = layers[l].thickness / layers[l].cells;
    conductivity_.push_back(layers[l].material.conductivity);
    for (int i = 0; i < layers[l].cells; ++i, x += dx) {
      x_.push_back(x + dx / 2);
      dx_.push_back(dx);
      layer_.push_back(int(l));
      capacity_.push_back(layers[l].material.density * layers[l].material.specific_heat * dx);
    }
  }
  for (auto* v : {&temperature_, &k_, &a_, &b_, &c_, &r_}) v->assign(x_.size(), 0.0);
  matrix_.resize(int(x_.size()));
}

double Column::inner_conductance() const {
  return 2 * conductivity_[layer_.front()](temperature_.front()) / dx_.front();
}
double Column::outer_conductance() const {
  return 2 * conductivity_[layer_.back()](temperature_.back()) / dx_.back();
}

double Column::outer_surface(const Film& outer) const {
  const double own = outer_conductance();
  if (std::isinf(outer.coefficient)) return outer.reference;
  return (own * temperature_.back() + outer.coefficient * outer.reference) / (own + outer.coefficient);
}

Column::Heat Column::step(double dt, const Film& inner, const Film& outer) {
  return advance(dt, in_series(inner.coefficient, inner_conductance()), inner.reference, 0, outer);
}

Column::Heat Column::step(double dt, double inner_power, const Film& outer) {
  return advance(dt, 0, 0, inner_power / area_, outer);
}

/// Rows of the implicit step without what enters at the inner side.
void Column::fill(double dt, const Film& outer) {
  const int n = int(x_.size()), last = n - 1;
  for (int i = 0; i < n; ++i) k_[i] = conductivity_[layer_[i]](temperature_[i]);
  for (int i = 0; i < n; ++i) b_[i] = capacity_[i] / dt, r_[i] = b_[i] * temperature_[i];
  for (int i = 0; i < last; ++i) {
    const double g = 1 / (dx_[i] / (2 * k_[i]) + dx_[i + 1] / (2 * k_[i + 1]));
    c_[i] = a_[i + 1] = -g;
    b_[i] += g, b_[i + 1] += g;
  }
  const double out = in_series(outer.coefficient, 2 * k_[last] / dx_[last]);
  b_[last] += out, r_[last] += out * outer.reference;
}

Film Column::inner_response(double dt, const Film& outer) {
  fill(dt, outer);
  // Elimination from the outside leaves d T_0 = r + q; with q = g (T_surface - T_0) of the inner half cell.
  double d = b_.back(), r = r_.back();
  for (std::size_t i = b_.size() - 1; i-- > 0;) {
    const double ratio = c_[i] / d;
    d = b_[i] - ratio * a_[i + 1];
    r = r_[i] - ratio * r;
  }
  const double g = inner_conductance();
  return {g * d / (g + d), r / d};
}

Column::Heat Column::advance(double dt, double inner, double inner_reference, double power,
                             const Film& outer) {
  const int last = int(x_.size()) - 1;
  fill(dt, outer);
  b_[0] += inner, r_[0] += inner * inner_reference + power;
  const double out = in_series(outer.coefficient, 2 * k_[last] / dx_[last]);
  matrix_.factorise(a_.data(), b_.data(), c_.data());
  matrix_.solve(r_.data());
  temperature_ = r_;
  Heat heat;
  heat.inner = area_ * dt * (power + inner * (inner_reference - temperature_[0]));
  heat.outer = area_ * dt * out * (temperature_[last] - outer.reference);
  return heat;
}

void Column::set_steady(double inner, double outer) {
  // Equal flux through resistances in series; a few sweeps for conductivities that depend on temperature.
  const int n = int(x_.size());
  for (int i = 0; i < n; ++i) temperature_[i] = inner + (outer - inner) * (i + 0.5) / n;
  for (int sweep = 0; sweep < 20; ++sweep) {
    double total = 0;
    for (int i = 0; i < n; ++i) k_[i] = conductivity_[layer_[i]](temperature_[i]), total += dx_[i] / k_[i];
    double passed = 0;
    for (int i = 0; i < n; ++i) {
      const double own = dx_[i] / k_[i];
      temperature_[i] = inner + (outer - inner) * (passed + own / 2) / total;
      passed += own;
    }
  }
}

double Column::energy(double reference) const {
  double sum = 0;
  for (std::size_t i = 0; i < x_.size(); ++i) sum += capacity_[i] * (temperature_[i] - reference);
  return area_ * sum;
}

}  // namespace couplet::thermocline
