// SPDX-License-Identifier: Apache-2.0
#include <mpi.h>
#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "common/base/processor_clones.hpp"
#include "common/diagnostics/error_parts.hpp"
#include "common/diagnostics/reference.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/step_errors.hpp"
#include "fluid_solver/diagnostics/driving.hpp"
#include "fluid_solver/diagnostics/view.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

namespace {

// Errors of a step over dt^3: of the explicit rates R by Adams-Bashforth 5/12 R'', of implicit friction F by the trapezoidal rule
// -(1/12 + 1/16) F'', of forces f at mid-step 1/24 f'' with f = u' - R - F. Walls that move are met at the end of a step, so the part of u'
// that follows them has no error.
constexpr double adams_bashforth_error = 5. / 12, trapezoidal_error = 1. / 12, mid_step_error = 1. / 24;
constexpr double friction_error = trapezoidal_error + 1. / 16;  // its rule has weights of 9/16, 3/8 and 1/16
constexpr double three_level_error = 1. / 3;
constexpr double hardly = 0.1;  // share of convection in the rate of change of a flow that answers linearly
constexpr double quasi_steady = 0.2;  // phase of sound across the mesh [rad] below which there are no waves
constexpr double window = 0.25;       // recent values cover about this part of the elapsed time
constexpr double most_swings = 2;     // of a flow of its own, from which errors of its phase exceed others

/// Sums of a linear fit of vectors of `Width` numbers through the neighbors of a cell, weighted by 1/d^2.
template <int D, int Width>
struct LinearFit {
  Eigen::Matrix<double, D + 1, D + 1> moments = Eigen::Matrix<double, D + 1, D + 1>::Zero();
  Eigen::Matrix<double, D + 1, Width> values = Eigen::Matrix<double, D + 1, Width>::Zero();
  void add(const Vec<D>& d, const Vec<Width>& value) {
    Eigen::Matrix<double, D + 1, 1> row;
    row << 1, d;
    moments += row * row.transpose() / d.squaredNorm();
    values += row * value.transpose() / d.squaredNorm();
  }
  /// Value of the fit in the cell itself.
  Vec<Width> value() const {
    return moments.completeOrthogonalDecomposition().solve(values).row(0).transpose();
  }
};

/// Divided differences of u in time: rate and its change become those of this step, u is kept, `left` gets the local errors.
template <int D>
struct Differences {
  std::span<const double> volume;
  const Vec<D>* now;
  Vec<D>*u, *rate, *change;
  double per_step, per_apart;  ///< 0 if there is none yet
  Vec<D>* left;                ///< nullptr if nothing drives the flow, or there is no third difference yet
  const Vec<D>*
      carried;  ///< explicit rates at the start of the step, times the volume; nullptr for other schemes
  const Vec<D>* friction;   ///< implicit friction there, times the volume; nullptr if it is explicit
  Vec<D>*splitting, *turn;  ///< rates by their weights in the local error, and their last change
  double of_carried, of_friction, of_third;  ///< these weights
  double step;                               ///< factor of the second difference of the rates
};
/// Sums over the volume of the squares of u, its rate, the change of that and the change of that, the volume, and the squares of
/// what is left, of the local error and of what is carried.
template <int D>
COUPLET_PROCESSOR_CLONES std::array<double, 8> renew(const Differences<D>& d) {
  std::array<double, 8> sums{};
  for (std::size_t c = 0; c < d.volume.size(); ++c) {
    const double volume = d.volume[c];
    const Vec<D> rate = (d.now[c] - d.u[c]) * d.per_step, change = (rate - d.rate[c]) * d.per_apart;
    const Vec<D> third = change - d.change[c];
    Vec<D> by_weight = d.of_third * rate;
    if (d.carried) by_weight += d.of_carried / volume * d.carried[c];
    if (d.friction) by_weight += d.of_friction / volume * d.friction[c];
    const Vec<D> turn = by_weight - d.splitting[c], error = d.step * (turn - d.turn[c]);
    d.splitting[c] = by_weight, d.turn[c] = turn;
    sums[6] += volume * error.squaredNorm();
    if (d.left) {
      d.left[c] += error;
      sums[5] += volume * d.left[c].squaredNorm();
      sums[7] += d.carried ? d.carried[c].squaredNorm() / volume : volume * rate.squaredNorm();
    }
    sums[0] += volume * d.now[c].squaredNorm();
    sums[1] += volume * rate.squaredNorm();
    sums[2] += volume * change.squaredNorm();
    sums[3] += volume * third.squaredNorm();
    sums[4] += volume;
    d.u[c] = d.now[c], d.rate[c] = rate, d.change[c] = change;
  }
  return sums;
}

/// Shares of the error in the velocity over its size, as norms over the volume. Collective.
///   mesh    difference of u from a linear fit through the neighbors of each cell, h^2/4 times the Laplacian
///           of u on equal cells (recovery of the values)
///   step    sum of the local errors of the rates that the scheme extrapolates, see StepErrors; k^-3 each with k
///           sub-steps. In a driven flow (Driving) with a linear response, errors cancel within half a period, so the vector
///           sum is used if smaller. Unknown after some swings of a flow that nothing drives, whose phase drifts.
///   linear  residual of the pressure equation: net outflow of the cells over their flux, times the square
///           root of the number of cells across. An alternating outflow moves only neighbors, a uniform one
///           the whole field; this is the geometric mean.
template <int D>
class FluidErrorEstimate final : public diagnostics::Diagnostic {
 public:
  explicit FluidErrorEstimate(const FluidView<D>& view) : view_(view), driving_(view.parameters()) {}
  void observe(diagnostics::Report&) override { accepted(view_.step.dt); }
  void conclude(diagnostics::Report& report) override {
    report.errors = parts();
    if (view_.parameters().heat) show_temperature();
  }
  void visit(io::Archive& archive) override {
    archive.common("numbers", seen_, dt_old_, time_, left_of_late_, carried_, changed_, largest_, steps_);
    for (const auto& [name, vectors] : {std::pair{"left", &left_},
                                        {"rate", &rate_},
                                        {"rate-change", &rate_change_},
                                        {"splitting", &splitting_},
                                        {"splitting-change", &turn_}}) {
      const std::span<const double> numbers = flat<D>(*vectors);
      std::vector<double> values(numbers.begin(), numbers.end());
      archive.field(mesh::Entries::owned_cells, name, values, D);
      if (!archive.reads()) continue;
      vectors->clear();
      for (std::size_t i = 0; i < values.size(); i += D) vectors->emplace_back(values.data() + i);
    }
    if (!archive.reads() || seen_ == 0) return;
    const Vectors<D>& u = view_.fluid.state().u;
    u_.assign(u.begin(), u.begin() + view_.mesh.cells.n_owned());
  }

