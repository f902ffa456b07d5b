// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/closures.hpp"

#include <algorithm>
#include <cmath>

namespace couplet::thermocline {
namespace {

const int n_nodes = 257;  // every 4 K over 1000 K

}  // namespace

// With r = radiation and N = 1 + (r - B)/kappa,
//   k/k_f = (1 - sqrt(1 - eps)) (1 + eps r) + 2 sqrt(1 - eps)/N [bracket]
//   bracket = B (kappa + r - 1)/(N^2 kappa) ln((kappa + r)/B) + (B + 1)/(2 B) (r - B) - (B - 1)/N
double zehner_schluender(double porosity, double kappa, double r) {
  const double b = 1.25 * std::pow((1 - porosity) / porosity, 10.0 / 9), n = 1 + (r - b) / kappa;
  const double root = std::sqrt(1 - porosity);
  // The bracket over N. Both vanish where kappa + r = B, so the first terms of the series in (kappa + r)/B - 1 are used.
  const double q = kappa / b, y = (kappa + r) / b - 1;
  const double bridge = std::abs(n) < 1e-3
                            ? q * (b + 1) / 2 - q * q * b / 2 + q * q * (kappa + r - 1) * (1.0 / 3 - y / 4)
                            : (b * (kappa + r - 1) / (n * n * kappa) * std::log(1 + y) +
                               (b + 1) / (2 * b) * (r - b) - (b - 1) / n) /
                                  n;
  return (1 - root) * (1 + porosity * r) + 2 * root * bridge;
}

double stagnant_conductivity(const Medium& fluid, const Filler& filler, double porosity, double diameter,
                             double kelvin) {
  constexpr double stefan_boltzmann = 5.670374e-8;  // [W/(m^2 K^4)]
  const double k = fluid.conductivity(kelvin), e = filler.emissivity;
  const double radiation = fluid.is_transparent() && e > 0
                               ? 4 * stefan_boltzmann / (2 / e - 1) * kelvin * kelvin * kelvin * diameter / k
                               : 0;
  return k *
         zehner_schluender(std::min(porosity, 0.999), value_of(filler.conductivity, kelvin) / k, radiation);
}

MassFlux::MassFlux(double g_abs)
    : g(g_abs), g_film(std::pow(g_abs, 0.6)), g_third(std::cbrt(g_abs)), g_wall(std::pow(g_abs, 0.8)) {}

LayerClosure::LayerClosure(const ClosureParameters& parameters, const Medium& fluid, const Filler& filler,
                           double porosity, double diameter)
    : parameters_(parameters), fluid_(fluid), filler_(filler), porosity_(porosity), diameter_(diameter) {
  // Slightly beyond the fluid's limits, because a run that leaves them is only warned about.
  const double lowest = std::max(fluid.lowest - 50, 150.0), highest = std::min(fluid.highest + 100, 1500.0);
  first_ = lowest;
  inverse_spacing_ = (n_nodes - 1) / (highest - lowest);
  nodes_.reserve(n_nodes);
  for (int i = 0; i < n_nodes; ++i) nodes_.push_back(node_at(lowest + i / inverse_spacing_));
}

LayerClosure::Node LayerClosure::node_at(double t) const {
  const double k = fluid_.conductivity(t), mu = std::max(fluid_.viscosity(t), 1e-6), d = diameter_;
  const double pr = mu * fluid_.specific_heat / k, re = d / mu;  // Re per unit flux
  const double stagnant = stagnant_conductivity(fluid_, filler_, porosity_, d, t);
  Node n{};
  // Nu = 2 + 1.1 Pr^(1/3) Re^0.6, Re on the superficial velocity (Wakao and Kaguei 1982, fitted to 15 < Re <
  // 8500; Nu = 2, pure conduction, at rest).
  n.film_still = 2 * k / d;
  n.film_flow = 1.1 * k / d * std::cbrt(pr) * std::pow(re, 0.6);
  if (parameters_.film_coefficient > 0) n.film_still = parameters_.film_coefficient, n.film_flow = 0;
  switch (parameters_.conduction) {
    case Conduction::stagnant:
      n.conduction_still = stagnant;
      break;
    case Conduction::wakao:
      n.conduction_still = 0.7 * porosity_ * k;
      break;
    case Conduction::constant:
      n.conduction_still = parameters_.conductivity;
      break;
  }
  // Beek 1962: (k/d) [0.203 (Re Pr)^(1/3) + 0.220 Re^0.8 Pr^0.4]. At least 2 k0/d of the stagnant bed, because
  // grains at the wall conduct also in a slow flow.
  n.wall_still = 2 * stagnant / d;
  n.wall_third = 0.203 * k / d * std::cbrt(re * pr);
  n.wall_flow = 0.220 * k / d * std::pow(re, 0.8) * std::pow(pr, 0.4);
  return n;
}

Closure LayerClosure::at(double temperature, const MassFlux& flux) const {
  Closure c;
  fill({&temperature, 1}, flux, &c.film, &c.conductivity, &c.wall);
  return c;
}

void LayerClosure::fill(std::span<const double> temperature, const MassFlux& flux, double* film,
                        double* conductivity, double* wall) const {
  const bool disperses = parameters_.conduction != Conduction::constant;
  const double dispersion = disperses ? 0.5 * fluid_.specific_heat * diameter_ * flux.g : 0;  // 0.5 Re Pr k
  const Node* const nodes = nodes_.data();
  for (std::size_t k = 0; k < temperature.size(); ++k) {
    const double place = std::clamp((temperature[k] - first_) * inverse_spacing_, 0.0, double(n_nodes - 2));
    const int i = int(place);
    const double w = place - i;
    const Node &a = nodes[i], &b = nodes[i + 1];
    const auto mix = [&](double Node::*member) { return a.*member + w * (b.*member - a.*member); };
    film[k] = mix(&Node::film_still) + mix(&Node::film_flow) * flux.g_film;
    conductivity[k] = mix(&Node::conduction_still) + dispersion;
    const double moving = mix(&Node::wall_third) * flux.g_third + mix(&Node::wall_flow) * flux.g_wall;
    wall[k] = std::max(mix(&Node::wall_still), moving);
  }
}

double LayerClosure::reynolds(double temperature, double flux) const {
  return flux * diameter_ / fluid_.viscosity(temperature);
}

}  // namespace couplet::thermocline
