// SPDX-License-Identifier: Apache-2.0
// Conduction: its fluxes, and the system of a step.
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/heat/heat.hpp"

namespace couplet::fluid {

namespace {

constexpr double heat_tolerance = 1e-10;  // of the linear solves
constexpr int most_heat_passes = 60, heat_passes_alone = 4, most_heat_iterations = 2000;
constexpr linalg::Acceleration heat_acceleration{linalg::Acceleration::Type::anderson, 1, 6};

}  // namespace

/// (grad T)_P . k of a boundary face, times the diffusivity [K m^3/s].
template <int D>
double HeatTransport<D>::oblique_part(const Placement<D>& at, Index b) const {
  const Index f = mesh_.n_interior + b;
  return gradient_.empty() ? 0.0 : diffusivity_ * gradient_[mesh_.owner[f]].dot(at.oblique_of(f));
}

/// Eliminates T_b from a [g (T_b - T_P) + grad T . k] = [h (T_a - T_b) + q] S/(rho c).
template <int D>
void HeatTransport<D>::set_known(const Placement<D>& at) {
  known_.resize(exchange_.flux.size());
  admittance_.resize(known_.size());
  for (std::size_t b = 0; b < known_.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const double g = diffusivity_ * at.conductance[f], per_area = at.area[f].norm() / capacity_;
    const double film = exchange_.coefficient[b] * per_area, share = std::isinf(film) ? 1 : film / (g + film);
    admittance_[b] = share * g;
    known_[b] = share * (g * exchange_.ambient[b] + oblique_part(at, Index(b))) +
                (1 - share) * exchange_.flux[b] * per_area;
  }
}

/// Temperature of the boundary faces from that of the cells.
template <int D>
void HeatTransport<D>::close(const Placement<D>& at, std::span<const double> temperature,
                             std::vector<double>& boundary) const {
  boundary.resize(known_.size());
  for (std::size_t b = 0; b < known_.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const double inside = temperature[mesh_.owner[f]];
    const double flow = known_[b] - admittance_[b] * inside;
    boundary[b] = std::isinf(exchange_.coefficient[b])
                      ? exchange_.ambient[b]
                      : inside + (flow - oblique_part(at, Index(b))) / (diffusivity_ * at.conductance[f]);
  }
}

/// Flows through the boundary and the sums of the conducted fluxes, a [g (T_N - T_P) + (grad T)_f . k].
template <int D>
void HeatTransport<D>::conduct(const Placement<D>& at, std::span<const double> t, HeatLevel& level) const {
  std::vector<double>& sum = level.conduction;
  sum.assign(t.size(), 0.0);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double flux = diffusivity_ * at.conductance[f] * (t[n] - t[p]);
    sum[p] += flux;
    sum[n] -= flux;
  }
  if (!gradient_.empty() && !at.oblique.empty())
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      const double weight = at.weight[f];
      const double flux =
          diffusivity_ * (weight * gradient_[p] + (1 - weight) * gradient_[n]).dot(at.oblique[f]);
      sum[p] += flux;
      sum[n] -= flux;
    }
  level.flow.resize(known_.size());
  for (std::size_t b = 0; b < known_.size(); ++b) {
    const Index p = mesh_.owner[mesh_.n_interior + Index(b)];
    level.flow[b] = known_[b] - admittance_[b] * t[p];
    sum[p] += level.flow[b];
  }
}

/// Gauss gradient, exact for linear fields.
template <int D>
void HeatTransport<D>::set_gradient(const Placement<D>& at, std::span<const double> t,
                                    std::span<const double> boundary) {
  gradient_.assign(t.size(), Vec<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = (at.weight[f] * t[p] + (1 - at.weight[f]) * t[n]) * at.area[f];
    gradient_[p] += part;
    gradient_[n] -= part;
  }
  for (std::size_t b = 0; b < boundary.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    gradient_[mesh_.owner[f]] += boundary[b] * at.area[f];
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) gradient_[c] /= at.volume[c];
  if (at.skewed())
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      gradient_[c] = (at.gradient_cure[c].transpose() * gradient_[c]).eval();
  mesh_.cells.update_ghosts(flat<D>(gradient_), D);
}

