// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/step_size.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <utility>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// AB2 is slightly unstable on the imaginary axis: tolerated growth per step, balanced by damping elsewhere.
constexpr double tolerated_growth = 5e-4;
// Limit of cells with few faces, as a multiple of the explicit limit, see StepSize.
constexpr double longest_implicit = 16;
// Ratio of largest eigenvalues, fourth to second order: of (8 sin k - sin 2k)/6, and 16/3 over 4.
constexpr double fourth_convection = 1.3722, fourth_friction = 4. / 3;
// Beyond this, explicit convection is no longer resolved in time.
constexpr double largest_courant = 1;

// Roots of (1 + a d) z^2 - (1 - b d + 3/2 i k) z + (c d + i k/2) = 0, the pair at constant step with a =
// 9/16, b = 3/8, c = 1/16.
bool stable(double k, double d) {
  using namespace std::complex_literals;
  const std::complex<double> p = 1 + 9.0 / 16 * d, q = -(1 - 3.0 / 8 * d + 1.5i * k), r = d / 16 + 0.5i * k;
  const std::complex<double> root = std::sqrt(q * q - 4.0 * p * r);
  return std::max(std::abs(-q + root), std::abs(-q - root)) <= 2 * std::abs(p) * (1 + tolerated_growth);
}

double compute_implicit_limit(double q) {
  constexpr int waves = 48;
  double low = 0, high = largest_courant;
  const auto all_stable = [q](double courant) {
    for (int i = 1; i <= waves; ++i) {
      const double theta = std::numbers::pi * i / waves;
      if (!stable(courant * std::sin(theta), q * courant * (1 - std::cos(theta)) / 2)) return false;
    }
    return true;
  };
  if (all_stable(high)) return high;
  for (int i = 0; i < 30; ++i) (all_stable((low + high) / 2) ? low : high) = (low + high) / 2;
  return low;
}

// Table of the limit over log10(q) in [-2, 2].
class LimitTable {
 public:
  LimitTable() {
    for (int i = 0; i < n; ++i) values_[i] = compute_implicit_limit(std::pow(10.0, -2 + 4.0 * i / (n - 1)));
  }
  double least() const { return *std::min_element(values_.begin(), values_.end()); }
  double operator()(double q) const {
    if (!(q > 1e-2)) return values_.front();
    if (q >= 1e2) return values_.back();
    const double place = (std::log10(q) + 2) / 4 * (n - 1);
    const int i = std::min(static_cast<int>(place), n - 2);
    return std::min(values_[i], values_[i] + (place - i) * (values_[i + 1] - values_[i]));
  }

 private:
  static constexpr int n = 81;
  std::array<double, n> values_{};
};

double round_down(double value) {
  if (!std::isfinite(value) || value <= 0) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 5);
  return std::floor(value / unit) * unit;
}

const LimitTable& implicit_table() {
  static const LimitTable table;
  return table;
}
constexpr std::array<double, 6> degrees{0, 45, 60, 75, 85, 90},
    adams_bashforth{1, 0.96, 0.91, 0.81, 0.63, 0.25};

/// Lower bound of the limit. Cells for which it is not decisive are skipped without computing the angle.
double lowest_limit(double convection, double diffusion) { return convection <= diffusion ? 0.96 : 0.25; }

constexpr int most_sub_steps = 100000;
// Relative cost of a sub-step with the implicit viscous term.
constexpr double implicit_cost = 1.5;

double parts(double dt, double limit) {
  return std::isfinite(limit) ? std::max(1.0, std::ceil(dt / limit - 1e-9)) : 1.0;
}

}  // namespace

double implicit_convective_limit(double q) { return implicit_table()(q); }

double explicit_limit(double angle) {
  const double a = angle * 180 / std::numbers::pi;
  for (std::size_t i = 1; i < degrees.size(); ++i)
    if (a <= degrees[i])
      return std::lerp(adams_bashforth[i - 1], adams_bashforth[i],
                       (a - degrees[i - 1]) / (degrees[i] - degrees[i - 1]));
  return adams_bashforth.back();
}

