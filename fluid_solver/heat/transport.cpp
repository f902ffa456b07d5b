// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/heat/heat.hpp"

namespace couplet::fluid {

namespace {

constexpr double conduction_before = 1.0 / 16;  // weight of t^{n-1}, as of implicit friction

}  // namespace

template <int D>
HeatTransport<D>::HeatTransport(const Scene<D>& scene, const FluidStep<D>& step)
    : scene_(scene),
      mesh_(scene.mesh),
      step_(step),
      parameters_(*scene.parameters.heat),
      capacity_(scene.fluid.rho * parameters_.specific_heat),
      diffusivity_(parameters_.conductivity / capacity_),
      boundary_(scene.mesh, scene.parameters),
      solver_(
          "temperature", scene.mesh.comm, std::size_t(scene.mesh.cells.n_owned()),
          [this](std::span<const double> x, std::span<double> y) { apply(x, y); },
          [this](std::span<const double> x, std::span<double> y) {
            for (std::size_t c = 0; c < y.size(); ++c) y[c] = x[c] / rows_->diagonal[c];
          }) {}

template <int D>
typename HeatTransport<D>::Weights HeatTransport<D>::weights() const {
  const double ratio = step_.ratio();
  if (!(ratio > 0)) return {1, 0, 1, 0, 0};
  const double c = conduction_before, a = 0.5 + c / ratio;
  return {1 + ratio / 2, -ratio / 2, a, 1 - a - c, c};
}

/// Volume flux relative to the mesh, per flux face [m^3/s].
template <int D>
std::vector<double> HeatTransport<D>::through(const State<D>& s) const {
  std::vector<double> flux = s.phi;
  for (std::size_t f = 0; f < s.mesh_flux.size(); ++f) flux[f] -= s.mesh_flux[f];
  return flux;
}

template <int D>
void HeatTransport<D>::start(State<D>& s) {
  HeatLevel& h = s.heat;
  const Placement<D>& at = *s.placement;
  h.is_solved = true;
  h.temperature.resize(mesh_.cells.n_local());
  std::vector<Vec3> places(h.temperature.size(), Vec3::Zero());
  for (std::size_t c = 0; c < places.size(); ++c) places[c].template head<D>() = at.centre[c];
  const fv::Expression initial(parameters_.initial_temperature, "heat.initial-temperature");
  initial.evaluate(places, s.time, h.temperature);
  for (double& t : h.temperature) t -= parameters_.reference_temperature;
  mesh_.cells.update_ghosts(h.temperature);
  boundary_.set(s.time, at, through(s), exchange_);
  gradient_.clear();
  set_known(at);
  close(at, h.temperature, h.boundary);
  for (int pass = 0; scene_.oblique && pass < 2; ++pass) {
    set_gradient(at, h.temperature, h.boundary);
    set_known(at);
    close(at, h.temperature, h.boundary);
  }
  conduct(at, h.temperature, h);
  h.received = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) h.received += at.volume[c] * h.temperature[c];
}

