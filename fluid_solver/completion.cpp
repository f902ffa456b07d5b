// SPDX-License-Identifier: Apache-2.0
// The third part of FractionalStep: level n+1, judged, and put in the place of level n.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/fractional_step.hpp"

namespace couplet::fluid {
namespace {

constexpr double explosion = 1e3;  // growth of the largest speed in one step that is called divergence

}  // namespace

/// phi at t^{n+1} in the place of phi^p, which the next project() makes anew, and u beside u^p.
template <int D>
std::shared_ptr<PressureLevel<D>> FractionalStep<D>::correct() {
  const Placement<D>& now = *step_.to;
  const std::vector<double>& conductance = pressure_placement().conductance;
  const double factor = step_.dt / rho_;
  for (Index f = 0; f < mesh_.n_interior; ++f)
    phi_p_[f] -= factor * conductance[f] * (p_[mesh_.neighbour[f]] - p_[mesh_.owner[f]]);
  for (std::size_t b = 0; b < w_.size(); ++b) {
    const Index f = mesh_.n_interior + static_cast<Index>(b);
    if (boundary_.kind()[b] == FaceKind::pressure)
      phi_p_[f] -= factor * now.conductance[f] * (p_boundary_[b] - p_[mesh_.owner[f]]);
  }
  auto level = pressure_level();
  Vectors<D>& u = right_side_;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) u[c] = u_p_[c] - factor * level->gradient[c];
  mesh_.cells.update_ghosts(flat<D>(u), D);
  if (bodies_) bodies_->force(now, u);
  return level;
}

template <int D>
void FractionalStep<D>::complete(const State<D>& from) {
  if (level_) return;
  level_ = correct();
  judgement_ = judge(from);
  check(from);
}

template <int D>
void FractionalStep<D>::commit(State<D>& s) {
  if (!level_) {
    level_ = correct();
    judgement_ = judge(s);
  }
  speed_scale_ = std::max(speed_scale_, judgement_.speed);
  s.ledger = judgement_.energy.ledger;
  static_cast<History<D>&>(s) = by_;
  s.phi.swap(phi_p_);
  s.u_old.swap(s.u);
  s.u.swap(right_side_);
  s.number = ++states_;
  s.pressure = {std::move(level_), s.pressure[0], s.pressure[1]};
  const std::size_t with_gradient = oblique_ ? 2 : 1;
  if (auto& last = s.pressure[with_gradient]; last && !last->gradient.empty())
    last = std::make_shared<PressureLevel<D>>(PressureLevel<D>{last->time, last->p, last->boundary, {}});
  s.u_boundary_old.swap(s.u_boundary);
  s.w = w_;
  boundary_.close(mesh_, *step_.to, s.u, s.w, s.u_boundary);
  remember_flux(s);
  s.rates_old.rate.swap(rates_.rate);
  s.rates_old.viscous.swap(rates_.viscous);
  s.shear_old.swap(shear_);
  s.placement = step_.to;
  s.points.swap(step_.points);
  s.mesh_flux.swap(step_.swept);
  for (double& flux : s.mesh_flux) flux /= step_.dt;
  s.dt_old = step_.dt;
  s.time += step_.dt;
  if (s.start == Start::at_rest) {  // the multi-step schemes begin after the impulse
    s.start = Start::after_impulse;
    s.dt_old = 0;
  }
  set_eddy_viscosity(s);
}

template <int D>
void FractionalStep<D>::set_eddy_viscosity(State<D>& state) {
  if (parameters_.turbulence) rate_operator_.set_eddy_viscosity(*parameters_.turbulence, state);
}

template <int D>
EnergyStep<D> FractionalStep<D>::energy_step(const State<D>& from) const {
  return {from, *step_.to, step_.dt, right_side_, w_, phi_p_, p_boundary_, step_.swept, force_};
}

template <int D>
typename FractionalStep<D>::Judgement FractionalStep<D>::judge(const State<D>& from) const {
  double fastest = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double square = right_side_[c].squaredNorm();
    if (!(square <= fastest))
      fastest = std::isfinite(square) ? square : std::numeric_limits<double>::infinity();
  }
  Judgement j;
  j.energy = energy_guard_.judge(energy_step(from));
  j.speed = std::sqrt(max(mesh_.comm, fastest));
  return j;
}

/// Where it went wrong: the fastest cell if that is out of bounds, else the one that gained most energy.
template <int D>
void FractionalStep<D>::check(const State<D>& from) {
  const bool finite = std::isfinite(judgement_.speed);
  const bool too_fast = speed_scale_ > 0 && judgement_.speed > explosion * speed_scale_;
  const bool created = judgement_.energy.out_of_bounds && !bodies_;  // what bodies do is not in the budget
  if (finite && !too_fast && !created) return;
  struct {
    double value;
    int rank;
  } worst{-std::numeric_limits<double>::infinity(), comm_rank(mesh_.comm)};
  Index where = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const double square = right_side_[c].squaredNorm();
    double value = std::isfinite(square) ? square : std::numeric_limits<double>::max();
    if (finite && !too_fast)
      value = step_.to->volume[c] * square - from.placement->volume[c] * from.u[c].squaredNorm();
    if (value <= worst.value) continue;
    worst.value = value;
    where = c;
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh_.comm);
  std::string cause;
  double data[4] = {};
  if (comm_rank(mesh_.comm) == worst.rank) {
    Vec3 place = Vec3::Zero();
    place.template head<D>() = step_.to->centre[where];
    std::copy_n(place.data(), 3, data);
    data[3] = double(mesh_.cell_id[where]);
    cause = likely_cause(mesh_, boundary_, energy_step(from), where, nu_, by_.implicit);
  }
  MPI_Bcast(data, 4, MPI_DOUBLE, worst.rank, mesh_.comm);
  broadcast(mesh_.comm, cause, worst.rank);
  const EnergyJudgement& e = judgement_.energy;
  const std::string what =
      !finite    ? "its velocity is not finite"
      : too_fast ? fmt::format("its velocity grew to {:.3g} m/s", judgement_.speed)
                 : fmt::format(
                       "its kinetic energy grew by {:.3g} J to {:.3g} J in a step, of which boundaries "
                       "and forces brought {:.3g} J",
                       e.gain, e.ledger.energy, e.work);
  throw SolveFailure(
      "The flow diverges at t = {:.6g} s: {}, most in cell {} at ({:.6g}, {:.6g}, {:.6g}) m. {}",
      by_.time + step_.dt, what, GlobalIndex(data[3]), data[0], data[1], data[2], cause);
}

template class FractionalStep<2>;
template class FractionalStep<3>;

}  // namespace couplet::fluid
