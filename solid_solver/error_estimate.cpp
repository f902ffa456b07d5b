// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/error_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {

SolidErrorEstimate::SolidErrorEstimate(const SolidBody& body, const SolidStepper& stepper,
                                       const SolidFields& fields, const SolidJudge& judge)
    : body_(body), stepper_(stepper), fields_(fields), judge_(judge), steps_(body.parameters().time_scheme) {
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
  const SolidState &now = stepper_.trial(), &before = stepper_.state();
  const std::size_t n = std::size_t(body_.mesh().cells.n_owned()) * body_.mesh().dim;
  const auto norm = [this](std::span<const double> cells) { return std::sqrt(mean_square(cells)); };
  const StepErrors::Seen step = steps_.add(std::span(before.cell_v).first(n), std::span(now.cell_v).first(n),
                                           now.dt, before.dt, norm(now.cell_u), norm);
  linear_.add({.error = left_by_solver() * step.size, .rate = step.rate, .size = step.size, .dt = step.dt});
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
  const std::vector<double> linear = linear_.state(), steps = steps_.state();
  std::vector<double> values{double(linear.size())};
  for (const auto* part : {&linear, &steps}) values.insert(values.end(), part->begin(), part->end());
  return values;
}

void SolidErrorEstimate::restore(std::span<const double> state) {
  const auto n = state.empty() ? 0 : std::size_t(state[0]);
  if (!state.empty() && n > state.size() - 1) throw Error("The checkpoint's errors of steps are damaged.");
  linear_.restore(state.empty() ? state : state.subspan(1, n));
  steps_.restore(state.empty() ? state : state.subspan(1 + n));
}

}  // namespace couplet