/// (1) V' T^{n+1} = V T^n - dt [e0 sum phi^n T^n + e1 sum phi^{n-1} T^{n-1}] + sum dV_f [e0 T^n + e1 T^{n-1}]
///                 + dt [a K^{n+1} + b K^n + c K^{n-1}],   K = sum of the conducted fluxes
template <int D>
void HeatTransport<D>::advance(const State<D>& from) {
  const HeatLevel& level = from.heat;
  const Placement<D>&old = *from.placement, &now = *step_.to;
  const Weights w = weights();
  const std::vector<double> relative = through(from);
  next_.is_solved = true;
  next_.boundary_old = level.boundary;
  boundary_.set_outlets(step_.begin(), old, relative, level.temperature, next_.boundary_old);
  side_.resize(level.temperature.size());
  for (std::size_t c = 0; c < side_.size(); ++c) side_[c] = old.volume[c] * level.temperature[c];
  next_.received = level.received;
  set_carried(from, w);
  parameters_.convection == HeatParameters::Convection::bounded ? carry_bounded(from, w) : carry(from, w);
  for (std::size_t c = 0; c < side_.size(); ++c) side_[c] += step_.dt * w.b * level.conduction[c];
  conducted_.assign(level.flow.size(), 0.0);
  add_flow(w.b, level.flow);
  if (w.c != 0) {
    for (std::size_t c = 0; c < side_.size(); ++c) side_[c] += step_.dt * w.c * level.conduction_old[c];
    add_flow(w.c, level.flow_old);
  }
  boundary_.set(step_.end(), now, relative, exchange_);
  add_film();
  solve(level, w);
  add_flow(w.a, next_.flow);
  if (!parameters_.is_buoyant()) return;
  middle_ = level.temperature;
  for (std::size_t c = 0; c < middle_.size(); ++c) middle_[c] = 0.5 * (middle_[c] + next_.temperature[c]);
  boundary_middle_ = level.boundary;
  for (std::size_t b = 0; b < boundary_middle_.size(); ++b)
    boundary_middle_[b] = 0.5 * (boundary_middle_[b] + next_.boundary[b]);
}

template <int D>
void HeatTransport<D>::begin(const State<D>& from, double duration) {
  film_.begin = from.time;
  film_.duration = duration;
  film_.boundary = from.heat.boundary;
  film_.flow = from.heat.flow;
  done_.assign(from.heat.flow.size(), 0.0);
}

template <int D>
void HeatTransport<D>::set_film(std::vector<double> coefficient, std::vector<double> ambient) {
  film_.coefficient = std::move(coefficient);
  film_.ambient = std::move(ambient);
}

/// Adds the films of the conjugate faces at the end of the sub-step. The temperature beyond the same film at the begin of the
/// coupling step follows from the flow there.
template <int D>
void HeatTransport<D>::add_film() {
  const double share = (step_.end() - film_.begin) / film_.duration;
  for (std::size_t b = 0; b < film_.coefficient.size(); ++b) {
    const double h = film_.coefficient[b];
    if (!(h > 0)) continue;
    const double area = step_.to->area[mesh_.n_interior + Index(b)].norm();
    const double before = film_.boundary[b] + film_.flow[b] * capacity_ / (h * area);
    exchange_.coefficient[b] = h;
    exchange_.ambient[b] = before + share * (film_.ambient[b] - parameters_.reference_temperature - before);
  }
}

/// Adds the heat that this flow conducts into the fluid in a share of the sub-step.
template <int D>
void HeatTransport<D>::add_flow(double share, std::span<const double> flow) {
  for (std::size_t b = 0; b < flow.size(); ++b) {
    const double heat = step_.dt * share * flow[b];
    conducted_[b] += heat;
    next_.received += heat;
  }
}

template <int D>
std::vector<double> HeatTransport<D>::mean_heat() const {
  std::vector<double> heat(done_.size());
  for (std::size_t b = 0; b < heat.size(); ++b)
    heat[b] = -capacity_ / film_.duration * (done_[b] + conducted_[b]);
  return heat;
}

/// phi at t^{n+1} follows from two levels, each of which fills no cell.
template <int D>
void HeatTransport<D>::set_carried(const State<D>& from, const Weights& w) {
  carried_.clear();
  const bool frozen = freezes_flow(step_.begin());
  if (!frozen && !scene_.parameters.courant) return;
  const double ahead = frozen || from.phi_old.empty() ? 0 : step_.ratio();
  carried_.resize(from.phi.size());
  for (std::size_t f = 0; f < carried_.size(); ++f)
    carried_[f] =
        step_.dt * w.a * (ahead > 0 ? (1 + ahead) * from.phi[f] - ahead * from.phi_old[f] : from.phi[f]);
}

