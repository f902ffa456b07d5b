// SPDX-License-Identifier: Apache-2.0
// The third part of FractionalStep: level n+1, judged, and put in the place of level n.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/step/fractional_step.hpp"

namespace couplet::fluid {
namespace {

constexpr double explosion = 1e3;  // growth of the largest speed in one step that is called divergence

COUPLET_PROCESSOR_CLONES void velocity_pass(std::span<const double> predicted, double factor,
                                            std::span<const double> gradient, std::span<double> u) {
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = predicted[i] - factor * gradient[i];
}

/// Infinity if one is not finite.
template <int D>
[[gnu::always_inline]] inline double find_largest_square(std::span<const Vec<D>> u) {
  double largest = 0, all = 0;
  for (const Vec<D>& v : u) {
    const double square = v.squaredNorm();
    largest = std::max(largest, square);
    all += square;
  }
  return std::isfinite(all) ? largest : std::numeric_limits<double>::infinity();
}
COUPLET_PROCESSOR_CLONES double largest_square(std::span<const Vec<2>> u) {
  return find_largest_square<2>(u);
}
COUPLET_PROCESSOR_CLONES double largest_square(std::span<const Vec<3>> u) {
  return find_largest_square<3>(u);
}

}  // namespace

/// phi at t^{n+1} in the place of phi^p, which the next project() makes anew, and u beside u^p.
template <int D>
std::shared_ptr<PressureLevel<D>> FractionalStep<D>::correct() {
  const Placement<D>& now = *k_.step.to;
  const std::vector<double>& conductance = k_.pressure_placement().conductance;
  const double factor = k_.step.dt / k_.rho;
  const FluxCorrection correction{factor, conductance.data(), k_.phi_p.data()};
  for (const Index b : k_.boundary.rows().of_pressure) {
    const Index f = k_.mesh.n_interior + b;
    k_.phi_p[f] -= factor * conductance[f] * (k_.p_boundary[b] - k_.p[k_.mesh.owner[f]]);
  }
  auto level = projection_.pressure_level(&correction);
  Vectors<D>& u = k_.right_side;
  velocity_pass(flat<D>(k_.u_p), factor, flat<D>(level->gradient),
                flat<D>(u).first(std::size_t(k_.mesh.cells.n_owned()) * D));
  k_.mesh.cells.update_ghosts(flat<D>(u), D);
  if (k_.bodies) k_.bodies->force(now, k_.step.dt, u);
  if (k_.gap_closed()) k_.gaps->hold(u);
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
  static_cast<History<D>&>(s) = k_.by;
  projection_.commit_waves(s);
  s.phi.swap(k_.phi_p);
  s.u_old.swap(s.u);
  s.u.swap(k_.right_side);
  s.number = ++states_;
  s.pressure = {std::move(level_), s.pressure[0], s.pressure[1]};
  const std::size_t with_gradient = k_.oblique ? 2 : 1;
  if (auto& last = s.pressure[with_gradient]; last && !last->gradient.empty())
    last = std::make_shared<PressureLevel<D>>(
        PressureLevel<D>{last->time, last->p, last->boundary, {}, last->upstream, {}});
  s.u_boundary_old.swap(s.u_boundary);
  s.w = k_.w;
  k_.boundary.close(k_.mesh, *k_.step.to, s.u, s.w, s.u_boundary);
  flux_.remember(s);
  s.rates_old.rate.swap(predictor_.rates().rate);
  s.rates_old.viscous.swap(predictor_.rates().viscous);
  s.shear_old.swap(predictor_.shear());
  s.placement = k_.step.to;
  if (k_.gaps) s.blocked = k_.gaps->marks();
  s.points.swap(k_.step.points);
  s.mesh_flux.swap(k_.step.swept);
  for (double& flux : s.mesh_flux) flux /= k_.step.dt;
  s.dt_old = k_.step.dt;
  s.time += k_.step.dt;
  if (s.start == Start::at_rest || k_.gap_changed) {  // the multi-step schemes begin after the impulse
    s.start = Start::after_impulse;
    s.dt_old = 0;
  }
  set_eddy_viscosity(s);
}

template <int D>
void FractionalStep<D>::set_eddy_viscosity(State<D>& state) {
  if (k_.parameters.turbulence)
    predictor_.rate_operator().set_eddy_viscosity(*k_.parameters.turbulence, state);
}

template <int D>
EnergyStep<D> FractionalStep<D>::energy_step(const State<D>& from) const {
  return {from,     *k_.step.to,   k_.step.dt,    k_.right_side, k_.w,
          k_.phi_p, k_.p_boundary, k_.step.swept, k_.force,      *level_};
}

template <int D>
typename FractionalStep<D>::Judgement FractionalStep<D>::judge(const State<D>& from) const {
  const std::span<const Vec<D>> u(k_.right_side.data(), k_.mesh.cells.n_owned());
  const double fastest = largest_square(u);
  double given = 0;
  for (const Vec<D>& w : k_.w) given = std::max(given, w.squaredNorm());
  double largest[2] = {fastest, given};
  MPI_Allreduce(MPI_IN_PLACE, largest, 2, MPI_DOUBLE, MPI_MAX, k_.mesh.comm);
  Judgement j;
  j.energy = energy_guard_.judge(energy_step(from));
  j.speed = std::sqrt(largest[0]);
  j.given_speed = std::sqrt(largest[1]);
  return j;
}

/// Much faster than all that moved so far and all that is given now, and so that the flow crosses a cell in the step:
/// what begins to move in a fluid that was at rest, but for round-off, is no divergence.
template <int D>
bool FractionalStep<D>::too_fast() const {
  if (!(speed_scale_ > 0) || !(judgement_.speed > explosion * std::max(speed_scale_, judgement_.given_speed)))
    return false;
  bool crosses = false;
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c)
    crosses |= !(std::pow(k_.right_side[c].norm() * k_.step.dt, D) <= k_.step.to->volume[c]);
  return parallel::any(k_.mesh.comm, crosses);
}

