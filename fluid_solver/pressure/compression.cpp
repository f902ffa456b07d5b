// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/compression.hpp"

#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {

template <int D>
Compression<D>::Compression(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction)
    : Term<D>(scene, step, prediction),
      trapezoidal_(scene.parameters.compressibility->scheme == WaveScheme::trapezoidal) {}

/// p at the begin of the step, for the trapezoidal rule.
template <int D>
const std::vector<double>& Compression<D>::begin() const {
  const PressureLevel<D>& level = *step_.by.pressure[0];
  return level.end.empty() ? level.p : level.end;
}

template <int D>
void Compression<D>::set_past(const State<D>& from) {
  const Index owned = mesh_.cells.n_owned();
  past_.assign(mesh_.cells.n_local(), 0.0);
  if (trapezoidal_) {
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      past_[mesh_.owner[f]] += from.phi[f];
      if (f < mesh_.n_interior) past_[mesh_.neighbour[f]] -= from.phi[f];
    }
    const double bulk = scene_.fluid.rho * scene_.fluid.sound * scene_.fluid.sound;
    const std::vector<double>& p = begin();
    for (Index c = 0; c < owned; ++c) past_[c] = bulk * past_[c] / from.placement->volume[c] - rate_ * p[c];
    return;
  }
  const WaveRule rule = wave_rule(step_);
  for (std::size_t k = 0; k < rule.past.size(); ++k) {
    if (rule.past[k] == 0) continue;
    const std::vector<double>& p = step_.by.pressure[k]->p;
    for (Index c = 0; c < owned; ++c) past_[c] += rule.past[k] * p[c];
  }
}

template <int D>
void Compression<D>::prepare(const State<D>& from) {
  const Index owned = mesh_.cells.n_owned();
  rate_ = wave_rate(step_, trapezoidal_);
  storage_.assign(owned, 0.0);
  if (!step_.by.pressure[0]) return;
  set_past(from);
  const double factor = rate_ / (scene_.fluid.sound * scene_.fluid.sound * step_.dt);
  for (Index c = 0; c < owned; ++c) storage_[c] = factor * step_.to->volume[c];
  scene_.obstacles->clear(storage_);
}

template <int D>
void Compression<D>::add_to_diagonal(Diagonal& diagonal) {
  if (sets_level()) diagonal.cells = storage_;
}

template <int D>
void Compression<D>::before(Projected<D>&, RightSide& side) {
  if (!sets_level()) return;
  std::vector<double>& b = side.b;
  double square = 0;
  for (std::size_t c = 0; c < b.size(); ++c) {
    double changed = b[c];
    if (storage_[c] > 0) {
      b[c] -= storage_[c] / rate_ * past_[c];
      changed = b[c] - storage_[c] * step_.by.pressure[0]->p[c];
    }
    square += changed * changed;
  }
  side.size = std::sqrt(parallel::sum(mesh_.comm, square));
}

template <int D>
void Compression<D>::complete(PressureLevel<D>& level) const {
  if (sets_level())
    for (std::size_t c = 0; c < storage_.size(); ++c)
      level.taken_up += storage_[c] * step_.dt / scene_.fluid.rho * (level.p[c] + past_[c] / rate_);
  if (!trapezoidal_) return;
  level.end = level.p;
  if (step_.by.pressure[0]) {
    const std::vector<double>& p = begin();
    for (std::size_t c = 0; c < level.p.size(); ++c) level.end[c] = 2 * level.p[c] - p[c];
  }
}

template class Compression<2>;
template class Compression<3>;

}  // namespace couplet::fluid