/// Carries the temperature at t^{n+1}.
template <int D>
void HeatTransport<D>::carry_implicitly() {
  const std::vector<double>& t = next_.temperature;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double out = 0.5 * carried_[f] * (t[p] + t[n]);
    side_[p] -= out;
    side_[n] += out;
  }
  for (std::size_t b = 0; b < known_.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b), p = mesh_.owner[f];
    const double out = carried_[f] * (std::isinf(exchange_.coefficient[b]) ? exchange_.ambient[b] : t[p]);
    side_[p] -= out;
    next_.received -= out;
  }
}

/// Convection with mean values at faces, extrapolated as a product, and the volumes that the faces sweep.
template <int D>
void HeatTransport<D>::carry(const State<D>& from, const Weights& w) {
  const HeatLevel& level = from.heat;
  const double now = carried_.empty() ? w.e0 : w.b, before = carried_.empty() ? w.e1 : w.c;
  const std::vector<double>& t = level.temperature;
  const double dt = step_.dt;
  std::vector<double>& rate = next_.convection_old;
  rate.assign(side_.size(), 0.0);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double out = 0.5 * from.phi[f] * (t[p] + t[n]);
    rate[p] -= out;
    rate[n] += out;
  }
  for (std::size_t c = 0; c < side_.size(); ++c) side_[c] += dt * now * rate[c];
  if (before != 0)
    for (std::size_t c = 0; c < side_.size(); ++c) side_[c] += dt * before * level.convection_old[c];
  if (step_.moving())
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      double value = 0.5 * w.e0 * (t[p] + t[n]);
      if (w.e1 != 0) value += 0.5 * w.e1 * (level.temperature_old[p] + level.temperature_old[n]);
      side_[p] += step_.swept[f] * value;
      side_[n] -= step_.swept[f] * value;
    }
  next_.carried_old.resize(level.boundary.size());
  for (std::size_t b = 0; b < level.boundary.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const double value = next_.boundary_old[b];
    next_.carried_old[b] = from.phi[f] * value;
    double out = dt * now * next_.carried_old[b];
    if (before != 0) out += dt * before * level.carried_old[b];
    if (step_.moving())
      out -= step_.swept[f] * (w.e0 * value + (w.e1 != 0 ? w.e1 * level.boundary_old[b] : 0.0));
    side_[mesh_.owner[f]] -= out;
    next_.received -= out;
  }
}

/// Carries the temperature upstream of each face with the volume F that passes it in the step, which makes no new extremes, and adds
/// as much of the excess of carry() as the neighbors allow [zalesak1979]. F = dt [e0 phi^n + e1 phi^{n-1}] - dV_f.
template <int D>
void HeatTransport<D>::carry_bounded(const State<D>& from, const Weights& w) {
  const HeatLevel& level = from.heat;
  const std::vector<double>& t = level.temperature;
  const bool moving = step_.moving(), has_old = w.e1 != 0;
  const double now = step_.dt * w.e0, before = step_.dt * w.e1;
  next_.faces_old.resize(from.phi.size());
  next_.flux_old = from.phi;
  const auto volume = [&](Index f) {
    return now * from.phi[f] + (has_old ? before * level.flux_old[f] : 0) - (moving ? step_.swept[f] : 0);
  };
  std::vector<double> excess(std::size_t(mesh_.n_interior));
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double value = 0.5 * (t[p] + t[n]), whole = volume(f),
                 low = whole > 0 ? whole * t[p] : whole * t[n];
    next_.faces_old[f] = from.phi[f] * value;
    double high = now * next_.faces_old[f];
    double swept = w.e0 * value;
    if (has_old) {
      high += before * level.faces_old[f];
      swept += 0.5 * w.e1 * (level.temperature_old[p] + level.temperature_old[n]);
    }
    if (moving) high -= step_.swept[f] * swept;
    excess[f] = high - low;
    side_[p] -= low;
    side_[n] += low;
  }
  next_.carried_old.resize(level.boundary.size());
  for (std::size_t b = 0; b < level.boundary.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b), p = mesh_.owner[f];
    const double whole = volume(f), low = whole * (whole > 0 ? t[p] : next_.boundary_old[b]);
    next_.carried_old[b] = from.phi[f] * next_.boundary_old[b];
    side_[p] -= low;
    next_.received -= low;
  }
  add_limited(from, excess);
}

