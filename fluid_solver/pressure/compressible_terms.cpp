// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

namespace {

/// Weak compressibility in the pressure equation: dp/dt + rho c^2 div u = 0 in every cell, u relative to
/// moving faces, for Mach numbers below 0.3. At t^{n+1} with p = p^{n+1/2} and the three-level WaveRule
///   rho c^2 div u^{n+1} = -(rate p + past),
/// or by the trapezoidal rule 2 (p - p^n)/dt = -rho c^2 (div u^{n+1} + div u^n)/2 with p^{n+1} = 2 p - p^n,
/// which conserves the energy of unresolved waves. Adds V rate/(c^2 dt) to the diagonal and -V past/(c^2 dt)
/// to the right side.
template <int D>
class Compression final : public Term<D> {
 public:
  Compression(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction)
      : Term<D>(scene, step, prediction),
        trapezoidal_(scene.parameters.compressibility->scheme == WaveScheme::trapezoidal) {}

  void prepare(const State<D>& from) override {
    const Index owned = mesh_.cells.n_owned();
    rate_ = wave_rate(step_, trapezoidal_);
    storage_.assign(owned, 0.0);
    if (!step_.by.pressure[0]) return;
    set_past(from);
    const double factor = rate_ / (scene_.fluid.sound * scene_.fluid.sound * step_.dt);
    for (Index c = 0; c < owned; ++c) storage_[c] = factor * step_.to->volume[c];
    scene_.obstacles->clear(storage_);
  }
  bool keeps_pressure() const override { return true; }
  bool sets_level() const override { return rate_ > 0; }
  double version() const override { return (rate_ > 0 ? rate_ : -1) / step_.dt; }
  void add_to_diagonal(Diagonal& diagonal) override {
    if (sets_level()) diagonal.cells = storage_;
  }
  /// The scale is b without the part that keeps the old p, because the rest is the change by the step.
  void before(Projected<D>&, RightSide& side) override {
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
  void complete(PressureLevel<D>& level) const override {
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

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  void set_past(const State<D>& from) {
    const Index owned = mesh_.cells.n_owned();
    past_.assign(mesh_.cells.n_local(), 0.0);
    if (trapezoidal_) {
      add_outflow(mesh_, from.phi, past_);
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
  /// p at the start of the step, for the trapezoidal rule.
  const std::vector<double>& begin() const {
    const PressureLevel<D>& level = *step_.by.pressure[0];
    return level.end.empty() ? level.p : level.end;
  }

  bool trapezoidal_;
  double rate_ = 0;                     // of p in dp/dt at the end of the step [1/s]
  std::vector<double> past_, storage_;  // per owned cell [Pa/s], [m]; nothing is stored in closed cells
};

// Default averaging time, in travel times of sound across the mesh.
constexpr double mean_times = 10;

/// Boundaries that let pressure waves out. With v the outward speed relative to the given one at t^{n+1/2},
///   outlet: p_b = p_given + rho c (v - mean v),  v = phi/S
///   inlet:  rho c v = p_b - mean p_b,            v = (w - given).n
/// Means over the patch and a relaxation time preserve the given values. Implicit: v at t^{n+1/2} is
/// middle_weights() of v at t^{n+1} and before, which scales the face's conductance by 1/(1 + a c dt g/S).
template <int D>
class AbsorbingBoundaries final : public Term<D> {
 public:
  AbsorbingBoundaries(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction)
      : Term<D>(scene, step, prediction) {
    const double size = largest_extent(scene.mesh, scene.points_at_rest);
    mean_time_ = scene.parameters.compressibility->mean_time.value_or(mean_times * size / scene.fluid.sound);
  }

  /// The means follow their filter as if the last half step continued.
  void prepare(const State<D>& from) override {
    before_ = &from.openings;
    weight_ = middle_weights(step_.dt, step_.by.dt_old);
    const std::vector<double> rest(from.w.size(), 0.0);
    means_of(from.openings.now, step_.by.pressure[0] ? step_.by.pressure[0]->boundary : rest, *from.placement,
             mean_);
    const double moved = -std::expm1(-0.5 * step_.dt / mean_time_);
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      const double last = from.openings.mean[i];
      mean_[i] = last + moved * (mean_[i] - last);
    }
  }
  double version() const override { return weight_[0] * step_.dt; }
  void add_to_diagonal(Diagonal& diagonal) override {
    diagonal.faces.resize(prediction_.w.size(), 0.);
    for (const auto& [faces, inlet] : scene_.boundary.absorbing_patches())
      for (Index b = faces.first; b < faces.first + faces.count; ++b)
        diagonal.faces[b] += (share(b) - (inlet ? 0 : 1)) * step_.to->conductance[mesh_.n_interior + b];
  }
  void foresee(const State<D>& from, Projected<D>& out) override {
    const Placement<D>& at = *step_.to;
    const double impedance = scene_.fluid.rho * scene_.fluid.sound;
    std::size_t i = 0;
    for (const auto& [faces, inlet] : scene_.boundary.absorbing_patches()) {
      const double mean = mean_[i++];
      for (Index b = faces.first; b < faces.first + faces.count; ++b) {
        if (!inlet) {
          out.boundary[b] += impedance * (past(b) - mean);
          continue;
        }
        // p_b = p_P + source - inertia (w - w^n).n
        const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
        const double area = at.area[f].norm(), g = at.conductance[f],
                     inertia = scene_.fluid.rho * area / (g * step_.dt);
        const Vec<D> n = at.area[f] / area;
        double source = 0;
        if (!prediction_.force.empty()) source += scene_.fluid.rho * prediction_.force[p].dot(at.area[f]) / g;
        if (!out.gradient.empty()) source -= out.gradient[p].dot(at.oblique_of(f)) / g;
        const double pressure = source - mean - inertia * (out.w[b] - from.w[b]).dot(n);
        out.w[b] += (pressure - impedance * past(b)) / (weight_[0] * impedance + inertia) * n;
        out.phi[f] = out.w[b].dot(at.area[f]);
      }
    }
  }
  /// Subtracts the response of faces with given pressure.
  void before(Projected<D>& out, RightSide& side) override {
    for (const auto& [faces, inlet] : scene_.boundary.absorbing_patches()) {
      if (inlet) continue;
      for (Index b = faces.first; b < faces.first + faces.count; ++b) {
        const Index f = mesh_.n_interior + b;
        const double more =
            scene_.fluid.rho / step_.dt * out.phi[f] - step_.to->conductance[f] * out.boundary[b];
        side.b[mesh_.owner[f]] += (1 - share(b)) * more;
      }
    }
  }
  void after(Projected<D>& out) override {
    const Placement<D>& at = *step_.to;
    const double factor = step_.dt / scene_.fluid.rho;
    for (const auto& [faces, inlet] : scene_.boundary.absorbing_patches())
      for (Index b = faces.first; b < faces.first + faces.count; ++b) {
        const Index f = mesh_.n_interior + b;
        const double area = at.area[f].norm(), g = at.conductance[f], p = out.p[mesh_.owner[f]];
        if (inlet) {
          out.w[b] += factor * share(b) * g * p / area * (at.area[f] / area);
          out.phi[f] = out.w[b].dot(at.area[f]);
        } else {
          const double flux = share(b) * (out.phi[f] - factor * g * (out.boundary[b] - p));
          out.boundary[b] += weight_[0] * scene_.fluid.rho * scene_.fluid.sound * flux / area;
        }
      }
  }
  /// Sets state.openings.
  void commit(const Projected<D>& out, State<D>& s) const override {
    const Placement<D>& at = *step_.to;
    Vectors<D> given(out.w.size(), Vec<D>::Zero());
    scene_.boundary.velocity_at(step_.end(), mesh_, at, given);
    std::vector<double> means, now;
    means_of(s.openings.now, out.boundary, *s.placement, means);
    s.openings.old.swap(s.openings.now);
    s.openings.now.assign(out.w.size(), 0.0);
    for (const auto& [faces, inlet] : scene_.boundary.absorbing_patches())
      for (Index b = faces.first; b < faces.first + faces.count; ++b) {
        const Index f = mesh_.n_interior + b;
        const double area = at.area[f].norm();
        s.openings.now[b] = (inlet ? (out.w[b] - given[b]).dot(at.area[f]) : out.phi[f]) / area;
      }
    means_of(s.openings.now, out.boundary, at, now);
    const double moved = -std::expm1(-step_.dt / mean_time_);
    for (std::size_t i = 0; i < now.size(); ++i)
      s.openings.mean[i] += moved * (0.5 * (means[i] + now[i]) - s.openings.mean[i]);
  }
  void start(State<D>& s) const override {
    s.openings.now.assign(s.w.size(), 0.0);
    for (const auto& [faces, inlet] : scene_.boundary.absorbing_patches())
      for (Index b = faces.first; b < faces.first + faces.count && !inlet; ++b) {
        const Index f = mesh_.n_interior + b;
        s.openings.now[b] = s.phi[f] / s.placement->area[f].norm();
      }
    s.openings.old = s.openings.now;
    const std::vector<double> rest(s.w.size(), 0.0);
    means_of(s.openings.now, s.pressure[0] ? s.pressure[0]->boundary : rest, *s.placement, s.openings.mean);
  }
  using Term<D>::start;

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  using Term<D>::prediction_;
  double share(Index b) const {
    const Index f = mesh_.n_interior + b;
    const double area = step_.to->area[f].norm();
    return 1 / (1 + weight_[0] * scene_.fluid.sound * step_.dt * step_.to->conductance[f] / area);
  }
  double past(Index b) const { return weight_[1] * before_->now[b] + weight_[2] * before_->old[b]; }
  /// Over each patch: of v at outlets, of p at inlets.
  void means_of(const std::vector<double>& v, const std::vector<double>& p, const Placement<D>& at,
                std::vector<double>& means) const {
    const auto& patches = scene_.boundary.absorbing_patches();
    std::vector<double> sums(2 * patches.size(), 0.0);
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const auto& [faces, inlet] = patches[i];
      for (Index b = faces.first; b < faces.first + faces.count; ++b) {
        const double area = at.area[mesh_.n_interior + b].norm();
        sums[2 * i] += area * (inlet ? p : v)[b];
        sums[2 * i + 1] += area;
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
    means.resize(patches.size());
    for (std::size_t i = 0; i < patches.size(); ++i) means[i] = sums[2 * i] / sums[2 * i + 1];
  }

  double mean_time_;                       // [s]
  std::array<double, 3> weight_{};         // of v at t^{n+1}, t^n, t^{n-1}
  const OpeningsState* before_ = nullptr;  // of level n
  std::vector<double> mean_;               // at t^{n+1/2}, per patch
};

}  // namespace

template <int D>
void add_compressible_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                            Terms<D>& terms) {
  add_term<AbsorbingBoundaries<D>>(!scene.boundary.absorbing_patches().empty(), scene, step, prediction,
                                   terms);
  add_term<Compression<D>>(scene.is_compressible(), scene, step, prediction, terms);
}

template decltype(add_compressible_terms<2>) add_compressible_terms<2>;
template decltype(add_compressible_terms<3>) add_compressible_terms<3>;

}  // namespace couplet::fluid
