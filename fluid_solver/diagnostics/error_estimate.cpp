// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/error_estimate.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/differences.hpp"
#include "fluid_solver/pressure/wave_rule.hpp"

namespace couplet::fluid {
namespace {

constexpr double adams_bashforth_error = 5. / 12;
// Of what a clock drives: forces at mid-step 1/24, friction by the trapezoidal rule 1/12; hardly any convection, 5/12. Of a flow that
// friction holds at rate r, u' = f - r u, r u'' dt^3/8 beside it, less by 1 + r dt/2, which that rule divides by; by Adams and
// Bashforth's 5/12 + 1/24.
constexpr double driven_error = 1. / 12, held_error = 1. / 8, held_explicitly = 11. / 24;
constexpr double hardly = 0.1;   // share of convection in the rate of change of a flow that answers linearly
constexpr double window = 0.25;  // "of late" is about this part of the time that has gone by

/// Sums of a linear fit through the neighbours of a cell, weighted by 1 / d^2.
template <int D>
struct Fit {
  Eigen::Matrix<double, D + 1, D + 1> moments = Eigen::Matrix<double, D + 1, D + 1>::Zero();
  Eigen::Matrix<double, D + 1, D> values = Eigen::Matrix<double, D + 1, D>::Zero();
  void add(const Vec<D>& d, const Vec<D>& value) {
    Eigen::Matrix<double, D + 1, 1> row;
    const double length = d.norm();
    row << 1, d / length;
    moments += row * row.transpose() / (length * length);
    values += row * value.transpose() / (length * length);
  }
  /// In the cell itself.
  Vec<D> value() const { return moments.completeOrthogonalDecomposition().solve(values).row(0).transpose(); }
};

}  // namespace

/// Root mean square over the volume; per local cell.
template <int D>
double FluidErrorEstimate<D>::size(const Vectors<D>& values) const {
  const std::vector<double>& volume = fluid_.state().placement->volume;
  double squares = 0, whole = 0;
  for (Index c = 0; c < fluid_.mesh().cells.n_owned(); ++c) {
    squares += volume[c] * values[c].squaredNorm();
    whole += volume[c];
  }
  squares = parallel::sum(fluid_.mesh().comm, squares), whole = parallel::sum(fluid_.mesh().comm, whole);
  return whole > 0 ? std::sqrt(squares / whole) : 0;
}

template <int D>
void FluidErrorEstimate<D>::see_energy(double dt) {
  const EnergyLedger& ledger = fluid_.state().ledger;
  time_ += dt;
  const double share = std::min(1., dt / (window * time_));
  power_ += share * ((ledger.work - work_) / dt - power_);
  const double held = std::max(0., ledger.energy);
  gain_ += share * ((held - held_) / dt - gain_);
  energy_ += share * (held - energy_);
  work_ = ledger.work, held_ = held;
}

/// Rate at which it takes what work brings in [1/s]. The flow's own decay is not in it: it takes the errors along with the solution.
template <int D>
double FluidErrorEstimate<D>::friction() const {
  // What a flow gains takes no error away; of one that decays the work alone is more than the solution's own way.
  const double taken = std::max(0., std::min(power_, power_ - gain_));
  return energy_ > 0 ? taken / (2 * energy_) : 0;
}

template <int D>
auto FluidErrorEstimate<D>::weights(double dt, double apart) const -> Weights {
  const double sub_step = dt / std::max(1, fluid_.statistics().sub_steps), held = friction();
  const bool implicit = fluid_.state().implicit;
  const double less = implicit ? 1 / (1 + 0.5 * held * sub_step) : 1;
  return {.local = adams_bashforth_error * dt * sub_step * sub_step / apart,
          .of_third = less * driven_error * dt * sub_step * sub_step / apart,
          .of_second = less * (implicit ? held_error : held_explicitly) * held * dt * sub_step * sub_step};
}

/// One loop over the cells. `squares`: of u, its rate, the change of that, the change of that; the volume; of what is left, outflow; of
/// what is carried.
template <int D>
void FluidErrorEstimate<D>::sum_differences(double per_step, double per_apart, const Weights& weights,
                                            std::array<double, 8>& squares) {
  const Vectors<D>& u = fluid_.state().u;
  const std::vector<double>& volume = fluid_.state().placement->volume;
  const std::size_t n = u_.size();
  if (seen_ > 0 && !driving_.is_possible()) {
    const std::array<double, 5> sums =
        renew(Differences<D>{std::span(volume).first(n), u.data(), u_.data(), rate_.data(),
                             rate_change_.data(), per_step, seen_ > 1 ? per_apart : 0});
    std::ranges::copy(sums, squares.begin());
    return;
  }
  const Vectors<D>& carried = fluid_.state().rates_old.rate;  // times the volume; none of other schemes
  for (std::size_t c = 0; c < n && seen_ > 0; ++c) {
    const Vec<D> rate = (u[c] - u_[c]) * per_step;
    const Vec<D> change = seen_ > 1 ? Vec<D>((rate - rate_[c]) * per_apart) : Vec<D>(Vec<D>::Zero());
    const Vec<D> third = change - rate_change_[c];
    if (seen_ > 2) {
      left_[c] += weights.of_third * third + weights.of_second * change;
      squares[5] += volume[c] * left_[c].squaredNorm();
      squares[7] += carried.empty() ? volume[c] * rate.squaredNorm() : carried[c].squaredNorm() / volume[c];
    }
    squares[0] += volume[c] * u[c].squaredNorm();
    squares[1] += volume[c] * rate.squaredNorm();
    squares[2] += volume[c] * change.squaredNorm();
    squares[3] += volume[c] * third.squaredNorm();
    squares[4] += volume[c];
    rate_[c] = rate, rate_change_[c] = change;
  }
  std::copy_n(u.begin(), n, u_.begin());
}

// Divided differences of u at the ends of the last four steps, their lengths nearly alike: the rate over each step,
// the change of the rate, the change of that. One loop and one sum over the ranks: a cheap step costs little more.
template <int D>
void FluidErrorEstimate<D>::accepted(double dt) {
  const auto n = std::size_t(fluid_.mesh().cells.n_owned());
  const double apart = 0.5 * (dt + dt_old_);
  const bool knows_third = seen_ > 2;
  for (Vectors<D>* v : {&u_, &rate_, &rate_change_}) v->resize(n, Vec<D>::Zero());
  if (driving_.is_possible()) left_.resize(n, Vec<D>::Zero());
  std::array<double, 8> squares{};
  const Weights weights = this->weights(dt, apart);
  sum_differences(1 / dt, 1 / apart, weights, squares);
  if (knows_third) {
    for (Index f = fluid_.mesh().n_interior; f < fluid_.mesh().n_flux_faces(); ++f)
      squares[6] += std::max(0., fluid_.state().phi[f]);
    MPI_Allreduce(MPI_IN_PLACE, squares.data(), int(squares.size()), MPI_DOUBLE, MPI_SUM, fluid_.mesh().comm);
    const auto mean = [&](int k) { return squares[4] > 0 ? std::sqrt(squares[k] / squares[4]) : 0; };
    const double highest = mean(3) / apart;
    see_energy(dt);
    const double sub_step = dt / std::max(1, fluid_.statistics().sub_steps);
    drift_.add(dt, held_, mean(1), mean(2), adams_bashforth_error * sub_step * sub_step);
    // Errors leave the flow with the outflow of all its volume, and by friction.
    const double forgotten = friction() + (squares[4] > 0 ? squares[6] / squares[4] : 0);
    for (Vec<D>& v : left_) v *= std::exp(-forgotten * dt);
    const double faded = std::exp(-dt / (window * time_));
    left_of_late_ = std::max(mean(5), left_of_late_ * faded);
    carried_ = std::max(mean(7), carried_ * faded), changed_ = std::max(mean(1), changed_ * faded);
    steps_.add({.error = weights.local * mean(3),
                .rate = mean(1),
                .size = mean(0),
                .dt = dt,
                .order = 2,
                .below = mean(2),
                .highest = highest,
                .forgotten = forgotten},
               judged_ ? 1 : 3);
    judged_ = true;
  }
  dt_old_ = dt;
  ++seen_;
}

template <int D>
double FluidErrorEstimate<D>::recovered_difference() const {
  const State<D>& s = fluid_.state();
  const mesh::Mesh& mesh = fluid_.mesh();
  const Placement<D>& at = *s.placement;
  std::vector<Fit<D>> fits(mesh.cells.n_local());
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Vec<D> d = (at.area[f] - at.oblique_of(f)) / at.conductance[f];  // S = k + g d
    const Index owner = mesh.owner[f];
    if (f >= mesh.n_interior) {
      fits[owner].add(d, s.u_boundary[f - mesh.n_interior]);
      continue;
    }
    const Index neighbour = mesh.neighbour[f];
    fits[owner].add(d, s.u[neighbour]);
    fits[neighbour].add(-d, s.u[owner]);
  }
  Vectors<D> gap(mesh.cells.n_local(), Vec<D>::Zero());
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    if (!s.blocked || !(*s.blocked)[c]) gap[c] = fits[c].value() - s.u[c];
  return size(gap);
}