/// Where it went wrong: the fastest cell if that is out of bounds, else the one that gained most energy.
template <int D>
void FractionalStep<D>::check(const State<D>& from) {
  const bool finite = std::isfinite(judgement_.speed);
  const bool fast = too_fast();
  const bool created = judgement_.energy.out_of_bounds && !k_.bodies;  // what bodies do is not in the budget
  if (finite && !fast && !created) return;
  struct {
    double value;
    int rank;
  } worst{-std::numeric_limits<double>::infinity(), parallel::comm_rank(k_.mesh.comm)};
  Index where = 0;
  for (Index c = 0; c < k_.mesh.cells.n_owned(); ++c) {
    const double square = k_.right_side[c].squaredNorm();
    double value = std::isfinite(square) ? square : std::numeric_limits<double>::max();
    if (finite && !fast)
      value = k_.step.to->volume[c] * square - from.placement->volume[c] * from.u[c].squaredNorm();
    if (value <= worst.value) continue;
    worst.value = value;
    where = c;
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, k_.mesh.comm);
  std::string cause;
  double data[4] = {};
  if (parallel::comm_rank(k_.mesh.comm) == worst.rank) {
    Vec3 place = Vec3::Zero();
    place.template head<D>() = k_.step.to->centre[where];
    std::copy_n(place.data(), 3, data);
    data[3] = double(k_.mesh.cell_id[where]);
    cause = likely_cause(k_.mesh, k_.boundary, energy_step(from), where, k_.nu, k_.by.implicit,
                         k_.frame ? k_.frame->rate(k_.by.time, k_.step.dt) : 0);
  }
  MPI_Bcast(data, 4, MPI_DOUBLE, worst.rank, k_.mesh.comm);
  parallel::broadcast(k_.mesh.comm, cause, worst.rank);
  if (k_.gap_closed() && k_.sound == 0)  // else what is shut off compresses
    if (const std::string shut = k_.pockets->cause(*k_.step.to); !shut.empty()) cause = shut;
  const EnergyJudgement& e = judgement_.energy;
  const std::string what =
      !finite ? "its velocity is not finite"
      : fast  ? fmt::format("its velocity grew to {:.3g} m/s", judgement_.speed)
              : fmt::format(
                    "its kinetic energy grew by {:.3g} J to {:.3g} J in one step, of which boundaries and "
                     "forces supplied {:.3g} J",
                    e.gain, e.ledger.energy, e.work);
  throw SolveFailure(
      "The flow diverges at t = {:.6g} s: {}, mostly in cell {} at ({:.6g}, {:.6g}, {:.6g}) m. {}",
      k_.by.time + k_.step.dt, what, GlobalIndex(data[3]), data[0], data[1], data[2], cause);
}

template std::shared_ptr<PressureLevel<2>> FractionalStep<2>::correct();
template void FractionalStep<2>::complete(const State<2>&);
template void FractionalStep<2>::commit(State<2>&);
template void FractionalStep<2>::set_eddy_viscosity(State<2>&);
template std::shared_ptr<PressureLevel<3>> FractionalStep<3>::correct();
template void FractionalStep<3>::complete(const State<3>&);
template void FractionalStep<3>::commit(State<3>&);
template void FractionalStep<3>::set_eddy_viscosity(State<3>&);

}  // namespace couplet::fluid
