// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/momentum/rates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

namespace {

/// `Width`: entries per row if known at compile time; 0 means a.width.
template <int D, int Width>
[[gnu::always_inline]] inline double multiply_rows(const ViscousRows& a, const Vectors<D>& x, Vectors<D>& y) {
  const Index width = Width > 0 ? Width : a.width;
  const Index* column = a.column.data();
  const double* value = a.value.data();
  double sum = 0;
  for (Index c = 0, end = a.size(); c < end; ++c, column += width, value += width) {
    Vec<D> row = a.diagonal[c] * x[c];
    for (Index e = 0; e < width; ++e) row += value[e] * x[column[e]];
    y[c] = row;
    sum += row.dot(x[c]);
  }
  return sum;
}

/// y = A x; returns x.y over the owned cells. `x`: vector per local cell, with ghosts current.
template <int D>
COUPLET_PROCESSOR_CLONES double multiply(const ViscousRows& a, const Vectors<D>& x, Vectors<D>& y) {
  switch (a.width) {
    case 3:
      return multiply_rows<D, 3>(a, x, y);
    case 4:
      return multiply_rows<D, 4>(a, x, y);
    case 6:
      return multiply_rows<D, 6>(a, x, y);
    default:
      return multiply_rows<D, 0>(a, x, y);
  }
}

/// A step of CG: u += alpha s, r -= alpha q; returns r.r.
COUPLET_PROCESSOR_CLONES double go_along(double alpha, std::span<const double> s, std::span<const double> q,
                                         std::span<double> u, std::span<double> r) {
  std::array<double, 4> sums{};  // side by side, for one register
  std::size_t i = 0;
  for (; i + 4 <= s.size(); i += 4)
    for (std::size_t k = 0; k < 4; ++k) {
      u[i + k] += alpha * s[i + k];
      r[i + k] -= alpha * q[i + k];
      sums[k] += r[i + k] * r[i + k];
    }
  for (; i < s.size(); ++i) {
    u[i] += alpha * s[i];
    r[i] -= alpha * q[i];
    sums[0] += r[i] * r[i];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// The next search direction: s = r + gamma s.
COUPLET_PROCESSOR_CLONES void turn_search(double gamma, std::span<const double> r, std::span<double> s) {
  for (std::size_t i = 0; i < s.size(); ++i) s[i] = r[i] + gamma * s[i];
}

constexpr int most_iterations = 2000;

constexpr int most_passes = 60, passes_alone = 4;
constexpr linalg::Acceleration pass_acceleration{linalg::Acceleration::Type::anderson, 1, 6};

}  // namespace

ViscousRows::ViscousRows(const mesh::Mesh& mesh) : diagonal(mesh.cells.n_owned()) {
  const Index owned = mesh.cells.n_owned();
  std::vector<Index> count(owned, 0);
  for (Index f = 0; f < mesh.n_interior; ++f)
    for (const Index c : {mesh.owner[f], mesh.neighbour[f]})
      if (c < owned) width = std::max(width, ++count[c]);
  const std::size_t entries = static_cast<std::size_t>(owned) * width;
  column.resize(entries), face.assign(entries, -1), value.assign(entries, 0.0);
  for (std::size_t e = 0; e < entries; ++e) column[e] = static_cast<Index>(e / width);
  count.assign(owned, 0);
  const auto add = [&](Index from, Index to, Index f) {
    if (from >= owned) return;
    const std::size_t e = static_cast<std::size_t>(from) * width + count[from]++;
    column[e] = to, face[e] = f;
  };
  for (Index f = 0; f < mesh.n_interior; ++f) {
    add(mesh.owner[f], mesh.neighbour[f], f);
    add(mesh.neighbour[f], mesh.owner[f], f);
  }
}

/// a_->diagonal excludes the boundary, inverse_diagonal_ includes it.
template <int D>
void ViscousSolver<D>::set_diagonal(std::span<const double> added) {
  const Placement<D>& at = *at_;
  std::copy_n(at.volume.begin(), a_->size(), a_->diagonal.begin());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double entry = (beta_ + (added.empty() ? 0 : added[f])) * at.conductance[f];
    for (const Index c : {p, n})
      if (c < a_->size()) a_->diagonal[c] += entry;
  }
  inverse_diagonal_ = a_->diagonal;
  boundary_rows_.clear();
  const BoundaryRows& given = boundary_.rows();
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index b = f - mesh_.n_interior;
    const double a = (beta_ + (added.empty() ? 0 : added[f])) * at.conductance[f], t = given.friction[b];
    inverse_diagonal_[mesh_.owner[f]] += a;
    boundary_rows_.push_back(
        {mesh_.owner[f], a * t, a * (1 - given.pressure[b] - t), at.area[f].normalized()});
  }
  for (double& value : inverse_diagonal_) value = 1 / value;
}

