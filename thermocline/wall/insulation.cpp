// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/insulation.hpp"

#include <cmath>
#include <numbers>

namespace couplet::thermocline {
namespace {

struct Node {
  double store, a, b,
      film;  // capacity over the step; half a node, half the next one, the film as resistances
};

/// A node of all rings, the nodes further in being eliminated: half a node and half the next one, or the
/// film, in series, k k'/(a k' + b k).
[[gnu::target_clones("avx2", "default")]] void eliminate(const Node& node, std::size_t n, const double* k,
                                                         const double* next, const double* before,
                                                         const double* eliminated, double* t, double* up,
                                                         double* in) {
  const double store = node.store, a = node.a, b = node.b, film = node.film;
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    const double out = k[i] * next[i] / (next[i] * (a + film * k[i]) + b * k[i]);
    const double inverse = 1 / (store + out + in[i] * (1 - eliminated[i]));
    t[i] = (store * t[i] + in[i] * before[i]) * inverse;
    up[i] = out * inverse;
    in[i] = out;
  }
}

}  // namespace

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
  // Node j: (C/dt) (T - T^n) = g_{j-1} (T_{j-1} - T) + g_j (T_{j+1} - T), per height; from the inside out.
  // up_ holds g_j over the diagonal that is left when the nodes further in are eliminated.
  double* in = in_.data();  // conductance inwards; outwards it is that of the next node inwards
  for (std::size_t i = 0; i < n; ++i) in[i] = inner_[i] = shape_[0] * k_[i];
  for (int j = 0; j < cells_; ++j) {
    double *t = temperature_.data() + j * n, *up = up_.data() + j * n;
    const double *k = k_.data() + j * n, *next = j < last ? k + n : k;
    const double *before = j > 0 ? t - n : inside.data(), *eliminated = j > 0 ? up - n : nothing_.data();
    const Node node{capacity_[j] / dt, 1 / shape_[2 * j + 1], j < last ? 1 / shape_[2 * j + 2] : 0,
                    j < last ? 0 : 1 / (outer_circumference_ * outside.coefficient)};
    eliminate(node, n, k, next, before, eliminated, t, up, in);
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

}  // namespace couplet::thermocline
