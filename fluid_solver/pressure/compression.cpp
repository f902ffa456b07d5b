// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/compression.hpp"

#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {

template <int D>
Compression<D>::Compression(StepWork<D>& work)
    : k_(work), trapezoidal_(work.parameters.compressibility->scheme == WaveScheme::trapezoidal) {}

/// p at the begin of the step, for the trapezoidal rule.
template <int D>
const std::vector<double>& Compression<D>::begin() const {
  const PressureLevel<D>& level = *k_.by.pressure[0];
  return level.end.empty() ? level.p : level.end;
}

template <int D>
void Compression<D>::set_past(const State<D>& from) {
  const Index owned = k_.mesh.cells.n_owned();
  past_.assign(k_.mesh.cells.n_local(), 0.0);
  if (trapezoidal_) {
    for (Index f = 0; f < k_.mesh.n_flux_faces(); ++f) {
      past_[k_.mesh.owner[f]] += from.phi[f];
      if (f < k_.mesh.n_interior) past_[k_.mesh.neighbour[f]] -= from.phi[f];
    }
    const double bulk = k_.rho * k_.sound * k_.sound;
    const std::vector<double>& p = begin();
    for (Index c = 0; c < owned; ++c) past_[c] = bulk * past_[c] / from.placement->volume[c] - rate_ * p[c];
    return;
  }
  const WaveRule rule = wave_rule(k_);
  for (std::size_t k = 0; k < rule.past.size(); ++k) {
    if (rule.past[k] == 0) continue;
    const std::vector<double>& p = k_.by.pressure[k]->p;
    for (Index c = 0; c < owned; ++c) past_[c] += rule.past[k] * p[c];
  }
}

template <int D>
void Compression<D>::prepare(const State<D>& from) {
  const Index owned = k_.mesh.cells.n_owned();
  const bool known = k_.by.pressure[0] != nullptr;
  rate_ = !known ? 0 : trapezoidal_ ? 4 / k_.step.dt : wave_rule(k_).rate;
  storage_.assign(owned, 0.0);
  if (!known) return;
  set_past(from);
  const double factor = rate_ / (k_.sound * k_.sound * k_.step.dt);
  for (Index c = 0; c < owned; ++c)
    if (!k_.gap_closed() || !k_.gaps->is_blocked(c)) storage_[c] = factor * k_.step.to->volume[c];
}

template <int D>
double Compression<D>::add_to(std::vector<double>& b) const {
  double square = 0;
  for (std::size_t c = 0; c < b.size(); ++c) {
    double changed = b[c];
    if (storage_[c] > 0) {
      b[c] -= storage_[c] / rate_ * past_[c];
      changed = b[c] - storage_[c] * k_.by.pressure[0]->p[c];
    }
    square += changed * changed;
  }
  return std::sqrt(parallel::sum(k_.mesh.comm, square));
}

template <int D>
void Compression<D>::complete(PressureLevel<D>& level) const {
  if (active())
    for (std::size_t c = 0; c < storage_.size(); ++c)
      level.taken_up += storage_[c] * k_.step.dt / k_.rho * (level.p[c] + past_[c] / rate_);
  if (!trapezoidal_) return;
  level.end = level.p;
  level.end.push_back(0);  // of the volume upstream, if there is one
  if (k_.by.pressure[0]) {
    const std::vector<double>& p = begin();
    for (std::size_t c = 0; c < level.p.size(); ++c) level.end[c] = 2 * level.p[c] - p[c];
  }
}

template class Compression<2>;
template class Compression<3>;

}  // namespace couplet::fluid