/// A x = V' x + beta sum g (x_P - x_N), with the admittance of the boundary, and the mean of x carried at t^{n+1}.
template <int D>
void HeatTransport<D>::set_rows() {
  const Placement<D>& at = *step_.to;
  if (!rows_) rows_ = std::make_unique<ViscousRows>(mesh_);
  ViscousRows& a = *rows_;
  std::copy_n(at.volume.begin(), a.diagonal.size(), a.diagonal.begin());
  std::size_t e = 0;
  for (Index c = 0; c < a.size(); ++c)
    for (const std::size_t end = e + std::size_t(a.width); e < end; ++e) {
      const Index f = a.face[e];
      const double entry = f < 0 ? 0 : beta_ * at.conductance[f];
      const double out = f < 0 || carried_.empty() ? 0 : mesh_.owner[f] == c ? carried_[f] : -carried_[f];
      a.value[e] = 0.5 * out - entry;
      a.diagonal[c] += 0.5 * out + entry;
    }
  for (std::size_t b = 0; b < admittance_.size(); ++b)
    a.diagonal[mesh_.owner[mesh_.n_interior + Index(b)]] += beta_ / diffusivity_ * admittance_[b];
  for (std::size_t b = 0; !carried_.empty() && b < admittance_.size(); ++b)
    if (const Index f = mesh_.n_interior + Index(b); !std::isinf(exchange_.coefficient[b]))
      a.diagonal[mesh_.owner[f]] += carried_[f];
}

template <int D>
void HeatTransport<D>::apply(std::span<const double> x, std::span<double> y) {
  std::ranges::copy(x, vector_.begin());
  mesh_.cells.update_ghosts(vector_);
  const ViscousRows& a = *rows_;
  const Index* column = a.column.data();
  const double* value = a.value.data();
  for (Index c = 0; c < a.size(); ++c, column += a.width, value += a.width) {
    double row = a.diagonal[c] * vector_[c];
    for (Index e = 0; e < a.width; ++e) row += value[e] * vector_[column[e]];
    y[c] = row;
  }
}

/// Sets the right-hand side: all of conduction at t^{n+1} but the part due to the temperatures of the two cells of a face.
template <int D>
void HeatTransport<D>::set_right_side() {
  const Placement<D>& at = *step_.to;
  right_ = side_;
  const double factor = beta_ / diffusivity_;
  for (std::size_t b = 0; b < known_.size(); ++b)
    right_[mesh_.owner[mesh_.n_interior + Index(b)]] += factor * known_[b];
  for (std::size_t b = 0; !carried_.empty() && b < known_.size(); ++b)
    if (const Index f = mesh_.n_interior + Index(b); std::isinf(exchange_.coefficient[b]))
      right_[mesh_.owner[f]] -= carried_[f] * exchange_.ambient[b];
  if (gradient_.empty() || at.oblique.empty()) return;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double weight = at.weight[f];
    const double flux = beta_ * (weight * gradient_[p] + (1 - weight) * gradient_[n]).dot(at.oblique[f]);
    right_[p] += flux;
    right_[n] -= flux;
  }
}

