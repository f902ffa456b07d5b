// SPDX-License-Identifier: Apache-2.0
// Step sizes relative to their limits, and the guess of a semi-implicit step.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {
namespace {

// Factor above the limit at which a prescribed step certainly fails.
constexpr double far_above = 2;
constexpr int steps_between_looks = 10;
// Error of the friction at the end of a step, relative to the load; a growing oscillation reaches it.
constexpr double near_limit = 0.1;

/// A prescribed step is used even if it is too long for the implicit term on cells with few faces (StepSize).
/// Checked at each new longest step; with a varying limit (moving cells, eddy viscosity) also every few steps
/// and at the end.
template <int D>
class GivenStep final : public diagnostics::Diagnostic {
 public:
  explicit GivenStep(const FluidView<D>& view) : view_(view) {}
  void observe(diagnostics::Report& report) override {
    if (!view_.fluid.state().implicit) return;
    if (view_.fluid.moving() || view_.parameters().turbulence) ++steps_unseen_;
    if (size() <= longest_ && steps_unseen_ < steps_between_looks) return;
    longest_ = std::max(longest_, size());
    doubt(report);
  }
  void conclude(diagnostics::Report& report) override {
    if (steps_unseen_ > 0) doubt(report);
  }
  void visit(io::Archive& archive) override { archive.common("steps", longest_, steps_unseen_); }

 private:
  double size() const { return view_.step.dt / view_.fluid.statistics().sub_steps; }
  void doubt(diagnostics::Report& report) {
    steps_unseen_ = 0;
    const StepLimiter by = view_.sizes.limiter(view_.fluid.state());
    if (!by.friction || size() <= far_above * by.limit) return;
    report.findings.push_back(
        {.id = "given-step",
         .number = size() / by.limit,
         .limit = far_above,
         .sentence = fmt::format(
             "time-step: sub-steps of {:.3g} s are {:.1f} times the limit of an implicit viscous term in cell {} at "
             "({:.4g}, {:.4g}, {:.4g}) m: pressures and forces grow spuriously",
             size(), size() / by.limit, by.cell, by.place.x(), by.place.y(), by.place.z()),
         .advice = fmt::format("remove 'time-step', or set at most {:.3g} s", by.limit)});
  }

  FluidView<D> view_;
  double longest_ = 0;    // of the given sub-steps seen [s]
  int steps_unseen_ = 0;  // whose limit may have changed
};

/// Number of friction renewals in the semi-implicit scheme, and the resulting error.
template <int D>
class FrictionOfTheGuess final : public diagnostics::Diagnostic {
 public:
  explicit FrictionOfTheGuess(const FluidView<D>& view) : view_(view) {}
  void observe(diagnostics::Report&) override {
    if (view_.step.scheme != coupling::Scheme::semi_implicit) return;
    ++steps_;
    renewed_ += view_.renewals > 0 ? 1 : 0;
    largest_ = std::max(largest_, view_.unseen_share);
  }
  void conclude(diagnostics::Report& report) override {
    if (steps_ == 0) return;
    const bool is_far = largest_ < near_limit || view_.step.scheme != coupling::Scheme::semi_implicit;
    report.sentences.push_back(fmt::format(
        "Semi-implicit coupling: the friction was recomputed with an updated wall velocity in {} of {} "
        "steps; max error at the end of a step {:.2g} of the load{}",
        renewed_, steps_, largest_,
        is_far ? "."
               : ": the scheme is near its limit, where friction drags more than a third of the moving mass; "
                 "use 'scheme: implicit' or a smaller step."));
  }
  void visit(io::Archive& archive) override { archive.common("steps", steps_, renewed_, largest_); }

 private:
  FluidView<D> view_;
  long steps_ = 0, renewed_ = 0;
  double largest_ = 0;
};

/// Courant rate sum |phi - dV/dt|/(2 V) of a cell, or with `friction` sum nu g/(2 D V), which is nu/h^2 of a
/// cube [1/s]. Collective.
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

/// Courant number of a step or its sub-steps, or nu dt/h^2 if friction limits it.
template <int D>
class PlaceOnTheMap final : public diagnostics::Diagnostic {
 public:
  explicit PlaceOnTheMap(const FluidView<D>& view) : view_(view) {}
  void look(diagnostics::Report& report) override {
    // The first step could not be limited by the motion that it starts.
    if (view_.step.number == 0 && !view_.parameters().time_step) return;
    const StepLimiter by = view_.sizes.limiter(view_.fluid.state());
    if (!std::isfinite(by.limit)) return;
    const double size = view_.step.dt / std::max(1, view_.fluid.statistics().sub_steps);
    const double rate = rate_of(view_.mesh, view_.fluid, by.cell, by.friction);
    report.position.push_back({by.friction ? "nu dt/h^2" : "Courant number", size * rate, by.limit * rate,
                               by.friction ? "fluid-diffusion" : "fluid-convection"});
  }

 private:
  FluidView<D> view_;
};

}  // namespace

template <int D>
diagnostics::Made given_step(const FluidView<D>& view) {
  return view.parameters().time_step ? std::make_shared<GivenStep<D>>(view) : nullptr;
}
template <int D>
diagnostics::Made friction_of_the_guess(const FluidView<D>& view) {
  return std::make_shared<FrictionOfTheGuess<D>>(view);
}
template <int D>
diagnostics::Made place_on_the_map(const FluidView<D>& view) {
  return std::make_shared<PlaceOnTheMap<D>>(view);
}

template diagnostics::Made given_step(const FluidView<2>&);
template diagnostics::Made given_step(const FluidView<3>&);
template diagnostics::Made friction_of_the_guess(const FluidView<2>&);
template diagnostics::Made friction_of_the_guess(const FluidView<3>&);
template diagnostics::Made place_on_the_map(const FluidView<2>&);
template diagnostics::Made place_on_the_map(const FluidView<3>&);

}  // namespace couplet::fluid