/// Skew-symmetric but for the net outflow of a cell.
template <int D>
void ViscousSolver<D>::add_carried(std::span<const double> carried) {
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    const bool inside = f < mesh_.n_interior;
    if (const Index p = mesh_.owner[f]; p < a_->size()) a_->diagonal[p] += (inside ? 0.5 : 1) * carried[f];
    if (const Index n = inside ? mesh_.neighbour[f] : a_->size(); n < a_->size())
      a_->diagonal[n] -= 0.5 * carried[f];
  }
}

template <int D>
void ViscousSolver<D>::set_entries(std::span<const double> added, std::span<const double> carried) {
  scale_.resize(mesh_.cells.n_local());
  for (Index c = 0; c < a_->size(); ++c) {
    scale_[c] = std::sqrt(inverse_diagonal_[c]);
    a_->diagonal[c] *= inverse_diagonal_[c];
  }
  mesh_.cells.update_ghosts(scale_);
  std::size_t e = 0;
  for (Index c = 0; c < a_->size(); ++c)
    for (const std::size_t end = e + a_->width; e < end; ++e)
      if (const Index f = a_->face[e]; f >= 0) {
        double entry = -(beta_ + (added.empty() ? 0 : added[f])) * at_->conductance[f];
        if (carries_) entry += (mesh_.owner[f] == c ? 0.5 : -0.5) * carried[f];
        a_->value[e] = entry * scale_[c] * scale_[a_->column[e]];
      }
}

template <int D>
void ViscousSolver<D>::prepare(std::shared_ptr<const Placement<D>> at, double beta,
                               std::span<const double> added, std::span<const double> carried) {
  // Equal on all ranks, because each step of a moving mesh has its own placement.
  if (at == at_ && beta == beta_ && added.empty() && carried.empty() && !has_more_) return;
  at_ = std::move(at);
  beta_ = beta;
  carries_ = !carried.empty();
  has_more_ = !added.empty() || carries_;
  if (!a_) a_ = std::make_unique<ViscousRows>(mesh_);
  set_diagonal(added);
  if (carries_) add_carried(carried);
  set_entries(added, carried);
}

/// Returns x.y of this rank.
template <int D>
double ViscousSolver<D>::apply(Vectors<D>& x, Vectors<D>& y) const {
  mesh_.cells.update_ghosts(flat<D>(x), D);
  double sum = multiply(*a_, x, y);
  for (const ViscousBoundaryRow<D>& row : boundary_rows_) {
    const Vec<D> part = inverse_diagonal_[row.cell] * row.times(x[row.cell]);
    y[row.cell] += part;
    sum += part.dot(x[row.cell]);
  }
  return sum;
}

