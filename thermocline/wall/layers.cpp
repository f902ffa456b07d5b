// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/layers.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace couplet::thermocline {

void Layers::add_cell(double inwards, double outwards, double capacity) {
  shape_.push_back(inwards);
  shape_.push_back(outwards);
  capacity_.push_back(capacity);
}

void Layers::add_material(const Insulator& material, double outer_surface) {
  std::size_t before = 0;
  for (const LayerMaterial& known : materials_) before += known.cells;
  materials_.push_back({capacity_.size() - before, Ramps(material.conductivity)});
  outer_surface_ = outer_surface;
  temperature_.assign(capacity_.size() * length_.size(), 293.15);
  k_ = up_ = temperature_;
  inner_ = in_ = length_;
}

void Layers::find_conductivity() {
  std::size_t at = 0;
  for (const LayerMaterial& material : materials_) {
    material.conductivity.values(&temperature_[at], &k_[at], material.cells * length_.size());
    at += material.cells * length_.size();
  }
}

double Layers::advance(double dt, std::span<const double> inside, double coefficient, double power,
                       const Film& outside, std::span<double> into) {
  const std::size_t n = length_.size(), cells = capacity_.size();
  find_conductivity();
  // Cell j: (C/dt)(T - T^n) = g_{j-1} (T_{j-1} - T) + g_j (T_{j+1} - T), from the inside out. up_ contains g_j
  // over the diagonal after eliminating the inner cells.
  double* in = in_.data();  // conductance inwards; outwards it is that of the next cell inwards
  for (std::size_t i = 0; i < n; ++i) in[i] = inner_[i] = 1 / (1 / coefficient + 1 / (shape_[0] * k_[i]));
  for (std::size_t j = 0; j < cells; ++j) {
    const bool last = j + 1 == cells;
    double *t = temperature_.data() + j * n, *up = up_.data() + j * n;
    const double *k = k_.data() + j * n, *next = last ? k : k + n;
    const double *before = j > 0 ? t - n : inside.data(), *eliminated = j > 0 ? up - n : nullptr;
    // Half a cell and half the next one, or the film, in series: k k'/(a k' + b k).
    const double store = capacity_[j] / dt, given = j > 0 ? 0 : power, a = 1 / shape_[2 * j + 1],
                 b = last ? 0 : 1 / shape_[2 * j + 2],
                 film = last ? 1 / (outer_surface_ * outside.coefficient) : 0;
#pragma GCC ivdep
    for (std::size_t i = 0; i < n; ++i) {
      const double out = k[i] * next[i] / (next[i] * (a + film * k[i]) + b * k[i]);
      const double rest = eliminated ? in[i] * (1 - eliminated[i]) : in[i];
      const double inverse = 1 / (store + out + rest);
      t[i] = (store * t[i] + in[i] * before[i] + given) * inverse;
      up[i] = out * inverse;
      in[i] = out;
    }
  }
  double lost = 0;
  double* t = temperature_.data() + (cells - 1) * n;
  for (std::size_t i = 0; i < n; ++i) t[i] += up_[(cells - 1) * n + i] * outside.reference;
  for (std::size_t j = cells - 1; j-- > 0;) {
    double* tj = temperature_.data() + j * n;
    for (std::size_t i = 0; i < n; ++i) tj[i] += up_[j * n + i] * tj[i + n];
  }
  for (std::size_t i = 0; i < n; ++i) {
    lost += dt * length_[i] * in[i] * (t[i] - outside.reference);  // in: outwards of the last cell by now
    into[i] = length_[i] * (power + inner_[i] * (inside[i] - temperature_[i]));
  }
  return lost;
}

void Layers::set_steady(std::span<const double> inside, double outside) {
  // Equal flux through resistances in series; a few sweeps for temperature-dependent conductivities.
  const std::size_t n = length_.size(), cells = capacity_.size();
  for (std::size_t j = 0; j < cells; ++j)
    for (std::size_t i = 0; i < n; ++i)
      temperature_[j * n + i] = inside[i] + (outside - inside[i]) * (double(j) + 0.5) / double(cells);
  for (int sweep = 0; sweep < 20; ++sweep) {
    find_conductivity();
    for (std::size_t i = 0; i < n; ++i) {
      const auto resistance = [&](std::size_t half) { return 1 / (shape_[half] * k_[half / 2 * n + i]); };
      double total = 0, passed = 0;
      for (std::size_t half = 0; half < shape_.size(); ++half) total += resistance(half);
      for (std::size_t j = 0; j < cells; ++j) {
        passed += resistance(2 * j);
        temperature_[j * n + i] = inside[i] + (outside - inside[i]) * passed / total;
        passed += resistance(2 * j + 1);
      }
    }
  }
}