/// Solves the system in passes on oblique meshes, as that of implicit friction. Its solution gives the fluxes of conduction, and these
/// the temperature, so that the residual of the solver creates no heat.
template <int D>
void HeatTransport<D>::solve(const HeatLevel& level, const Weights& w) {
  const Placement<D>& now = *step_.to;
  const std::size_t owned = std::size_t(mesh_.cells.n_owned());
  const double ratio = step_.ratio(), dt = step_.dt;
  std::vector<double>& t = next_.temperature;
  t = level.temperature;
  if (ratio > 0)
    for (std::size_t c = 0; c < t.size(); ++c) t[c] += ratio * (t[c] - level.temperature_old[c]);
  gradient_.clear();
  set_known(now);
  beta_ = w.a * dt * diffusivity_;
  vector_.resize(t.size());
  set_rows();
  for (int pass = 1;; ++pass) {
    if (scene_.oblique) {
      close(now, t, next_.boundary);
      set_gradient(now, t, next_.boundary);
      set_known(now);
      before_ = t;
    }
    set_right_side();
    solver_.solve(std::span(right_).first(owned), std::span(t).first(owned),
                  {.relative_tolerance = heat_tolerance,
                   .max_iterations = most_heat_iterations,
                   .is_symmetric = carried_.empty(),
                   .carried = most_heat_iterations});
    mesh_.cells.update_ghosts(t);
    if (!scene_.oblique || has_settled(pass)) break;
  }
  conduct(now, t, next_);
  if (!carried_.empty()) carry_implicitly();
  for (std::size_t c = 0; c < owned; ++c) t[c] = (side_[c] + dt * w.a * next_.conduction[c]) / now.volume[c];
  mesh_.cells.update_ghosts(t);
  close(now, t, next_.boundary);
}

/// True if the last pass has hardly changed the temperature; else prepares the next one. Throws SolveFailure.
template <int D>
bool HeatTransport<D>::has_settled(int pass) {
  const double enough = std::clamp(10 * scene_.parameters.pressure_tolerance, 1e-11, 1e-6);
  const std::size_t owned = std::size_t(mesh_.cells.n_owned());
  std::vector<double>& t = next_.temperature;
  double sums[2] = {0, 0};
  for (std::size_t c = 0; c < owned; ++c) {
    sums[0] += (t[c] - before_[c]) * (t[c] - before_[c]);
    sums[1] += t[c] * t[c];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  if (sums[0] <= enough * enough * sums[1]) return true;
  if (pass == most_heat_passes)
    throw SolveFailure(
        "The non-orthogonal correction of the temperature did not converge in {} iterations (change {:.2e}). The mesh is too "
        "skewed; refine or smooth it.",
        most_heat_passes, std::sqrt(sums[0] / sums[1]));
  if (pass < heat_passes_alone) return false;
  if (!accelerator_)
    accelerator_ = std::make_unique<linalg::VectorAccelerator>(mesh_.comm, owned, heat_acceleration);
  if (pass == heat_passes_alone) accelerator_->restart();
  for (std::size_t c = 0; c < owned; ++c) t[c] -= before_[c];
  accelerator_->advance(std::span(before_).first(owned), std::span(t).first(owned));
  t.swap(before_);
  mesh_.cells.update_ghosts(t);
  return false;
}

template void HeatTransport<2>::set_known(const Placement<2>&);
template void HeatTransport<2>::close(const Placement<2>&, std::span<const double>,
                                      std::vector<double>&) const;
template void HeatTransport<2>::conduct(const Placement<2>&, std::span<const double>, HeatLevel&) const;
template void HeatTransport<2>::set_gradient(const Placement<2>&, std::span<const double>,
                                             std::span<const double>);
template void HeatTransport<2>::solve(const HeatLevel&, const Weights&);
template void HeatTransport<2>::apply(std::span<const double>, std::span<double>);
template void HeatTransport<3>::set_known(const Placement<3>&);
template void HeatTransport<3>::close(const Placement<3>&, std::span<const double>,
                                      std::vector<double>&) const;
template void HeatTransport<3>::conduct(const Placement<3>&, std::span<const double>, HeatLevel&) const;
template void HeatTransport<3>::set_gradient(const Placement<3>&, std::span<const double>,
                                             std::span<const double>);
template void HeatTransport<3>::solve(const HeatLevel&, const Weights&);
template void HeatTransport<3>::apply(std::span<const double>, std::span<double>);

}  // namespace couplet::fluid