template <int D>
StepSize<D>::StepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary, double kinematic_viscosity,
                      const MomentumTerms<D>& terms)
    : mesh_(mesh), boundary_(boundary), terms_(terms), nu_(kinematic_viscosity) {
  std::vector<int> faces(std::size_t(mesh.cells.n_local()), 0);
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    ++faces[mesh.owner[f]];
    if (f < mesh.n_interior) ++faces[mesh.neighbour[f]];
  }
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) few_faces_.push_back(faces[c] < 2 * D);
}

/// Limit of the implicit term by friction in a cell whose explicit rates have this angle and size.
template <int D>
double StepSize<D>::friction_limit(Index cell, double angle, double size) const {
  return few_faces_[cell] && size > 0 ? longest_implicit * explicit_limit(angle) / size : base::infinity;
}

/// Largest Courant number of a cell with an implicit viscous term.
template <int D>
double StepSize<D>::convective_limit(Index cell) const {
  return std::max(implicit_convective_limit(4 / peclet_of_[cell]), courant_);
}

template <int D>
std::vector<double> StepSize<D>::fast_cells(const State<D>& s, double size) {
  std::vector<double> fast(mesh_.cells.n_local(), 0.0);
  add_rates(s, true);
  bool any = false;
  for_rates(s, [&](Index c, double convection, double) {
    if (convection * size <= implicit_convective_limit(4 / peclet_of_[c])) return;
    fast[c] = 1;
    any = true;
  });
  if (!parallel::any(mesh_.comm, any)) return {};
  mesh_.cells.update_ghosts(fast);
  return fast;
}

/// sum |phi - dV/dt|/2 and 2 nu sum g of each cell; with `peclet` also the largest |phi - dV/dt|/(nu g) of
/// its faces.
template <int D>
void StepSize<D>::add_rates(const State<D>& s, bool peclet) {
  const Placement<D>& at = *s.placement;
  rates_.assign(mesh_.cells.n_local(), Vec<2>::Zero());
  peclet_of_.assign(peclet ? mesh_.cells.n_local() : 0, 0.0);
  const bool moving = !s.mesh_flux.empty();
  const auto flux_of = [&](Index f) { return std::abs(s.phi[f] - (moving ? s.mesh_flux[f] : 0.0)); };
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double flux = flux_of(f), g = at.conductance[f];
    const Vec<2> part(0.5 * flux, 2 * nu_ * g);
    rates_[p] += part;
    rates_[n] += part;
    if (!peclet) continue;
    const double number = nu_ > 0 ? flux / (nu_ * g) : base::infinity;
    peclet_of_[p] = std::max(peclet_of_[p], number);
    peclet_of_[n] = std::max(peclet_of_[n], number);
  }
  if (peclet && !s.excess.empty()) {  // with the local viscosity
    std::ranges::fill(peclet_of_, 0.0);
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const double nu = nu_ + s.excess[f];
      const double number = nu > 0 ? flux_of(f) / (nu * at.conductance[f]) : base::infinity;
      for (const Index c : {mesh_.owner[f], mesh_.neighbour[f]})
        peclet_of_[c] = std::max(peclet_of_[c], number);
    }
  }
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const double friction = boundary_.rows().friction[f - mesh_.n_interior];
    rates_[mesh_.owner[f]] += Vec<2>(0.5 * flux_of(f), friction * 2 * nu_ * at.conductance[f]);
  }
  if (fourth_) {
    for (Vec<2>& rate : rates_) rate = Vec<2>(fourth_convection * rate[0], fourth_friction * rate[1]);
    for (double& number : peclet_of_) number *= fourth_convection;
  }
  for (const auto& term : terms_) term->add_limits(s, rates_);
}

