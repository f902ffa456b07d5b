// SPDX-License-Identifier: Apache-2.0
// Diagnostics of the steps: their sizes, ringing pressures, kinetic energy, a mesh at rest.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {

namespace {

// Factor above the limit at which a prescribed step is reported, since the limits are bounds; below, once its disturbances show.
constexpr double far_above = 3, shown = 0.1;
constexpr int steps_between_looks = 10;

/// A prescribed step is used even if it is too long for convection, or for the implicit term on cells with few
/// faces (StepSize). Checked every few steps and at the end, since the limit follows the flow, and reported once.
template <int D>
class GivenStep final : public diagnostics::Diagnostic {
 public:
  explicit GivenStep(const FluidView<D>& view) : view_(view) {}
  void observe(diagnostics::Report& report) override {
    if (++steps_ % steps_between_looks == 1 || grows()) doubt(report);
  }
  void conclude(diagnostics::Report& report) override { doubt(report); }
  void visit(io::Archive& archive) override {
    archive.common("steps", steps_, is_told_, sound_.limit, sound_.cell, sound_.place, sound_.friction,
                   sound_.frame);
  }

 private:
  bool grows() const {
    const EnergySums& ledger = view_.fluid.state().ledger;
    return ledger.is_known() && ledger.excess > shown * ledger.reference;
  }
  void doubt(diagnostics::Report& report) {
    if (is_told_) return;
    // Disturbances that have grown lower the limit.
    const StepLimiter by = grows() && sound_.cell >= 0 ? sound_ : view_.sizes.limiter(view_.fluid.state());
    const double size = view_.step.dt / view_.fluid.statistics().sub_steps;
    if (!grows()) sound_ = by;
    if (!(size > (grows() ? 1 : far_above) * by.limit)) return;
    is_told_ = true;
    report.findings.push_back(
        {.id = "given-step",
         .number = size / by.limit,
         .limit = 1,
         .sentence = fmt::format(
             "time-step: sub-steps of {:.3g} s are {:.1f} times the limit of {} in cell {} at ({:.4g}, {:.4g}, {:.4g}) m: "
             "disturbances of velocity and pressure {} from step to step",
             size, size / by.limit,
             !by.friction                   ? by.cause()
             : view_.fluid.state().implicit ? "an implicit viscous term"
                                            : "an explicit viscous term",
             by.cell, by.place.x(), by.place.y(), by.place.z(), grows() ? "grow" : "may grow"),
         .advice = fmt::format("remove 'time-step', or set at most {:.3g} s", by.limit)});
  }

  FluidView<D> view_;
  long steps_ = 0;
  bool is_told_ = false;
  StepLimiter sound_;  // of the last look without growth; cell -1 before the first
};

/// Courant rate sum |phi - dV/dt|/(2 V) of a cell, or with `friction` sum nu g/(2 D V), which is nu/h^2 of a
/// cube [1/s]. Collective.
template <int D>
double rate_of(const mesh::Mesh& mesh, const Fluid<D>& fluid, GlobalIndex cell, bool friction) {
  const State<D>& s = fluid.state();
  const double nu = fluid.parameters().properties().nu;
  double rate = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const bool inside = f < mesh.n_interior;
    const Index c = mesh.cell_id[mesh.owner[f]] == cell                 ? mesh.owner[f]
                    : inside && mesh.cell_id[mesh.neighbour[f]] == cell ? mesh.neighbour[f]
                                                                        : -1;
    if (c < 0 || c >= mesh.cells.n_owned()) continue;
    const double flux = std::abs(s.phi[f] - (s.mesh_flux.empty() ? 0.0 : s.mesh_flux[f]));
    const double local = nu + (s.excess.empty() ? 0 : s.excess[f]);
    rate += (friction ? local * s.placement->conductance[f] / (2 * D) : flux / 2) / s.placement->volume[c];
  }
  return parallel::sum(mesh.comm, rate);
}

/// Courant number of a step or its sub-steps, or nu dt/h^2 if friction limits it.
template <int D>
class PlaceOnTheMap final : public diagnostics::Diagnostic {
 public:
  explicit PlaceOnTheMap(const FluidView<D>& view) : view_(view) {}
  void look(diagnostics::Report& report) override {
    // The first step could not be limited by the motion that it starts.
    if (view_.step.number == 0 && !view_.parameters().time_step) return;
    const StepLimiter by = view_.sizes.limiter(view_.fluid.state());
    if (by.frame || !std::isfinite(by.limit)) return;
    double size = view_.step.dt / std::max(1, view_.fluid.statistics().sub_steps);
    // Sub-steps that the run chooses follow a limit that fell during the step.
    if (!view_.parameters().time_step) size = std::min(size, by.limit);
    const double rate = rate_of(view_.mesh, view_.fluid, by.cell, by.friction);
    report.position.push_back({by.friction ? "nu dt/h^2" : "Courant number", size * rate, by.limit * rate,
                               by.friction ? "fluid-diffusion" : "fluid-convection"});
  }

