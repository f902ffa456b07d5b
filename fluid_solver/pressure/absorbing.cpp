// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/absorbing.hpp"

#include <cmath>

#include "fluid_solver/pressure/wave_rule.hpp"

namespace couplet::fluid {
namespace {

// Of the travel time of sound across the mesh: the time of the means by default.
constexpr double mean_times = 10;

}  // namespace

template <int D>
AbsorbingBoundaries<D>::AbsorbingBoundaries(StepWork<D>& work, double size)
    : k_(work),
      mean_time_(work.parameters.compressibility->mean_time.value_or(mean_times * size / work.sound)) {}

/// Over each patch: of v at outlets, of p at inlets.
template <int D>
void AbsorbingBoundaries<D>::means_of(const std::vector<double>& v, const std::vector<double>& p,
                                      const Placement<D>& at, std::vector<double>& means) const {
  const auto& patches = k_.boundary.absorbing_patches();
  std::vector<double> sums(2 * patches.size(), 0.0);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const auto& [faces, inlet] = patches[i];
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      const double area = at.area[k_.mesh.n_interior + b].norm();
      sums[2 * i] += area * (inlet ? p : v)[b];
      sums[2 * i + 1] += area;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, k_.mesh.comm);
  means.resize(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) means[i] = sums[2 * i] / sums[2 * i + 1];
}

/// The means move by their filter as if the last half step went on.
template <int D>
void AbsorbingBoundaries<D>::prepare(const State<D>& from) {
  before_ = &from.openings;
  weight_ = middle_weights(k_.step.dt, k_.by.dt_old);
  const std::vector<double> rest(k_.w.size(), 0.0);
  means_of(from.openings.now, k_.by.pressure[0] ? k_.by.pressure[0]->boundary : rest, *from.placement, mean_);
  const double moved = -std::expm1(-0.5 * k_.step.dt / mean_time_);
  for (std::size_t i = 0; i < mean_.size(); ++i) {
    const double last = from.openings.mean[i];
    mean_[i] = last + moved * (mean_[i] - last);
  }
}

template <int D>
double AbsorbingBoundaries<D>::share(Index b) const {
  const Index f = k_.mesh.n_interior + b;
  const double area = k_.step.to->area[f].norm();
  return 1 / (1 + weight_[0] * k_.sound * k_.step.dt * k_.step.to->conductance[f] / area);
}

template <int D>
double AbsorbingBoundaries<D>::past(Index b) const {
  return weight_[1] * before_->now[b] + weight_[2] * before_->old[b];
}

template <int D>
void AbsorbingBoundaries<D>::add_admittance(std::vector<double>& values) const {
  for (const auto& [faces, inlet] : k_.boundary.absorbing_patches())
    for (Index b = faces.first; b < faces.first + faces.count; ++b)
      values[b] += (share(b) - (inlet ? 0 : 1)) * k_.step.to->conductance[k_.mesh.n_interior + b];
}

template <int D>
void AbsorbingBoundaries<D>::foresee(const State<D>& from) {
  const Placement<D>& at = *k_.step.to;
  const double impedance = k_.rho * k_.sound;
  std::size_t i = 0;
  for (const auto& [faces, inlet] : k_.boundary.absorbing_patches()) {
    const double mean = mean_[i++];
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      if (!inlet) {
        k_.p_boundary[b] += impedance * (past(b) - mean);
        continue;
      }
      // p_b = p_P + source - inertia (w - w^n).n
      const Index f = k_.mesh.n_interior + b, p = k_.mesh.owner[f];
      const double area = at.area[f].norm(), g = at.conductance[f],
                   inertia = k_.rho * area / (g * k_.step.dt);
      const Vec<D> n = at.area[f] / area;
      double source = 0;
      if (!k_.force.empty()) source += k_.rho * k_.force[p].dot(at.area[f]) / g;
      if (!k_.gradient_guess.empty()) source -= k_.gradient_guess[p].dot(at.oblique_of(f)) / g;
      const double pressure = source - mean - inertia * (k_.w[b] - from.w[b]).dot(n);
      k_.w[b] += (pressure - impedance * past(b)) / (weight_[0] * impedance + inertia) * n;
      k_.phi_p[f] = k_.w[b].dot(at.area[f]);
    }
  }
}

template <int D>
void AbsorbingBoundaries<D>::add_to(std::vector<double>& b_side) const {
  for (const auto& [faces, inlet] : k_.boundary.absorbing_patches()) {
    if (inlet) continue;
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      const Index f = k_.mesh.n_interior + b;
      const double more = k_.rho / k_.step.dt * k_.phi_p[f] - k_.step.to->conductance[f] * k_.p_boundary[b];
      b_side[k_.mesh.owner[f]] += (1 - share(b)) * more;
    }
  }
}

template <int D>
void AbsorbingBoundaries<D>::follow() {
  const Placement<D>& at = *k_.step.to;
  const double factor = k_.step.dt / k_.rho;
  for (const auto& [faces, inlet] : k_.boundary.absorbing_patches())
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      const Index f = k_.mesh.n_interior + b;
      const double area = at.area[f].norm(), g = at.conductance[f], p = k_.p[k_.mesh.owner[f]];
      if (inlet) {
        k_.w[b] += factor * share(b) * g * p / area * (at.area[f] / area);
        k_.phi_p[f] = k_.w[b].dot(at.area[f]);
      } else {
        const double flux = share(b) * (k_.phi_p[f] - factor * g * (k_.p_boundary[b] - p));
        k_.p_boundary[b] += weight_[0] * k_.rho * k_.sound * flux / area;
      }
    }
}

template <int D>
void AbsorbingBoundaries<D>::commit(State<D>& s) const {
  const Placement<D>& at = *k_.step.to;
  Vectors<D> given(k_.w.size(), Vec<D>::Zero());
  k_.boundary.velocity_at(k_.by.time + k_.step.dt, at.boundary_centre, given);
  std::vector<double> means, now;
  means_of(s.openings.now, k_.p_boundary, *s.placement, means);
  s.openings.old.swap(s.openings.now);
  s.openings.now.assign(k_.w.size(), 0.0);
  for (const auto& [faces, inlet] : k_.boundary.absorbing_patches())
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      const Index f = k_.mesh.n_interior + b;
      const double area = at.area[f].norm();
      s.openings.now[b] = (inlet ? (k_.w[b] - given[b]).dot(at.area[f]) : k_.phi_p[f]) / area;
    }
  means_of(s.openings.now, k_.p_boundary, at, now);
  const double moved = -std::expm1(-k_.step.dt / mean_time_);
  for (std::size_t i = 0; i < now.size(); ++i)
    s.openings.mean[i] += moved * (0.5 * (means[i] + now[i]) - s.openings.mean[i]);
}

template <int D>
void AbsorbingBoundaries<D>::start(State<D>& s) const {
  s.openings.now.assign(s.w.size(), 0.0);
  for (const auto& [faces, inlet] : k_.boundary.absorbing_patches())
    for (Index b = faces.first; b < faces.first + faces.count && !inlet; ++b) {
      const Index f = k_.mesh.n_interior + b;
      s.openings.now[b] = s.phi[f] / s.placement->area[f].norm();
    }
  s.openings.old = s.openings.now;
  const std::vector<double> rest(s.w.size(), 0.0);
  means_of(s.openings.now, s.pressure[0] ? s.pressure[0]->boundary : rest, *s.placement, s.openings.mean);
}

template class AbsorbingBoundaries<2>;
template class AbsorbingBoundaries<3>;

}  // namespace couplet::fluid