/// Limit by the Coriolis force on uniform motion and by buoyancy, which friction does not damp.
template <int D>
double StepSize<D>::frame_limit() const {
  return frame_rate_ > 0 ? explicit_limit(std::numbers::pi / 2) / frame_rate_ : base::infinity;
}

/// Calls use(cell, convection, diffusion) with the rates [1/s] of each owned cell that is not blocked.
template <int D>
template <class Use>
void StepSize<D>::for_rates(const State<D>& s, const Use& use) const {
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (s.blocked && (*s.blocked)[c]) continue;
    const double volume = s.placement->volume[c];
    use(c, rates_[c][0] / volume, rates_[c][1] / volume);
  }
}

template <int D>
StepLimits StepSize<D>::limits(const State<D>& s) {
  add_rates(s, true);
  const double lowest_implicit = std::max(implicit_table().least(), courant_);
  double least[2] = {base::infinity, base::infinity};
  for_rates(s, [&](Index c, double convection, double diffusion) {
    const double size = std::sqrt(convection * convection + diffusion * diffusion),
                 lowest = lowest_limit(convection, diffusion);
    if (lowest < least[0] * size)
      least[0] = std::min(least[0], explicit_limit(std::atan2(convection, diffusion)) / size);
    if (few_faces_[c] && longest_implicit * lowest < least[1] * size)
      least[1] = std::min(least[1], friction_limit(c, std::atan2(convection, diffusion), size));
    if (lowest_implicit < least[1] * convection)
      least[1] = std::min(least[1], convective_limit(c) / convection);
  });
  MPI_Allreduce(MPI_IN_PLACE, least, 2, MPI_DOUBLE, MPI_MIN, mesh_.comm);
  for (double& limit : least) limit = std::min(limit, frame_limit());
  return {round_down(least[0]), round_down(least[1])};
}

template <int D>
double StepSize<D>::scalar_limit(const State<D>& s) {
  add_rates(s, true);
  double least = base::infinity;
  for_rates(s, [&](Index c, double convection, double) {
    if (convection > 0) least = std::min(least, convective_limit(c) / convection);
  });
  return round_down(parallel::min(mesh_.comm, least));
}

template <int D>
StepLimiter StepSize<D>::limiter(const State<D>& s, bool implicit) {
  add_rates(s, implicit);
  const auto limit_of = [&](Index c, double convection, double diffusion) {
    const double size = std::hypot(convection, diffusion), angle = std::atan2(convection, diffusion);
    if (!implicit)
      return std::pair(size > 0 ? explicit_limit(angle) / size : base::infinity, diffusion > convection);
    const double friction = friction_limit(c, angle, size);
    const double limit = convection > 0 ? convective_limit(c) / convection : base::infinity;
    return std::pair(std::min(limit, friction), friction < limit);
  };
  StepLimiter found{base::infinity};
  for_rates(s, [&](Index c, double convection, double diffusion) {
    const auto [limit, friction] = limit_of(c, convection, diffusion);
    if (limit >= found.limit) return;
    found = {limit, mesh_.cell_id[c], Vec3::Zero(), friction};
    found.place.template head<D>() = s.placement->centre[c];
  });
  const std::vector<StepLimiter> all = parallel::all_gather(mesh_.comm, std::vector<StepLimiter>{found});
  found = *std::ranges::min_element(all, [](const StepLimiter& a, const StepLimiter& b) {
    return a.limit != b.limit ? a.limit < b.limit : a.cell < b.cell;
  });
  if (frame_limit() < found.limit) {
    found.limit = frame_limit(), found.friction = false, found.frame = true;
    return found;
  }
  double near = 0, cells = 0;
  for_rates(s, [&](Index c, double convection, double diffusion) {
    near += limit_of(c, convection, diffusion).first < 2 * found.limit;
    ++cells;
  });
  found.share = parallel::sum(mesh_.comm, near) / parallel::sum(mesh_.comm, cells);
  return found;
}

