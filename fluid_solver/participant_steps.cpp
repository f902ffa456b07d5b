// SPDX-License-Identifier: Apache-2.0
// What a participant tells of its sub-steps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/log/finding.hpp"
#include "common/log/log.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid {
namespace {

// Sub-steps of a step over those of the step last told in the log, or the other way round.
constexpr double most_times_as_many = 2;
// Of the limits of a step that is given: what is certain to go wrong.
constexpr double far_above = 2;
constexpr int steps_between_looks = 10;

/// sum |phi - dV/dt| / (2 V) of a cell, a Courant number over the step, or with `friction` its sum nu g / (2 D V), which is nu/h^2 of
/// a cube [1/s]. Collective.
template <int D>
double rate_of(const mesh::Mesh& mesh, const Fluid<D>& fluid, GlobalIndex cell, bool friction) {
  const State<D>& s = fluid.state();
  const double nu = fluid.parameters().kinematic_viscosity();
  double rate = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const bool inside = f < mesh.n_interior;
    const Index c = mesh.cell_id[mesh.owner[f]] == cell                 ? mesh.owner[f]
                    : inside && mesh.cell_id[mesh.neighbour[f]] == cell ? mesh.neighbour[f]
                                                                        : -1;
    if (c < 0 || c >= mesh.cells.n_owned()) continue;
    const double flux = std::abs(s.phi[f] - (s.mesh_flux.empty() ? 0.0 : s.mesh_flux[f]));
    rate += (friction ? nu * s.placement->conductance[f] / (2 * D) : flux / 2) / s.placement->volume[c];
  }
  return parallel::sum(mesh.comm, rate);
}

}  // namespace

/// A step that is given is kept, also where it is too long for the implicit term on cells with few faces (StepSize). Looked at where
/// it is the longest so far, and, where the limit itself changes (cells that move, viscosity of eddies), every few steps and at the
/// end.
template <int D>
void FluidParticipant<D>::see_given_step() {
  if (!fluid_->parameters().time_step || !fluid_->state().implicit) return;
  if (fluid_->moving() || fluid_->parameters().turbulence) ++steps_unseen_;
  const double size = step_.dt / fluid_->statistics().sub_steps;
  if (size <= longest_seen_ && steps_unseen_ < steps_between_looks) return;
  longest_seen_ = std::max(longest_seen_, size);
  doubt_given_step(size);
}

template <int D>
void FluidParticipant<D>::doubt_given_step(double size) {
  steps_unseen_ = 0;
  const StepLimiter by = fluid_->sizes().limiter(fluid_->state());
  if (!by.friction || size <= far_above * by.limit || size / by.limit <= 2 * doubted_times_) return;
  doubted_times_ = size / by.limit;
  log::finding(
      parallel::comm_rank(mesh_.comm),
      {.id = "given-step",
       .number = size / by.limit,
       .limit = far_above,
       .sentence = fmt::format(
           "t = {:.6g} s: time-step: sub-steps of {:.3g} s are {:.1f} times the limit of an implicit "
           "viscous term in cell {} at ({:.4g}, {:.4g}, {:.4g}) m: pressures and forces grow spuriously",
           step_.time + step_.dt, size, size / by.limit, by.cell, by.place.x(), by.place.y(), by.place.z()),
       .advice = fmt::format("remove 'time-step', or set at most {:.3g} s", by.limit)});
}

/// One line where a step took many more parts than when it was last told, or many fewer, with the cell that
/// asks for them.
template <int D>
void FluidParticipant<D>::tell_sub_steps() {
  const int now = fluid_->statistics().sub_steps;
  const bool as_told =
      now < most_times_as_many * told_sub_steps_ && told_sub_steps_ < most_times_as_many * now;
  if (as_told) return;
  told_sub_steps_ = now;
  const double end = step_.time + step_.dt;
  if (const auto own = fluid_->parameters().time_step) {
    if (parallel::comm_rank(mesh_.comm) == 0)
      log::info("t = {:.6g} s: {} sub-steps of {:.3g} s: time-step is {:.3g} s", end, now, step_.dt / now,
                *own);
    return;
  }
  const StepLimiter limiter = fluid_->sizes().limiter(fluid_->state());
  if (parallel::comm_rank(mesh_.comm) == 0)
    log::info(
        "t = {:.6g} s: {} sub-steps of {:.3g} s; {} in cell {} at ({:.4g}, {:.4g}, {:.4g}) m limits them to "
        "{:.3g} s, of which {:.0f} % are used",
        end, now, step_.dt / now, limiter.friction ? "friction" : "convection", limiter.cell,
        limiter.place.x(), limiter.place.y(), limiter.place.z(), limiter.limit,
        100 * fluid_->parameters().safety_factor);
}

template <int D>
std::vector<effects::Coordinate> FluidParticipant<D>::position() const {
  // What the first step sets in motion could not limit it.
  if (step_.number == 0 && !fluid_->parameters().time_step) return {};
  const StepLimiter by = fluid_->sizes().limiter(fluid_->state());
  if (!std::isfinite(by.limit)) return {};
  const double size = step_.dt / std::max(1, fluid_->statistics().sub_steps);
  const double rate = rate_of(mesh_, *fluid_, by.cell, by.friction);
  return {{by.friction ? "nu dt/h^2" : "Courant number", size * rate, by.limit * rate,
           by.friction ? "fluid-diffusion" : "fluid-convection"}};
}

template std::vector<effects::Coordinate> FluidParticipant<2>::position() const;
template std::vector<effects::Coordinate> FluidParticipant<3>::position() const;
template void FluidParticipant<2>::see_given_step();
template void FluidParticipant<2>::doubt_given_step(double);
template void FluidParticipant<2>::tell_sub_steps();
template void FluidParticipant<3>::see_given_step();
template void FluidParticipant<3>::doubt_given_step(double);
template void FluidParticipant<3>::tell_sub_steps();

}  // namespace couplet::fluid
