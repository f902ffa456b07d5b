// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/layers.hpp"

#include <cmath>
#include <numbers>

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
  for (auto* v : {&temperature_, &k_, &resistance_, &a_, &b_, &c_, &r_}) v->assign(x_.size(), 0.0);
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

/// Rows of the implicit step without the inflow at the inner side.
void Column::fill(double dt, const Film& outer) {
  const int n = int(x_.size()), last = n - 1;
  for (int i = 0; i < n; ++i) k_[i] = conductivity_[layer_[i]](temperature_[i]);
  for (int i = 0; i < n; ++i) b_[i] = capacity_[i] / dt, r_[i] = b_[i] * temperature_[i];
  for (int i = 0; i < n; ++i) resistance_[i] = dx_[i] / (2 * k_[i]);
  conduction_rows(n, resistance_.data(), a_.data(), c_.data());
  for (int i = 0; i < n; ++i) b_[i] = b_[i] - a_[i] - c_[i];
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
  // Equal flux through resistances in series; a few sweeps for temperature-dependent conductivities.
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

Insulation::Insulation(const InsulationParameters& p, std::span<const double> dz, double radius)
    : cells_(p.cells), rings_(dz.size()), dz_(dz.begin(), dz.end()) {
  const Insulator material = make_insulator(p.material);
  conductivity_ = material.conductivity;
  ramps_ = Ramps(conductivity_);
  const double dr = p.thickness / cells_, pi = std::numbers::pi;
  for (int j = 0; j < cells_; ++j) {
    const double in = radius + j * dr, middle = in + dr / 2, out = in + dr;
    shape_.push_back(2 * pi / std::log(middle / in));
    shape_.push_back(2 * pi / std::log(out / middle));
    capacity_.push_back(material.density * material.specific_heat * pi * (out * out - in * in));
  }
  outer_circumference_ = 2 * pi * (radius + p.thickness);
  temperature_.assign(rings_ * cells_, 293.15);
  k_.resize(rings_ * cells_), up_.resize(rings_ * cells_), inner_.resize(rings_), in_.resize(rings_),
      nothing_.assign(rings_, 0.0);
}

double Insulation::step(double dt, std::span<const double> inside, const Film& outside,
                        std::vector<double>& from_rings) {
  const std::size_t n = rings_;
  const int last = cells_ - 1;
  ramps_.values(temperature_.data(), k_.data(), n * cells_);
  // Node j: (C/dt)(T - T^n) = g_{j-1} (T_{j-1} - T) + g_j (T_{j+1} - T), per height, from the inside out. up_
  // contains g_j over the diagonal after eliminating the inner nodes.
  double* in = in_.data();  // conductance inwards; outwards it is that of the next node inwards
  for (std::size_t i = 0; i < n; ++i) in[i] = inner_[i] = shape_[0] * k_[i];
  for (int j = 0; j < cells_; ++j) {
    double *t = temperature_.data() + j * n, *up = up_.data() + j * n;
    const double *k = k_.data() + j * n, *next = j < last ? k + n : k;
    const double *before = j > 0 ? t - n : inside.data(), *eliminated = j > 0 ? up - n : nothing_.data();
    // Half a node and half the next one, or the film, in series: k k'/(a k' + b k).
    const double store = capacity_[j] / dt, a = 1 / shape_[2 * j + 1],
                 b = j < last ? 1 / shape_[2 * j + 2] : 0,
                 film = j < last ? 0 : 1 / (outer_circumference_ * outside.coefficient);
#pragma GCC ivdep
    for (std::size_t i = 0; i < n; ++i) {
      const double out = k[i] * next[i] / (next[i] * (a + film * k[i]) + b * k[i]);
      const double inverse = 1 / (store + out + in[i] * (1 - eliminated[i]));
      t[i] = (store * t[i] + in[i] * before[i]) * inverse;
      up[i] = out * inverse;
      in[i] = out;
    }
  }
  double lost = 0;
  double* t = temperature_.data() + last * n;
  for (std::size_t i = 0; i < n; ++i) t[i] += up_[last * n + i] * outside.reference;
  for (int j = last - 1; j >= 0; --j) {
    double* tj = temperature_.data() + j * n;
    for (std::size_t i = 0; i < n; ++i) tj[i] += up_[j * n + i] * tj[i + n];
  }
  for (std::size_t i = 0; i < n; ++i) {
    lost += dt * dz_[i] * in[i] * (t[i] - outside.reference);  // in: outwards of the last node by now
    from_rings[i] = dz_[i] * inner_[i] * (inside[i] - temperature_[i]);
  }
  return lost;
}

void Insulation::set_steady(std::span<const double> inside, double outside) {
  for (std::size_t i = 0; i < rings_; ++i) {
    for (int j = 0; j < cells_; ++j)
      temperature_[j * rings_ + i] = inside[i] + (outside - inside[i]) * (j + 0.5) / cells_;
    for (int sweep = 0; sweep < 10; ++sweep) {
      double total = 0, passed = 0;
      const auto resistance = [&](int half) {
        return 1 / (shape_[half] * conductivity_(temperature_[(half / 2) * rings_ + i]));
      };
      std::vector<double> r(2 * cells_);
      for (int half = 0; half < 2 * cells_; ++half) total += r[half] = resistance(half);
      for (int j = 0; j < cells_; ++j) {
        passed += r[2 * j];
        temperature_[j * rings_ + i] = inside[i] + (outside - inside[i]) * passed / total;
        passed += r[2 * j + 1];
      }
    }
  }
}

double Insulation::energy(double reference) const {
  double sum = 0;
  for (int j = 0; j < cells_; ++j)
    for (std::size_t i = 0; i < rings_; ++i)
      sum += capacity_[j] * dz_[i] * (temperature_[j * rings_ + i] - reference);
  return sum;
}

double Insulation::outer_surface(const Film& outside) const {
  const int last = cells_ - 1;
  double sum = 0, height = 0;
  for (std::size_t i = 0; i < rings_; ++i) {
    const double t = temperature_[last * rings_ + i], own = shape_[2 * last + 1] * conductivity_(t);
    const double film = outer_circumference_ * outside.coefficient;
    sum += dz_[i] * (own * t + film * outside.reference) / (own + film);
    height += dz_[i];
  }
  return sum / height;
}

Film side_film_on(const Insulation& blanket, const OutsideParameters& p, double diameter, double height,
                  const Ambient& air) {
  const Film first = side_film(p, air.temperature + 5, diameter, height, air);
  return side_film(p, blanket.outer_surface(first), diameter, height, air);
}

Film roof_film_on(const Column& roof, const OutsideParameters& p, double diameter, const Ambient& air) {
  const Film first = roof_film(p, air.temperature + 5, diameter, air);
  return roof_film(p, roof.outer_surface(first), diameter, air);
}

void declare(config::Section& section, InsulationParameters& p) {
  declare_section(section, "material", p.material, "of the blanket");
  as_thickness(section.value("thickness", p.thickness))
      .positive()
      .required()
      .doc("thickness on the side, and on the roof above an ullage");
  section.value("cells", p.cells).range(1, 200).doc("number of cells through the thickness");
  as_step(section.value("step", p.step)).positive().doc("time step of the insulation");
  section.value("cover-emissivity", p.outside.emissivity).range(0, 1).doc("emissivity of the metal cover");
  section.value("solar-absorptance", p.outside.solar_absorptance)
      .range(0, 1)
      .doc("solar absorptance of the cover; 0: sun neglected");
}

}  // namespace couplet::thermocline