/// What a compressible fluid takes up is no outflow.
template <int D>
void FluidErrorEstimate<D>::add_compression(std::vector<double>& net) const {
  const State<D>& s = fluid_.state();
  if (!s.pressure[1]) return;
  std::vector<double> times{s.pressure[1]->time};
  if (s.pressure[2]) times.push_back(s.pressure[2]->time);
  const WaveRule rule = three_level_rule(s.pressure[0]->time, s.time, times);
  const double sound = fluid_.parameters().sound_speed(), bulk = fluid_.parameters().density * sound * sound;
  for (Index c = 0; c < fluid_.mesh().cells.n_owned(); ++c) {
    double rate = rule.rate * s.pressure[0]->p[c];
    for (std::size_t k = 0; k < times.size(); ++k) rate += rule.past[k] * s.pressure[k + 1]->p[c];
    net[c] += s.placement->volume[c] * rate / bulk;
  }
}

template <int D>
double FluidErrorEstimate<D>::net_outflow() const {
  const State<D>& s = fluid_.state();
  const mesh::Mesh& mesh = fluid_.mesh();
  std::vector<double> net(mesh.cells.n_local()), through(mesh.cells.n_local());
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    net[mesh.owner[f]] += s.phi[f], through[mesh.owner[f]] += 0.5 * std::abs(s.phi[f]);
    if (f >= mesh.n_interior) continue;
    net[mesh.neighbour[f]] -= s.phi[f], through[mesh.neighbour[f]] += 0.5 * std::abs(s.phi[f]);
  }
  if (fluid_.parameters().is_compressible()) add_compression(net);
  double left = 0, all = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) left += net[c] * net[c], all += through[c] * through[c];
  left = parallel::sum(mesh.comm, left), all = parallel::sum(mesh.comm, all);
  return all > 0 ? std::sqrt(left / all) : 0;
}