 private:
  // Divided differences of u at the ends of the last four steps, which have nearly equal lengths: rate, and
  // its first and second changes. Uses one loop and one reduction, so that a cheap step costs little more.
  void accepted(double dt) {
    const auto n = std::size_t(view_.mesh.cells.n_owned());
    const double apart = 0.5 * (dt + dt_old_);
    const bool knows_third = seen_ > 2;
    for (Vectors<D>* v : {&u_, &rate_, &rate_change_, &splitting_, &turn_}) v->resize(n, Vec<D>::Zero());
    if (driving_.is_possible()) left_.resize(n, Vec<D>::Zero());
    const State<D>& state = view_.fluid.state();
    const double sub_step = dt / std::max(1, view_.fluid.statistics().sub_steps),
                 step = dt * sub_step * sub_step;
    const Rates<D>& rates = state.rates_old;
    const double forced = driving_.is_possible() ? mid_step_error : 0;
    std::array<double, 8> squares = renew(
        Differences<D>{std::span(state.placement->volume).first(n), state.u.data(), u_.data(), rate_.data(),
                       rate_change_.data(), seen_ > 0 ? 1 / dt : 0, seen_ > 1 ? 1 / apart : 0,
                       knows_third && !left_.empty() ? left_.data() : nullptr,
                       rates.rate.empty() ? nullptr : rates.rate.data(),
                       rates.viscous.empty() ? nullptr : rates.viscous.data(), splitting_.data(),
                       turn_.data(), adams_bashforth_error - forced, -friction_error - forced,
                       rates.rate.empty() ? adams_bashforth_error : std::max(forced, error_of_waves()),
                       step / (apart * apart)});
    if (knows_third) {
      MPI_Allreduce(MPI_IN_PLACE, squares.data(), int(squares.size()), MPI_DOUBLE, MPI_SUM, view_.mesh.comm);
      const auto mean = [&](int k) { return squares[4] > 0 ? std::sqrt(squares[k] / squares[4]) : 0; };
      const double highest = mean(3) / apart;
      if (dt < (1 - 1e-9) * dt_old_) largest_.forget();
      largest_.add(mean(0), dt);
      time_ += dt;
      const double faded = std::exp(-dt / (window * time_));
      left_of_late_ = std::max(mean(5), left_of_late_ * faded);
      carried_ = std::max(mean(7), carried_ * faded), changed_ = std::max(mean(1), changed_ * faded);
      steps_.add({.error = mean(6),
                  .rate = mean(1),
                  .size = mean(0),
                  .dt = dt,
                  .order = 2,
                  .below = mean(2),
                  .highest = highest},
                 seen_ == 3 ? 3 : 1);
    }
    dt_old_ = dt;
    ++seen_;
  }
  /// Error of a step by the scheme of the waves, over dt^3 u'''; 0 without waves.
  double error_of_waves() const {
    if (!view_.parameters().is_compressible()) return 0;
    return view_.parameters().compressibility->scheme == WaveScheme::trapezoidal ? trapezoidal_error
                                                                                 : three_level_error;
  }
  /// True if sound crosses the mesh in no small part of the time in which the flow changes. Collective.
  bool has_waves() {
    const FluidParameters& p = view_.parameters();
    if (!p.is_compressible()) return false;
    if (across_ == 0)
      across_ = mesh::extent_of(view_.mesh.comm, view_.fluid.points_at_rest()).size().maxCoeff();
    return changed_ * across_ > quasi_steady * largest_.value() * p.properties().sound;
  }
  bool absorbs() const {
    return std::ranges::any_of(view_.parameters().boundaries,
                               [](const auto& b) { return b.second.absorbing; });
  }
  diagnostics::ErrorParts parts() {
    diagnostics::ErrorParts parts;
    parts.dimension = D;
    const double speed = root_mean_square<D>(view_.fluid.state().u);
    if (!(speed > 0) || seen_ == 0) return parts;
    const double falls = std::sqrt(largest_pressure() / view_.properties().rho);
    const double across = std::pow(double(view_.mesh.cells.n_global()), 1. / D);
    // A fluid at rest is so within the tolerance of its pressure; what moves then is no solution.
    const double left = view_.parameters().pressure_tolerance * std::sqrt(across) * falls;
    const double size = std::max(speed, largest_.value());
    if (size < left) {
      parts.mesh = parts.step = parts.linear = 0;
      return parts;
    }
    const double scale = diagnostics::scale_of(size, falls);
    parts.field = "velocity", parts.unit = "m/s", parts.size = size;
    parts.mesh = recovered_difference<D>(view_.fluid.state().u, view_.fluid.state().u_boundary) / scale;
    parts.step = step_part() * steps_.size() / scale;
    parts.misses_step = std::isnan(parts.step);
    // The trapezoidal rule also knows the divergence before.
    const auto& known = view_.parameters().compressibility;
    const bool open = known && known->scheme == WaveScheme::trapezoidal;
    parts.linear =
        speed / scale * (open ? view_.parameters().pressure_tolerance : net_outflow()) * std::sqrt(across);
    return parts;
  }
  /// [Pa]; 0 in the first step, whose pressure is an impulse.
  double largest_pressure() const {
    const auto latest = view_.fluid.pressure();
    double most = 0;
    if (latest && view_.step.number > 0)
      for (Index c = 0; c < view_.mesh.cells.n_owned(); ++c) most = std::max(most, std::abs(latest->p[c]));
    return parallel::max(view_.mesh.comm, most);
  }
  /// Root mean square over the volume; per local cell.
  template <int Width>
  double root_mean_square(const Vectors<Width>& values) const {
    const std::vector<double>& volume = view_.fluid.state().placement->volume;
    double squares = 0, whole = 0;
    for (Index c = 0; c < view_.mesh.cells.n_owned(); ++c) {
      squares += volume[c] * values[c].squaredNorm();
      whole += volume[c];
    }
    squares = parallel::sum(view_.mesh.comm, squares), whole = parallel::sum(view_.mesh.comm, whole);
    return whole > 0 ? std::sqrt(squares / whole) : 0;
  }
  double step_part() {
    const double sum = steps_.over_size();
    if (!(steps_.size() > 0)) return sum;
    std::vector<Vec3> places;
    for (const Vec3& x : view_.fluid.state().placement->boundary_centre) places.push_back(x);
    const bool acts =
        driving_.is_possible() && driving_.acts(view_.mesh.comm, places, view_.fluid.state().time, dt_old_,
                                                view_.fluid.state().mesh_flux);
    // The errors of a wave travel with it and add up, unless the flow changes too slowly for one.
    const bool stays = !has_waves() && carried_ <= hardly * changed_;
    if (acts && has_waves() && absorbs())
      return diagnostics::ErrorParts::unknown;  // they leave with the waves
    if (acts) return stays ? std::min(sum, left_of_late_ / steps_.size()) : sum;
    return driving_.moves() || steps_.swings() <= most_swings ? sum : diagnostics::ErrorParts::unknown;
  }
  /// Shows the least and the largest temperature with the mesh's part of their error. Collective.
  void show_temperature() const {
    const HeatLevel& heat = view_.fluid.state().heat;
    Vectors<1> cells, boundary;
    double most[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const double t : heat.temperature) {
      cells.emplace_back(t);
      most[0] = std::max(most[0], -t), most[1] = std::max(most[1], t);
    }
    for (const double t : heat.boundary) boundary.emplace_back(t);
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, view_.mesh.comm);
    const double error = recovered_difference<1>(cells, boundary);
    const double zero = view_.parameters().heat->reference_temperature, largest = zero + most[1];
    if (view_.rank() == 0)
      diagnostics::set_result({.name = "temperature",
                               .unit = "K",
                               .values = {zero - most[0], largest},
                               .error = error / largest,
                               .rank = 1});
  }
  /// `cells` per local cell with current ghosts, `boundary` per boundary face.
  template <int Width>
  double recovered_difference(const Vectors<Width>& cells, const Vectors<Width>& boundary) const {
    const State<D>& s = view_.fluid.state();
    const mesh::Mesh& mesh = view_.mesh;
    const Placement<D>& at = *s.placement;
    std::vector<LinearFit<D, Width>> fits(mesh.cells.n_local());
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      const Vec<D> d = (at.area[f] - at.oblique_of(f)) / at.conductance[f];  // S = k + g d
      const Index owner = mesh.owner[f];
      if (f >= mesh.n_interior) {
        fits[owner].add(d, boundary[f - mesh.n_interior]);
        continue;
      }
      const Index neighbour = mesh.neighbour[f];
      fits[owner].add(d, cells[neighbour]);
      fits[neighbour].add(-d, cells[owner]);
    }
    Vectors<Width> gap(mesh.cells.n_local(), Vec<Width>::Zero());
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      if (!s.blocked || !(*s.blocked)[c]) gap[c] = fits[c].value() - cells[c];
    return root_mean_square<Width>(gap);
  }
  double net_outflow() const {
    const State<D>& s = view_.fluid.state();
    const mesh::Mesh& mesh = view_.mesh;
    std::vector<double> net(mesh.cells.n_local()), through(mesh.cells.n_local());
    for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
      net[mesh.owner[f]] += s.phi[f], through[mesh.owner[f]] += 0.5 * std::abs(s.phi[f]);
      if (f >= mesh.n_interior) continue;
      net[mesh.neighbour[f]] -= s.phi[f], through[mesh.neighbour[f]] += 0.5 * std::abs(s.phi[f]);
    }
    if (view_.parameters().is_compressible()) add_compression(net);
    double left = 0, all = 0;
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) left += net[c] * net[c], all += through[c] * through[c];
    left = parallel::sum(mesh.comm, left), all = parallel::sum(mesh.comm, all);
    return all > 0 ? std::sqrt(left / all) : 0;
  }
  /// Mass taken up by compression is not outflow.
  void add_compression(std::vector<double>& net) const {
    const State<D>& s = view_.fluid.state();
    if (!s.pressure[1]) return;
    std::vector<double> times{s.pressure[1]->time};
    if (s.pressure[2]) times.push_back(s.pressure[2]->time);
    const WaveRule rule = three_level_rule(s.pressure[0]->time, s.time, times);
    const double sound = view_.properties().sound, bulk = view_.properties().rho * sound * sound;
    for (Index c = 0; c < view_.mesh.cells.n_owned(); ++c) {
      double rate = rule.rate * s.pressure[0]->p[c];
      for (std::size_t k = 0; k < times.size(); ++k) rate += rule.past[k] * s.pressure[k + 1]->p[c];
      net[c] += s.placement->volume[c] * rate / bulk;
    }
  }

  FluidView<D> view_;
  Vectors<D> u_, rate_, rate_change_;  // u of the last accepted step, first and second differences in time
  Vectors<D> splitting_, turn_;        // rates by their weights in the local error, their last change
  int seen_ = 0;                       // steps that these hold
  double dt_old_ = 0;
  time::StepErrors steps_;
  double time_ = 0;  // of the steps judged [s]
  Driving driving_;
  Vectors<D> left_;          // sum of local errors; empty if nothing drives the flow
  double left_of_late_ = 0;  // norm, the largest of late
  diagnostics::Reference largest_{"fluid: mean speed"};
  double across_ = 0;  // largest extent of the mesh at rest [m]; 0 if not known
  double carried_ = 0,
         changed_ = 0;  // largest of late: the part of the rates that is convection, and the rates [m/s^2]
};

}  // namespace

template <int D>
diagnostics::Made flow_error(const FluidView<D>& view) {
  return std::make_shared<FluidErrorEstimate<D>>(view);
}

template diagnostics::Made flow_error(const FluidView<2>&);
template diagnostics::Made flow_error(const FluidView<3>&);

}  // namespace couplet::fluid