template <int D>
int ViscousSolver<D>::solve(const Vectors<D>& w, double tolerance, Vectors<D>& b, Vectors<D>& u) {
  const Index owned = mesh_.cells.n_owned();
  for (Vectors<D>* each : {&x_, &r_, &q_, &search_}) each->resize(u.size());
  for (std::size_t face = 0; face < boundary_rows_.size(); ++face)
    b[boundary_rows_[face].cell] += boundary_rows_[face].times(w[face]);
  for (Index c = 0; c < owned; ++c) x_[c] = u[c] / scale_[c];
  apply(x_, q_);
  double sums[2] = {};  // b.D^-1 b, r.D^-1 r
  for (Index c = 0; c < owned; ++c) {
    const Vec<D> scaled = scale_[c] * b[c];
    search_[c] = r_[c] = scaled - q_[c];
    sums[0] += scaled.squaredNorm();
    sums[1] += r_[c].squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double goal = tolerance * tolerance * sums[0];
  const std::size_t n = static_cast<std::size_t>(owned) * D;
  if (carries_) {
    if (!krylov_)
      krylov_ = std::make_unique<linalg::KrylovSolver>(
          "the predicted velocity", mesh_.comm, n,
          [this, n](std::span<const double> x, std::span<double> y) {
            std::ranges::copy(x, flat<D>(search_).begin());
            apply(search_, q_);
            std::ranges::copy(flat<D>(q_).first(n), y.begin());
          },
          [](std::span<const double> x, std::span<double> y) { std::ranges::copy(x, y.begin()); });
    for (Index c = 0; c < owned; ++c) r_[c] = scale_[c] * b[c];
    const int needed = krylov_
                           ->solve(flat<D>(r_).first(n), flat<D>(x_).first(n),
                                   {.relative_tolerance = tolerance, .is_hard = true})
                           .iterations;
    for (Index c = 0; c < owned; ++c) u[c] = scale_[c] * x_[c];
    mesh_.cells.update_ghosts(flat<D>(u), D);
    return needed;
  }
  double rr = sums[1];
  int iterations = 0;
  while (rr > goal && iterations < most_iterations) {
    ++iterations;
    const double curvature = parallel::sum(mesh_.comm, apply(search_, q_));
    if (!(curvature > 0)) break;
    const double next =
        parallel::sum(mesh_.comm, go_along(rr / curvature, flat<D>(search_).first(n), flat<D>(q_).first(n),
                                           flat<D>(x_).first(n), flat<D>(r_).first(n)));
    turn_search(next / std::exchange(rr, next), flat<D>(r_).first(n), flat<D>(search_).first(n));
  }
  // The tolerance cannot be below the round-off of b; slightly above counts as solved.
  if (!(rr <= std::max(goal, 1e-26 * sums[0])))
    throw SolveFailure(
        "The implicit viscous solve did not converge: residual {:.3e} of {:.3e} after {} iterations. {}",
        std::sqrt(rr), std::sqrt(sums[0]), iterations,
        largest_entry(find_largest(mesh_, *at_, [&](Index c) { return b[c].norm(); })));
  for (Index c = 0; c < owned; ++c) u[c] = scale_[c] * x_[c];
  mesh_.cells.update_ghosts(flat<D>(u), D);
  return iterations;
}

template class ViscousSolver<2>;
template class ViscousSolver<3>;

/// Residuals accumulate over the steps, so the tolerance is much smaller than the change of u per step.
template <int D>
double ImplicitFriction<D>::tolerance() const {
  return std::min(1e-7, 0.1 * scene_.parameters.pressure_tolerance);
}

/// First guess u^n + r (u^n - u^{n-1}) and one Jacobi sweep, without a face loop: its viscous rate is
/// extrapolated too.
template <int D>
void ImplicitFriction<D>::guess(const State<D>& from, const Rates<D>& rates, double a, const Vectors<D>& side,
                                Vectors<D>& u) const {
  if (step_.by.dt_old == 0) {
    u = from.u;
    return;
  }
  const double ratio = step_.ratio();
  const std::vector<double>& inverse = solver_.inverse_diagonal();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Vec<D> ahead = from.u[c] + ratio * (from.u[c] - from.u_old[c]);
    const Vec<D> rate = rates.viscous[c] + ratio * (rates.viscous[c] - from.rates_old.viscous[c]);
    u[c] = ahead + inverse[c] * (side[c] + step_.dt * a * rate - step_.to->volume[c] * ahead);
  }
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

template <int D>
void ImplicitFriction<D>::solve(const State<D>& from, const Rates<D>& rates, const Vectors<D>& w, double a,
                                Vectors<D>& side, Vectors<D>& u) {
  added_.clear();
  boundary_flux_.clear();
  for (const auto& term : rate_operator_.terms()) {
    added_rate_.assign(side.size(), Vec<D>::Zero());
    term->add_implicit(from, step_, a, added_rate_, added_);
    scene_.obstacles->clear(added_rate_);
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) side[c] += step_.dt * added_rate_[c];
    const auto flux = term->boundary_flux();
    if (!flux.empty()) boundary_flux_.assign(flux.begin(), flux.end());
  }
  set_carried(from, a);
  solver_.prepare(step_.to, a * scene_.fluid.nu * step_.dt, added_, carried_);
  guess(from, rates, a, side, u);
  damp(from, w, side);
  carry(from, side);
  if (scene_.oblique)
    solve_in_passes(w, a, side, u);
  else
    iterations_ += solver_.solve(w, tolerance(), side, u);
  if (!boundary_flux_.empty()) set_boundary_flux(from, w, u);
}

