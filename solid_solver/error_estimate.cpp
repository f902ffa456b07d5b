// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/error_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet {

SolidErrorEstimate::SolidErrorEstimate(const SolidBody& body, const SolidStepper& stepper,
                                       const SolidFields& fields, const SolidJudge& judge)
    : body_(body), stepper_(stepper), fields_(fields), judge_(judge) {
  const Mesh& mesh = body.mesh();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume_ += mesh.reference.volume[c];
  volume_ = sum(mesh.comm, volume_);
}

/// Over the volume; `dim` values a cell.
double SolidErrorEstimate::mean_square(std::span<const double> cells) const {
  const Mesh& mesh = body_.mesh();
  double squares = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    for (int a = 0; a < mesh.dim; ++a) {
      const double value = cells[std::size_t(c) * mesh.dim + a];
      squares += mesh.reference.volume[c] * value * value;
    }
  return sum(mesh.comm, squares) / volume_;
}

/// Of the step just solved, root mean squares: C dt^2 d2u/dt2 by two velocities, or C dt^3 d3u/dt3 by three.
StepErrors::Seen SolidErrorEstimate::seen() const {
  const Mesh& mesh = body_.mesh();
  const SolidState &now = stepper_.trial(), &before = stepper_.state();
  const LocalError local = couplet::local_error(body_.parameters().time_scheme);
  const double dt = now.dt, dt_old = before.dt;
  std::vector<double> second(std::size_t(mesh.cells.n_owned()) * mesh.dim), third;
  for (std::size_t i = 0; i < second.size(); ++i) second[i] = (now.cell_v[i] - before.cell_v[i]) / dt;
  if (local.order > 1 && !v_before_.empty()) {
    third.resize(second.size());
    for (std::size_t i = 0; i < third.size(); ++i)
      third[i] = 2 * (second[i] - (before.cell_v[i] - v_before_[i]) / dt_old) / (dt + dt_old);
  }
  StepErrors::Seen seen{.rate = std::sqrt(mean_square(now.cell_v)),
                        .size = std::sqrt(mean_square(now.cell_u)),
                        .dt = dt,
                        .order = local.order};
  const double by_two = std::sqrt(mean_square(second));
  seen.below = local.order == 1 ? seen.rate : by_two;
  if (local.order == 1)
    seen.highest = by_two;
  else if (!v_before_.empty())
    seen.highest = std::sqrt(mean_square(third));
  seen.error = std::abs(local.constant) * std::pow(dt, local.order + 1) * seen.highest;
  return seen;
}

/// Over the size of the solution.
double SolidErrorEstimate::left_by_solver() const {
  const LastSolve& last = stepper_.last_solve();
  const double residual = stepper_.effort().residual;
  if (body_.finite()) return residual;  // relative already
  const double size = norm(body_.mesh().comm, last.rhs);
  return size > 0 ? residual / size : 0;
}

/// |u . (b - A u)| / |u . b| of the last static solve, linear: u . b grows by as much as A u misses of b.
double SolidErrorEstimate::missed_work() const {
  const LastSolve& last = stepper_.last_solve();
  std::vector<double> force(last.unknowns.size());
  body_.kernel().apply(last.unknowns, {}, force);
  double missed = 0, work = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    missed += last.unknowns[i] * (last.rhs[i] - force[i]);
    work += last.unknowns[i] * last.rhs[i];
  }
  const MPI_Comm comm = body_.mesh().comm;
  missed = sum(comm, missed), work = sum(comm, work);
  return work != 0 ? std::abs(missed / work) : 0;
}

void SolidErrorEstimate::see_step() {
  if (!body_.is_dynamic()) return;
  const StepErrors::Seen step = seen();
  const bool first_order = step.order == 1;
  if (first_order || !v_before_.empty()) {
    steps_.add(step, first_order || judged_ ? 1 : 2);
    judged_ = true;
  }
  linear_.add({.error = left_by_solver() * step.size, .rate = step.rate, .size = step.size, .dt = step.dt});
  v_before_ = stepper_.state().cell_v;
}

ErrorParts SolidErrorEstimate::parts() const {
  ErrorParts parts;
  if (stepper_.state().steps == 0) return parts;
  if (body_.is_dynamic()) {
    parts.step = steps_.over_size();
    parts.linear = linear_.over_size();
  } else {
    parts.linear = body_.finite() ? left_by_solver() : missed_work();
  }
  if (body_.finite()) return parts;
  const StrainAudit audit = judge_.audit_strain(fields_.point_displacement(), true);
  parts.mesh = std::max(audit.mismatch(), audit.gradient_difference * audit.gradient_difference);
  return parts;
}

std::vector<double> SolidErrorEstimate::state() const {
  const std::vector<double> steps = steps_.state(), linear = linear_.state();
  std::vector<double> values{judged_ ? 1. : 0., double(steps.size()), double(linear.size())};
  for (const auto* part : {&steps, &linear, &v_before_})
    values.insert(values.end(), part->begin(), part->end());
  return values;
}

void SolidErrorEstimate::restore(std::span<const double> state) {
  v_before_.clear();
  steps_ = linear_ = {};
  judged_ = false;
  if (state.empty()) return;
  judged_ = state[0] != 0;
  const auto n_steps = std::size_t(state[1]), n_linear = std::size_t(state[2]);
  steps_.restore(state.subspan(3, n_steps));
  linear_.restore(state.subspan(3 + n_steps, n_linear));
  const auto velocity = state.subspan(3 + n_steps + n_linear);
  v_before_.assign(velocity.begin(), velocity.end());
}

}  // namespace couplet
