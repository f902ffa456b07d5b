// SPDX-License-Identifier: Apache-2.0
// The first guess of a stage and what follows from its solution (equations: SolidStepper).
#include "solid_solver/motion/history.hpp"
#include "solid_solver/motion/solid_stepper.hpp"

namespace couplet::solid {

// For iterative methods: where the accepted motion leads, so that equal loads give equal answers.
// Thesis (2.73): u^n + a v^n; (2.74): and a^2 / (2 dt^n) (v^n - v^{n-1}), a the way to the place of the
// stage.
void SolidStepper::guess(const StageWork& work, const SolidState& now) {
  using Predictor = MethodParameters::Predictor;
  const Predictor predictor = parameters_.method.predictor;
  const double ahead =
      body_.is_dynamic() && predictor != Predictor::none ? work.stage.place * work.stage.dt : 0;
  const bool adams = predictor == Predictor::adams && &now == &state_ && state_.steps > 0;
  const double bend = adams ? ahead * ahead / (2 * state_.dt) : 0;
  const auto curve = [&](std::size_t i) { return adams ? bend * (now.cell_v[i] - now.cell_v_old[i]) : 0.0; };
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  for (std::size_t i = 0; i < n_cells; ++i)
    last_.unknowns[i] = now.cell_u[i] + ahead * now.cell_v[i] + curve(i);
  const auto& faces = elastic_.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[faces[i]]) * dim + a;
      last_.unknowns[n_cells + i * dim + a] = now.face_u[b] + ahead * now.face_v[b] + curve(c);
    }
}

void SolidStepper::finish_cells(const StageWork& work, const SolidState& now) {
  const time::Stage& stage = work.stage;
  const double s = work.damping_scale, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  const History levels(now, state_, false);
  const std::size_t n = std::size_t(mesh_.cells.n_owned()) * mesh_.dim;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = beta > 0 ? (last_.unknowns[i] - beta * levels(stage.rate, i)) / s : last_.unknowns[i];
    const double u = levels(stage.end_value, i, x), v = levels(stage.end_rate, i, x);
    if (!trial_.cell_a.empty()) trial_.cell_a[i] = levels(stage.end_acceleration, i, x);
    trial_.cell_u[i] = u;
    trial_.cell_v[i] = v;
  }
  trial_.stage_dt = stage.dt;
  if (body_.has_mass()) return finish_faces(work, now);
  const int dim = mesh_.dim;
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[f]) * dim + a;
      trial_.face_u[b] += trial_.cell_u[c];
      trial_.face_v[b] += trial_.cell_v[c];
    }
}

/// As the cells, where faces have inertia. What a support knows is imposed at the end of the step.
void SolidStepper::finish_faces(const StageWork& work, const SolidState& now) {
  const time::Stage& stage = work.stage;
  const double s = work.damping_scale, beta = parameters_.damping ? parameters_.damping->stiffness : 0;
  const History levels(now, state_, true);
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  const auto& open = elastic_.unknown_faces();
  for (std::size_t i = 0; i < open.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(open[i] - mesh_.n_interior) * dim + a;
      const double w = last_.unknowns[n_cells + i * dim + a];
      const double x = beta > 0 ? (w - beta * levels(stage.rate, b)) / s : w;
      const double u = levels(stage.end_value, b, x), v = levels(stage.end_rate, b, x);
      if (!trial_.face_a.empty()) trial_.face_a[b] = levels(stage.end_acceleration, b, x);
      trial_.face_u[b] = u;
      trial_.face_v[b] = v;
    }
}

// Leaves in the faces what finish_cells() adds to their cells' values:
// delta = u_B - u_P at the end of the stage from the places of this solve and the last one (the trapezoidal
// rule with equal steps: 3/2 and -1/2), its rate likewise from the difference of the ends, which lives in the
// middle. Stiffness damping makes w of the solve lead: w_B - w_P = delta + beta d(delta)/dt.
void SolidStepper::finish_offsets(const time::Stage& stage, const SolidState& now) {
  if (body_.has_mass()) return;
  const int dim = mesh_.dim;
  const std::size_t n_cells = std::size_t(mesh_.cells.n_owned()) * dim;
  const bool is_first = now.stage_dt == 0;
  const double lag = (1 - stage.place) * stage.dt, gap = now.offset_lag + stage.place * stage.dt;
  const double slope = is_first ? 0 : lag / gap;
  const double rate_slope = is_first || !body_.is_dynamic() ? 0 : stage.dt / (stage.dt + now.stage_dt);
  const double relax = (parameters_.damping ? parameters_.damping->stiffness : 0) / gap;
  const auto& faces = elastic_.unknown_faces();
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(faces[i] - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[faces[i]]) * dim + a;
      const double here =
          (last_.unknowns[n_cells + i * dim + a] - last_.unknowns[c] + relax * now.offset[b]) / (1 + relax);
      const double end = here + slope * (here - now.offset[b]);
      const double rate = (end - (now.face_u[b] - now.cell_u[c])) / stage.dt;
      const double end_rate = rate + rate_slope * (rate - now.offset_rate[b]);
      trial_.offset[b] = here;
      trial_.offset_rate[b] = rate;
      trial_.face_u[b] = end;
      trial_.face_v[b] = end_rate;
    }
  trial_.offset_lag = lag;
}

// The mean over a step lives in its middle, in every scheme; at n+1 it is extrapolated from the last two.
// Traction faces have that of their cell and the change of their offset's rate.
void SolidStepper::finish_acceleration() {
  const double dt = step_.dt, slope = state_.steps > 0 ? dt / (dt + state_.dt) : 0;
  for (std::size_t i = 0; i < trial_.acceleration.size(); ++i) {
    const double mean = (trial_.cell_v[i] - state_.cell_v[i]) / dt;
    trial_.mean_acceleration[i] = mean;
    trial_.acceleration[i] = mean + slope * (mean - state_.mean_acceleration[i]);
  }
  const int dim = mesh_.dim;
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const std::size_t c = std::size_t(mesh_.owner[f]) * dim + a;
      // Faces with inertia: as their cell, with what their own velocity changes more.
      const double rate = trial_.face_v[b] - trial_.cell_v[c], before = state_.face_v[b] - state_.cell_v[c];
      trial_.face_acceleration[b] = trial_.acceleration[c] + (rate - before) / dt;
    }
  mesh_.cells.update_ghosts(trial_.acceleration, dim);
  mesh_.boundary.update_ghosts(trial_.face_acceleration, dim);
  elastic_.join_twins(trial_.face_acceleration);
}

}  // namespace couplet::solid