/// Velocity of a cell extrapolated to t^{n+1}.
template <int D>
Vec<D> ImplicitFriction<D>::cell_ahead(const State<D>& from, Index c) const {
  const double ratio = step_.ratio();
  return ratio > 0 ? Vec<D>((1 + ratio) * from.u[c] - ratio * from.u_old[c]) : from.u[c];
}

/// Extrapolates the difference between the velocity in the cell of a boundary face and that at the face to t^{n+1}.
template <int D>
Vec<D> ImplicitFriction<D>::jump_ahead(const State<D>& from, Index b) const {
  const double ratio = step_.ratio();
  const Vec<D> now = from.u_boundary[b];
  return cell_ahead(from, mesh_.owner[mesh_.n_interior + b]) -
         (ratio > 0 ? Vec<D>((1 + ratio) * now - ratio * from.u_boundary_old[b]) : now);
}

/// Subtracts the part of the boundary fluxes that damp() adds to those of the terms.
template <int D>
void ImplicitFriction<D>::set_boundary_flux(const State<D>& from, const Vectors<D>& w, const Vectors<D>& u) {
  const BoundaryRows& rows = scene_.boundary.rows();
  for (std::size_t b = 0; b < boundary_flux_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
    const double part = added_[f] * step_.to->conductance[f] / step_.dt;
    if (rows.friction[b] > 0) boundary_flux_[b] -= part * (u[p] - w[b] - jump_ahead(from, Index(b)));
  }
  for (const Index b : rows.of_mirror) {
    const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
    const double part = added_[f] * step_.to->conductance[f] / step_.dt;
    const Vec<D> normal = step_.to->area[f].normalized();
    boundary_flux_[b] -= part * (u[p] - cell_ahead(from, p)).dot(normal) * normal;
  }
}

/// Adds theta dt nu_t g times the second time difference of u, whose part at n+1 is in the matrix. With a of
/// modified Crank-Nicolson an extrapolated rate becomes that scheme, and nu_t does not limit the step. In
/// thin cells, a few times the molecular viscosity would require a thousandth of the convective step.
template <int D>
void ImplicitFriction<D>::damp(const State<D>& from, const Vectors<D>& w, Vectors<D>& side) const {
  if (added_.empty()) return;
  const auto ahead = [&](Index c) { return cell_ahead(from, c); };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = added_[f] * step_.to->conductance[f] * (ahead(n) - ahead(p));
    side[p] -= part;
    side[n] += part;
  }
  for (const Index b : scene_.boundary.rows().of_mirror) {
    const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
    const Vec<D> normal = step_.to->area[f].normalized();
    side[p] -= added_[f] * step_.to->conductance[f] * (w[b] - ahead(p)).dot(normal) * normal;
  }
  for (std::size_t b = 0; b < boundary_flux_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (scene_.boundary.rows().friction[b] > 0)
      side[mesh_.owner[f]] += added_[f] * step_.to->conductance[f] * jump_ahead(from, Index(b));
  }
}

/// Volume that each face of a fast cell carries at n+1/2, with the weight of t^{n+1}. Closed cells and faces with
/// given velocities remain explicit.
template <int D>
void ImplicitFriction<D>::set_carried(const State<D>& from, double a) {
  carried_.clear();
  if (step_.fast.empty()) return;
  carried_.assign(mesh_.n_flux_faces(), 0.0);
  const double ahead = from.phi_old.empty() ? 0 : step_.ratio() / 2;
  const auto volume = [&](Index f) {
    const double flux = ahead > 0 ? (1 + ahead) * from.phi[f] - ahead * from.phi_old[f] : from.phi[f];
    return step_.dt * flux - (step_.moving() ? step_.swept[f] : 0);
  };
  const auto now = scene_.obstacles->marks();
  const auto closed = [&](Index c) { return (from.blocked && (*from.blocked)[c]) || (now && (*now)[c]); };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    if (step_.fast[p] + step_.fast[n] > 0 && !closed(p) && !closed(n)) carried_[f] = a * volume(f);
  }
  for (const Index b : scene_.boundary.rows().of_pressure) {
    const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
    if (step_.fast[p] > 0 && !closed(p)) carried_[f] = a * std::max(0.0, volume(f));
  }
}