 private:
  FluidView<D> view_;
};

constexpr int rung_steps = 10;  // consecutive steps before it is reported

template <int D>
class RingingPressure final : public diagnostics::Diagnostic {
 public:
  explicit RingingPressure(const FluidView<D>& view) : view_(view) {}
  void observe(diagnostics::Report& report) override {
    const double share = ringing_share(view_.mesh, view_.fluid.state());
    steps_ = share > ringing_limit ? steps_ + 1 : 0;
    if (steps_ < rung_steps) return;
    report.findings.push_back(
        {.id = "ringing-pressure",
         .number = share,
         .limit = ringing_limit,
         .sentence = fmt::format(
             "the pressure rings: a fraction {:.2g} of it (limit {:g}) consists of waves with fewer than four steps per "
             "period, which the trapezoidal rule does not damp",
             share, ringing_limit),
         .advice = "use 'scheme: three-level' in 'compressibility', or a shorter step"});
  }
  void visit(io::Archive& archive) override { archive.common("steps", steps_); }

 private:
  FluidView<D> view_;
  int steps_ = 0;  // in a row
};

}  // namespace

template <int D>
diagnostics::Made given_step(const FluidView<D>& view) {
  return view.parameters().time_step ? std::make_shared<GivenStep<D>>(view) : nullptr;
}
template <int D>
diagnostics::Made place_on_the_map(const FluidView<D>& view) {
  return std::make_shared<PlaceOnTheMap<D>>(view);
}

template diagnostics::Made given_step(const FluidView<2>&);
template diagnostics::Made given_step(const FluidView<3>&);
template diagnostics::Made place_on_the_map(const FluidView<2>&);
template diagnostics::Made place_on_the_map(const FluidView<3>&);

template <int D>
double ringing_share(const mesh::Mesh& mesh, const State<D>& s) {
  if (!s.pressure[2]) return 0;
  const std::vector<double>&p0 = s.pressure[0]->p, &p1 = s.pressure[1]->p, &p2 = s.pressure[2]->p;
  double sums[3] = {};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double v = s.placement->volume[c], turn = p0[c] - 2 * p1[c] + p2[c], change = p0[c] - p2[c];
    sums[0] += v * turn * turn, sums[1] += v * change * change, sums[2] += v * p0[c] * p0[c];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sums[0] > sums[1] && sums[2] > 0 ? std::sqrt(sums[0] / sums[2]) / 4 : 0;
}

template <int D>
diagnostics::Made ringing_pressure(const FluidView<D>& view) {
  const auto& known = view.parameters().compressibility;
  if (!known || known->scheme != WaveScheme::trapezoidal) return nullptr;
  return std::make_shared<RingingPressure<D>>(view);
}

template double ringing_share(const mesh::Mesh&, const State<2>&);
template double ringing_share(const mesh::Mesh&, const State<3>&);
template diagnostics::Made ringing_pressure(const FluidView<2>&);
template diagnostics::Made ringing_pressure(const FluidView<3>&);

// The guard stops fast growth; this reports slow growth.
template <int D>
std::optional<diagnostics::Finding> kinetic_energy(const FluidView<D>& view) {
  const EnergySums& ledger = view.fluid.state().ledger;
  if (!ledger.is_known()) return {};
  const double excess = ledger.excess / ledger.reference;
  return diagnostics::finding_of(
      {.effect = "balance of the kinetic energy",
       .id = "energy-growth",
       .number = excess,
       .limit = 0.1,
       .what =
           fmt::format("kinetic energy not supplied by boundaries or forces = {:.2g} of the total", excess),
       .advice =
           "the numerical schemes create this energy. To find out which scheme does, repeat the run with half the step and "
           "without the fluid's 'time-step', and again with a finer mesh",
       .left_out = false,
       .wrong_from = 0.5});
}

template <int D>
std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<D>& view) {
  if (view.fluid.moving() || !view.stands_still()) return {};
  // A wall that moves by d changes the resistance of a channel of height H by 3 d/H; half of it with six cells over H.
  return diagnostics::finding_of(
      {.effect = "mesh motion",
       .number = view.wall_displacement,
       .what =
           fmt::format("max interface displacement / adjacent cell height = {:.2g}", view.wall_displacement),
       .advice = "add a mesh mover: 'coupling: {mesh: {participant: ...}}'",
       .share = std::min(1., 0.5 * view.wall_displacement)});
}

template std::optional<diagnostics::Finding> kinetic_energy(const FluidView<2>&);
template std::optional<diagnostics::Finding> kinetic_energy(const FluidView<3>&);
template std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<2>&);
template std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<3>&);

}  // namespace couplet::fluid