std::string in_words(const StepLimiter& by) {
  return fmt::format("In cell {} at ({:.6g}, {:.6g}, {:.6g}) m, {} limits them to this size.", by.cell,
                     by.place.x(), by.place.y(), by.place.z(), by.cause());
}

template class StepSize<2>;
template class StepSize<3>;

template <int D>
SubStepSize<D>::SubStepSize(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                            const FluidParameters& parameters, const MomentumTerms<D>& terms)
    : parameters_(parameters), size_(mesh, boundary, parameters.properties().nu, terms) {
  size_.set_courant(parameters.courant.value_or(0) / parameters.safety_factor);
  if (const auto& heat = parameters.heat)
    heat_size_.emplace(mesh, boundary, heat->conductivity / (parameters.density * heat->specific_heat),
                       no_terms_);
}

template <int D>
StepLimits SubStepSize<D>::limits_of(const State<D>& level) {
  StepLimits limits = size_.limits(level);
  if (!heat_size_) return limits;
  const double most = heat_size_->scalar_limit(level);
  return {std::min(limits.explicit_viscous, most), std::min(limits.implicit_viscous, most)};
}

template <int D>
void SubStepSize<D>::begin_step(const State<D>& level, double time, double dt, double frame_rate, bool starts,
                                FlowHistory<D>& begin) {
  starts_ = starts;
  time_ = time;
  dt_ = dt;
  size_.set_frame_rate(frame_rate);
  if (!parameters_.time_step) limits_ = limits_of(level);
  if (parameters_.viscous == ViscousTreatment::automatic) choose_viscous_treatment(level, begin);
}

// A prescribed step is kept for either treatment: implicit if explicit would be unstable. Otherwise the
// cheaper one is chosen. A change restarts the multi-step schemes and so requires a clear gain.
template <int D>
void SubStepSize<D>::choose_viscous_treatment(const State<D>& level, FlowHistory<D>& begin) {
  bool implicit = begin.implicit;
  if (parameters_.time_step) {
    const double own = dt_ / parts(dt_, *parameters_.time_step);
    implicit =
        size_.limits(level).explicit_viscous < own * (implicit ? 1.3 : 1.0) / parameters_.safety_factor;
  } else {
    const double with_explicit = parts(dt_, parameters_.safety_factor * limits_.explicit_viscous);
    const double with_implicit =
        implicit_cost * parts(dt_, parameters_.safety_factor * implicit_limit(limits_));
    if (implicit && with_explicit < 0.7 * with_implicit) implicit = false;
    if (!implicit && with_implicit < 0.9 * with_explicit) implicit = true;
  }
  if (implicit == begin.implicit) return;
  begin.implicit = implicit;
  begin.dt_old = 0;
}

/// Limit by stability, and on request by accuracy.
template <int D>
double SubStepSize<D>::implicit_limit(const StepLimits& limits) const {
  if (!parameters_.implicit_stretch) return limits.implicit_viscous;
  return std::min(limits.implicit_viscous, *parameters_.implicit_stretch * limits.explicit_viscous);
}

template <int D>
double SubStepSize<D>::next(const State<D>& level, bool implicit, int done, double remaining, bool& last) {
  double limit = 0;
  if (parameters_.time_step) {
    limit = *parameters_.time_step;
  } else {
    const StepLimits limits = done == 0 || starts_ ? limits_ : limits_of(level);
    limit = parameters_.safety_factor * (implicit ? implicit_limit(limits) : limits.explicit_viscous);
  }
  const double n = parts(remaining, limit);
  if (!(n + done <= most_sub_steps))
    throw SolveFailure(
        "The fluid would need more than {} sub-steps of {:.3g} s for the step of {:.3g} s at t = {:.6g} s. {}",
        most_sub_steps, limit, dt_, time_,
        parameters_.time_step ? "It follows from 'time-step'." : in_words(size_.limiter(level, implicit)));
  last = n == 1;
  return remaining / n;
}

template class SubStepSize<2>;
template class SubStepSize<3>;

}  // namespace couplet::fluid
