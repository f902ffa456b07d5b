// SPDX-License-Identifier: Apache-2.0
// The coupled system of velocity and pressure of a step whose friction is implicit.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/step/fractional_step.hpp"

namespace couplet::fluid {
namespace {

// Splitting error above which a step solves the coupled system, and the one that is enough. With the second the force of a squeezed
// film stays within 3 %; with the first it is 6 % off where the gap closes fast.
constexpr double largest_splitting = 0.2, small_splitting = 0.05;
constexpr int most_passes = 60, early_passes = 12;
constexpr double early_share =
    0.7;  // largest share of the first error that may be left after the early passes
constexpr linalg::Acceleration pass_acceleration{linalg::Acceleration::Type::anderson, 1, 20};

}  // namespace

/// Friction of the step, a dt nu L x with walls at rest, integrated over each cell.
template <int D>
Vectors<D> FractionalStep<D>::friction_of(const Vectors<D>& x) const {
  const Placement<D>& at = *step_.to;
  const double beta = prediction_.weight * scene_.fluid.nu * step_.dt;
  Vectors<D> rate(x.size(), Vec<D>::Zero());
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> flux = beta * at.conductance[f] * (x[n] - x[p]);
    rate[p] += flux;
    rate[n] -= flux;
  }
  const BoundaryRows& given = scene_.boundary.rows();
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index b = f - mesh_.n_interior, p = mesh_.owner[f];
    const double a = beta * at.conductance[f], t = given.friction[b];
    const Vec<D> n = at.area[f].normalized();
    rate[p] -= a * t * x[p] + a * (1 - given.pressure[b] - t) * x[p].dot(n) * n;
  }
  return rate;
}

/// Relative residual of the coupled system, or a bound of it that is at most `enough`. The projection changes the velocity by
/// dt/rho grad(p - guess), whose friction is not in the momentum equation that the predictor solved. The scale is the pressure
/// gradient or the friction of level n, whichever is larger.
template <int D>
double FractionalStep<D>::splitting_error(const PressureLevel<D>& now, double enough) {
  if (prediction_.weight == 0 || !step_.guess) return 0;
  const Vectors<D>&gradient = now.gradient, &guess = step_.guess->gradient,
        &viscous = prediction_.rates.viscous;
  const std::vector<double>&volume = step_.to->volume, &inverse = predictor_.inverse_diagonal();
  double sums[3] = {}, stiffness = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    sums[0] += volume[c] * (gradient[c] - guess[c]).squaredNorm();
    sums[1] += volume[c] * gradient[c].squaredNorm();
    sums[2] += viscous[c].squaredNorm() / volume[c];
    stiffness = std::max(stiffness, 1 / (volume[c] * inverse[c]) - 1);  // a dt nu sum g / V
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double scale = std::sqrt(std::max(sums[1], scene_.fluid.rho * scene_.fluid.rho * sums[2]));
  if (!(scale > 0)) return 0;
  // The eigenvalues of friction are at most twice its diagonal.
  const double bound = 2 * parallel::max(mesh_.comm, stiffness) * std::sqrt(sums[0]) / scale;
  if (bound <= enough) return bound;
  Vectors<D> change = gradient;
  for (std::size_t c = 0; c < change.size(); ++c) change[c] -= guess[c];
  const Vectors<D> left = friction_of(change);
  double square = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) square += left[c].squaredNorm() / volume[c];
  return std::sqrt(parallel::sum(mesh_.comm, square)) / scale;
}

/// Solves the coupled system of velocity and pressure, preconditioned by a step's predictor and projection [griffith2009].
/// Anderson acceleration of the predictor's pressure equals GMRES for this linear system. The uncoupled step is kept if the
/// passes do not converge or gain more energy than it: where a slot reopens, its noise can grow in them.
template <int D>
void FractionalStep<D>::solve_coupled(const State<D>& from, const Vectors<D>& w) {
  if (scene_.obstacles->marks() || bodies_) return;
  if (!scene_.boundary.interface_patches().empty()) return;  // docs/validation/choices.md
  const double first = splitting_error(*level_, largest_splitting);
  if (first <= largest_splitting) return;
  const std::size_t owned = std::size_t(mesh_.cells.n_owned());
  std::vector<double> p(owned + w.size()), change(p.size());
  linalg::VectorAccelerator accelerator(mesh_.comm, p.size(), pass_acceleration);
  const double excess = step_.moving() ? evaluate(from).energy.ledger.excess : 0;
  auto level = std::move(level_);
  double error = first;
  for (int pass = 0; error > small_splitting && pass < most_passes; ++pass) {
    if (pass == early_passes && !(error < early_share * first)) break;
    const auto each = [&](auto&& visit) {
      for (std::size_t c = 0; c < owned; ++c) visit(c, step_.guess->p[c], level->p[c]);
      for (std::size_t b = 0; b < w.size(); ++b)
        visit(owned + b, step_.guess->boundary[b], level->boundary[b]);
    };
    each([&](std::size_t i, double guess, double now) { p[i] = guess, change[i] = now - guess; });
    accelerator.advance(p, change);
    each([&](std::size_t i, double, double& now) { now = p[i]; });
    mesh_.cells.update_ghosts(level->p);
    projection_.start(*step_.to, *level);
    step_.guess = std::move(level);
    project_from_guess(from, w);
    level = projection_.pressure_level();
    error = splitting_error(*level, small_splitting);
  }
  level_ = correct();
  if (error <= largest_splitting && (!step_.moving() || evaluate(from).energy.ledger.excess <= excess))
    return;
  step_.guess = step_.by.pressure[0];
  project_from_guess(from, w);
  level_ = correct();
}

template <int D>
void FractionalStep<D>::project_from_guess(const State<D>& from, const Vectors<D>& w) {
  predict_from_guess(from);
  projection_.start_from(step_.guess == step_.by.pressure[0] ? nullptr : step_.guess.get());
  projection_.project(from, w, flux_.phi(), 0);
  loads_.set(scene_, step_, prediction_, projected_, from);
}

template void FractionalStep<2>::solve_coupled(const State<2>&, const Vectors<2>&);
template void FractionalStep<3>::solve_coupled(const State<3>&, const Vectors<3>&);
template void FractionalStep<2>::project_from_guess(const State<2>&, const Vectors<2>&);
template void FractionalStep<3>::project_from_guess(const State<3>&, const Vectors<3>&);

}  // namespace couplet::fluid