template <int D>
double FluidErrorEstimate<D>::step_part() const {
  const double sum = steps_.over_size();
  if (!(steps_.size() > 0)) return sum;
  std::vector<Vec3> places;
  for (const Vec3& x : fluid_.state().placement->boundary_centre) places.push_back(x);
  const bool acts =
      driving_.is_possible() && driving_.acts(fluid_.mesh().comm, places, fluid_.state().time, dt_old_);
  if (acts) return carried_ <= hardly * changed_ ? std::min(sum, left_of_late_ / steps_.size()) : sum;
  return driving_.moves() ? sum : std::max(sum, drift_.error() / steps_.size());
}

template <int D>
diagnostics::ErrorParts FluidErrorEstimate<D>::parts() const {
  diagnostics::ErrorParts parts;
  parts.dimension = D;
  const double speed = size(fluid_.state().u);
  if (!(speed > 0) || seen_ == 0) return parts;
  parts.mesh = recovered_difference() / speed;
  parts.step = step_part();
  const double across = std::pow(double(fluid_.mesh().cells.n_global()), 1. / D);
  const auto& known =
      fluid_.parameters().compressibility;  // the trapezoidal rule knows the divergence before, too
  const bool open = known && known->scheme == WaveScheme::trapezoidal;
  parts.linear = (open ? fluid_.parameters().pressure_tolerance : net_outflow()) * std::sqrt(across);
  return parts;
}

template <int D>
void FluidErrorEstimate<D>::visit(io::Archive& archive) {
  archive.common("numbers", seen_, judged_, dt_old_, time_, power_, gain_, energy_, work_, held_,
                 left_of_late_, carried_, changed_, steps_, drift_);
  for (const auto& [name, vectors] :
       {std::pair{"left", &left_}, {"rate", &rate_}, {"rate-change", &rate_change_}}) {
    const std::span<const double> numbers = flat<D>(*vectors);
    std::vector<double> values(numbers.begin(), numbers.end());
    archive.field(mesh::Entries::owned_cells, name, values, D);
    if (!archive.reads()) continue;
    vectors->clear();
    for (std::size_t i = 0; i < values.size(); i += D) vectors->emplace_back(values.data() + i);
  }
  if (!archive.reads() || seen_ == 0) return;
  const Vectors<D>& u = fluid_.state().u;
  u_.assign(u.begin(), u.begin() + fluid_.mesh().cells.n_owned());
}

template <int D>
std::shared_ptr<diagnostics::Diagnostic> flow_error(const FluidView<D>& view) {
  return std::make_shared<FluidErrorEstimate<D>>(view);
}

template class FluidErrorEstimate<2>;
template class FluidErrorEstimate<3>;
template std::shared_ptr<diagnostics::Diagnostic> flow_error(const FluidView<2>&);
template std::shared_ptr<diagnostics::Diagnostic> flow_error(const FluidView<3>&);

}  // namespace couplet::fluid