double Layers::energy(double reference) const {
  const std::size_t n = length_.size();
  double sum = 0;
  for (std::size_t j = 0; j < capacity_.size(); ++j)
    for (std::size_t i = 0; i < n; ++i)
      sum += capacity_[j] * length_[i] * (temperature_[j * n + i] - reference);
  return sum;
}

double Layers::outer_surface(const Film& outside) const {
  const std::size_t n = length_.size(), last = temperature_.size() - n;
  const double film = outer_surface_ * outside.coefficient;
  std::vector<double> k(n);
  materials_.back().conductivity.values(&temperature_[last], k.data(), n);
  double sum = 0, length = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double own = shape_.back() * k[i];
    sum += length_[i] * (own * temperature_[last + i] + film * outside.reference) / (own + film);
    length += length_[i];
  }
  return sum / length;
}

Column::Column(const std::vector<ColumnLayer>& layers, double area) : Layers({&area, 1}) {
  double x = 0;
  for (const ColumnLayer& layer : layers) {
    const double dx = layer.thickness / layer.cells;
    for (int i = 0; i < layer.cells; ++i, x += dx) {
      x_.push_back(x + dx / 2);
      add_cell(2 / dx, 2 / dx, layer.material.density * layer.material.specific_heat * dx);
    }
    add_material(layer.material, 1);
  }
}

Column::ColumnHeat Column::step(double dt, const Film& inner, const Film& outer) {
  double into = 0;
  const double lost = advance(dt, {&inner.reference, 1}, inner.coefficient, 0, outer, {&into, 1});
  return {dt * into, lost};
}

Column::ColumnHeat Column::step(double dt, double inner_power, const Film& outer) {
  double into = 0;
  const double none = 0, lost = advance(dt, {&none, 1}, 0, inner_power / area(), outer, {&into, 1});
  return {dt * into, lost};
}

double Column::inner_conductance() const {
  return shape_.front() * materials_.front().conductivity(temperature_.front());
}

Film Column::inner_response(double dt, const Film& outer) {
  find_conductivity();
  // Elimination from the outside leaves d T_0 = r + q; with q = g (T_surface - T_0) of the inner half cell.
  const std::size_t last = capacity_.size() - 1;
  const double film = 1 / (1 / outer.coefficient + 1 / (shape_.back() * k_.back()));
  double d = capacity_[last] / dt + film;
  double r = capacity_[last] / dt * temperature_[last] + film * outer.reference;
  for (std::size_t j = last; j-- > 0;) {
    const double g = 1 / (1 / (shape_[2 * j + 1] * k_[j]) + 1 / (shape_[2 * j + 2] * k_[j + 1]));
    r = capacity_[j] / dt * temperature_[j] + g * r / (d + g);
    d = capacity_[j] / dt + g * d / (d + g);
  }
  const double g = inner_conductance();
  return {g * d / (g + d), r / d};
}

Insulation::Insulation(const InsulationParameters& p, std::span<const double> dz, double radius)
    : Layers(dz) {
  const Insulator material = make_insulator(p.material);
  const double dr = p.thickness / p.cells, pi = std::numbers::pi;
  for (int j = 0; j < p.cells; ++j) {
    const double in = radius + j * dr, middle = in + dr / 2, out = in + dr;
    add_cell(2 * pi / std::log(middle / in), 2 * pi / std::log(out / middle),
             material.density * material.specific_heat * pi * (out * out - in * in));
  }
  add_material(material, 2 * pi * (radius + p.thickness));
}

double Insulation::step(double dt, std::span<const double> inside, const Film& outside,
                        std::span<double> from_rings) {
  return advance(dt, inside, std::numeric_limits<double>::infinity(), 0, outside, from_rings);
}

Film side_film_on(const Insulation& blanket, double diameter, double height, const Ambient& air) {
  const Film first = side_film(air.temperature + 5, diameter, height, air);
  return side_film(blanket.outer_surface(first), diameter, height, air);
}

Film roof_film_on(const Column& roof, double diameter, const Ambient& air) {
  const Film first = roof_film(air.temperature + 5, diameter, air);
  return roof_film(roof.outer_surface(first), diameter, air);
}

void declare(config::Section& section, InsulationParameters& p) {
  declare_section(section, "material", p.material, "of the blanket");
  as_thickness(section.value("thickness", p.thickness))
      .positive()
      .required()
      .doc("thickness on the side, and on the roof above an ullage");
  section.value("cells", p.cells).range(1, 200).doc("number of cells through the thickness");
  as_step(section.value("step", p.step)).positive().doc("time step of the insulation");
}

}  // namespace couplet::thermocline