/// `excess`: per interior face, out of the owner [K m^3].
template <int D>
void HeatTransport<D>::add_limited(const State<D>& from, std::span<const double> excess) {
  const std::vector<double>&t = from.heat.temperature, &volume = step_.to->volume;
  std::vector<double> low(side_.size());
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) low[c] = side_[c] / volume[c];
  mesh_.cells.update_ghosts(low);
  Vectors<2> range(low.size()), room(low.size(), Vec<2>::Zero());  // least and largest; of inflow, of outflow
  for (std::size_t c = 0; c < low.size(); ++c) range[c] = {std::min(t[c], low[c]), std::max(t[c], low[c])};
  const Vectors<2> own = range;
  const auto widen = [&](Index c, double least, double most) {
    range[c] = {std::min(range[c][0], least), std::max(range[c][1], most)};
  };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    widen(p, own[n][0], own[n][1]);
    widen(n, own[p][0], own[p][1]);
    room[excess[f] > 0 ? n : p][0] += std::abs(excess[f]);
    room[excess[f] > 0 ? p : n][1] += std::abs(excess[f]);
  }
  for (std::size_t b = 0; b < next_.boundary_old.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    const double swept = step_.moving() ? step_.swept[f] : 0, value = next_.boundary_old[b];
    if (step_.dt * from.phi[f] < swept) widen(mesh_.owner[f], value, value);  // fluid enters
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    const Vec<2> left = volume[c] * Vec<2>(range[c][1] - low[c], low[c] - range[c][0]);
    for (int k = 0; k < 2; ++k) room[c][k] = room[c][k] > left[k] ? std::max(0.0, left[k]) / room[c][k] : 1;
  }
  mesh_.cells.update_ghosts(flat<2>(room), 2);
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double part =
        excess[f] * (excess[f] > 0 ? std::min(room[n][0], room[p][1]) : std::min(room[p][0], room[n][1]));
    side_[p] -= part;
    side_[n] += part;
  }
}

template <int D>
void HeatTransport<D>::commit(State<D>& s) {
  HeatLevel& h = s.heat;
  for (std::size_t b = 0; b < done_.size(); ++b) done_[b] += conducted_[b];
  next_.temperature_old.swap(h.temperature);
  next_.flow_old.swap(h.flow);
  next_.conduction_old.swap(h.conduction);
  std::swap(h, next_);
}

template <int D>
double HeatTransport<D>::buoyancy_rate(const State<D>& s) const {
  if (!parameters_.is_buoyant()) return 0;
  const Placement<D>& at = *s.placement;
  const HeatLevel& h = s.heat;
  const bool rests = !(s.largest_speed > 0);
  Vec<D> gravity;
  for (int c = 0; c < D; ++c) gravity[c] = parameters_.gravity[std::size_t(c)];
  double most = 0;
  const auto add = [&](Index f, double change) {
    const Vec<D> d = (at.area[f] - at.oblique_of(f)) / at.conductance[f];  // S = k + g d
    const double square = -parameters_.expansion * change * gravity.dot(d) / d.squaredNorm();
    most = std::max(most, rests ? std::abs(square) : square);
  };
  for (Index f = 0; f < mesh_.n_interior; ++f)
    add(f, h.temperature[mesh_.neighbour[f]] - h.temperature[mesh_.owner[f]]);
  for (std::size_t b = 0; rests && b < h.boundary.size(); ++b) {
    const Index f = mesh_.n_interior + Index(b);
    add(f, h.boundary[b] - h.temperature[mesh_.owner[f]]);
  }
  return std::sqrt(parallel::max(mesh_.comm, most));
}

template class HeatTransport<2>;
template class HeatTransport<3>;

}  // namespace couplet::fluid
