// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/term.hpp"
#include "fluid_solver/pressure/wave_rule.hpp"

namespace couplet::fluid {
namespace {

/// Weak compressibility in the pressure equation: dp/dt + rho c^2 div u = 0 in every cell, u relative to faces that may
/// move, for changes of density that are small and Mach numbers below about 0.3. At t^{n+1} with p = p^{n+1/2}
///   rho c^2 div u^{n+1} = -(rate p + past),
/// by the three levels of WaveRule, or by the trapezoidal rule 2 (p - p^n)/dt = -rho c^2 (div u^{n+1} + div u^n)/2 with
/// p^{n+1} = 2 p - p^n, which keeps the energy of what a step does not resolve, too. In the pressure equation
/// V rate/(c^2 dt) joins the diagonal and -V past/(c^2 dt) the right side.
template <int D>
class Compression final : public Term<D> {
 public:
  Compression(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction);

  void prepare(const State<D>& from) override;
  bool sets_level() const override { return rate_ > 0; }
  double version() const override { return (rate_ > 0 ? rate_ : -1) / step_.dt; }
  void add_to_diagonal(Diagonal& diagonal) override;
  /// The size of b less what of it holds p as it was is what the step changes.
  void before(Projected<D>& projected, RightSide& side) override;
  void complete(PressureLevel<D>& level) const override;

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  void set_past(const State<D>& from);
  const std::vector<double>& begin() const;

  bool trapezoidal_;
  double rate_ = 0;                     // of p in dp/dt at the end of the step [1/s]
  std::vector<double> past_, storage_;  // per owned cell [Pa/s], [m]; nothing is stored in closed cells
};

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

}  // namespace

template <int D>
std::unique_ptr<Term<D>> make_compression(const Scene<D>& scene, const Step<D>& step,
                                          const Prediction<D>& prediction) {
  return std::make_unique<Compression<D>>(scene, step, prediction);
}

template std::unique_ptr<Term<2>> make_compression<2>(const Scene<2>&, const Step<2>&, const Prediction<2>&);
template std::unique_ptr<Term<3>> make_compression<3>(const Scene<3>&, const Step<3>&, const Prediction<3>&);

}  // namespace couplet::fluid