/// Replaces the extrapolated convection of these faces by -F [a u^{n+1} + b u^n + c u^{n-1}]_f, F of n+1/2 for all three
/// levels: subtracts a F times the second time difference of u as damp() does, and from the Adams-Bashforth sum of
/// products of flux and velocity the product of their changes.
template <int D>
void ImplicitFriction<D>::carry(const State<D>& from, Vectors<D>& side) const {
  const double ratio = step_.ratio();
  const bool changes = ratio > 0 && !from.phi_old.empty();
  for (Index f = 0; f < static_cast<Index>(carried_.size()); ++f) {
    if (carried_[f] == 0) continue;
    const bool inside = f < mesh_.n_interior;
    const Index p = mesh_.owner[f], n = inside ? mesh_.neighbour[f] : p;
    const Vec<D> value = 0.5 * (from.u[p] + from.u[n]);
    Vec<D> part = carried_[f] * value;
    if (ratio > 0) {
      const Vec<D> change = value - 0.5 * (from.u_old[p] + from.u_old[n]);
      part += carried_[f] * ratio * change;
      if (changes)
        part -= step_.dt * (1 + ratio / 2) * (ratio / 2) * (from.phi[f] - from.phi_old[f]) * change;
    }
    side[p] += part;
    if (inside) side[n] -= part;
  }
}

/// The non-orthogonal part is implicit by deferred correction. An explicit one is unstable if its share of
/// the operator exceeds 1/8 (AB2 against 9/16, 3/8, 1/16), as on a mesh sheared by 14 degrees. The passes
/// converge by that share.
template <int D>
void ImplicitFriction<D>::solve_in_passes(const Vectors<D>& w, double a, const Vectors<D>& side,
                                          Vectors<D>& u) {
  const double enough = std::clamp(10 * scene_.parameters.pressure_tolerance, 1e-11, 1e-4);
  for (int pass = 1;; ++pass) {
    scene_.boundary.close(mesh_, *step_.to, u, w, u_boundary_);
    oblique_rate_.assign(u.size(), Vec<D>::Zero());
    rate_operator_.add_oblique(*step_.to, u, u_boundary_, oblique_rate_);
    right_side_ = side;
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) right_side_[c] += step_.dt * a * oblique_rate_[c];
    before_ = u;
    iterations_ += solver_.solve(w, tolerance(), right_side_, u);
    double sums[2] = {0, 0};
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      sums[0] += (u[c] - before_[c]).squaredNorm();
      sums[1] += u[c].squaredNorm();
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    if (sums[0] <= enough * enough * sums[1]) return;
    if (pass == most_passes)
      throw SolveFailure(
          "The non-orthogonal correction of the viscous term did not converge in {} iterations (change {:.2e}). "
          "The mesh is too skewed for an implicit viscous term: use 'viscous: explicit'.",
          most_passes, std::sqrt(sums[0] / sums[1]));
    if (pass >= passes_alone) accelerate(pass == passes_alone, u);
  }
}

/// Computes the guess of the next pass from u and before_ by Anderson acceleration. Collective.
template <int D>
void ImplicitFriction<D>::accelerate(bool start, Vectors<D>& u) {
  const std::size_t owned = static_cast<std::size_t>(mesh_.cells.n_owned()) * D;
  if (!accelerator_)
    accelerator_ = std::make_unique<linalg::VectorAccelerator>(mesh_.comm, owned, pass_acceleration);
  if (start) accelerator_->restart();
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u[c] -= before_[c];
  accelerator_->advance(flat<D>(before_).first(owned), flat<D>(u).first(owned));
  u.swap(before_);
  mesh_.cells.update_ghosts(flat<D>(u), D);
}

template class ImplicitFriction<2>;
template class ImplicitFriction<3>;

}  // namespace couplet::fluid
