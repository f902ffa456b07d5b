// SPDX-License-Identifier: Apache-2.0
// Diagnostics of the steps: their sizes, flow through openings, ringing pressures.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/fv/expression.hpp"
#include "common/fv/use.hpp"
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
    const EnergyLedger& ledger = view_.fluid.state().ledger;
    return ledger.is_judged() && ledger.excess > shown * ledger.reference;
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

// Minimum share of the volume through an opening in one direction (more than an oscillation), and of the
// volume through the largest opening (more than a trickle).
constexpr double always = 0.9, much = 0.1;
// Inflow at a total pressure is reported if its dynamic pressure exceeds this share of the pressure's range in the run.
constexpr double told_head = 1e-3;

struct Opening {
  const mesh::Patch* patch;
  bool inlet, has_direction, pressure, total;  // pressure: is given; total: as that of inflow
};

/// Weight of the fluid over some openings of one pressure.
struct Weight {
  double area = 0;       ///< [m^2]
  double range = 0;      ///< [Pa]
  std::string pressure;  ///< expression that balances the weight
};

/// Direction of the flow through inlets and outlets. If fluid always left through an inlet or entered through
/// an outlet, a sign or name is wrong. Outlets report fluid that enters at total pressure.
template <int D>
class FlowThroughOpenings final : public diagnostics::Diagnostic {
 public:
  explicit FlowThroughOpenings(const FluidView<D>& view) : view_(view) {
    // A moving wall may draw fluid in through an outlet.
    const bool at_rest = !view.has_mover && !view.is_prescribed && !view.has_interface;
    const auto& waves = view.parameters().compressibility;
    // Fluid may flow back into a volume or line behind the inlets.
    const bool prescribed = !waves || (!(waves->upstream_volume > 0) && !waves->upstream_line);
    for (const mesh::Patch& patch : view.mesh.patches) {
      const BoundaryParameters& b = view.parameters().boundaries.at(patch.name);
      const bool inlet = condition_of(b).passage == Passage::in;
      // A pressure given on purpose may drive the flow.
      const bool outlet = at_rest && gives_pressure(b) && b.pressure.text == "0";
      const bool pressure = gives_pressure(b), total = pressure && b.backflow_stabilisation;
      if (pressure) with_pressure_.push_back(&patch);
      const bool is_closed =
          b.velocity.empty() ? !b.mean_speed || b.mean_speed->text == "0"
                             : std::ranges::all_of(b.velocity, [](const auto& v) { return v.text == "0"; });
      if (inlet && !is_closed)
        fv::uses()["boundaries." + patch.name].given = "the inlet, through which fluid enters,";
      if (inlet || pressure)
        openings_.push_back({&patch, inlet, (inlet && prescribed) || outlet, pressure, total});
    }
    sums_.resize(n_sums * openings_.size());
  }
  void observe(diagnostics::Report&) override {
    const State<D>& s = view_.fluid.state();
    for (std::size_t i = 0; i < openings_.size(); ++i) {
      const mesh::Patch& patch = *openings_[i].patch;
      double* sums = &sums_[n_sums * i];
      const auto use = fv::uses().find("boundaries." + patch.name);
      for (Index f = patch.first; f < patch.first + patch.count; ++f) {
        constexpr double slowest = 1e-12;  // [m/s], round-off
        const double through = std::abs(s.phi[f]) / s.placement->area[f].norm(),
                     given = s.w[f - view_.mesh.n_interior].norm();  // along itself it is a lid
        if (use != fv::uses().end())
          use->second.note(std::max(through, given) > slowest ? std::max(through, given) : 0);
        sums[net] += s.phi[f] * view_.step.dt;
        sums[gross] += std::abs(s.phi[f]) * view_.step.dt;
        const double in = std::max(0., (s.mesh_flux.empty() ? 0 : s.mesh_flux[f]) - s.phi[f]) * view_.step.dt;
        const double speed = in / (view_.step.dt * s.placement->area[f].norm());
        sums[inflow] += in;
        sums[energy] += 0.5 * view_.parameters().density * speed * speed * in;
      }
    }
    if (view_.step.number == 0 || std::ranges::none_of(openings_, &Opening::total)) return;
    const auto pressure = view_.fluid.pressure();
    for (Index c = 0; c < view_.mesh.cells.n_owned(); ++c)
      low_ = std::min(low_, pressure->p[c]), high_ = std::max(high_, pressure->p[c]);
  }
  void conclude(diagnostics::Report& report) override {
    std::vector<double> sums = sums_;
    for (double& value : sums) value = parallel::sum(view_.mesh.comm, value);
    double largest = 0;
    for (std::size_t i = gross; i < sums.size(); i += n_sums) largest = std::max(largest, sums[i]);
    const double range = parallel::max(view_.mesh.comm, high_) - parallel::min(view_.mesh.comm, low_);
    const Weight whole = weight_over(with_pressure_);
    for (std::size_t i = 0; i < openings_.size(); ++i) {
      const auto& [patch, inlet, has_direction, pressure, total] = openings_[i];
      const double* sum = &sums[n_sums * i];
      if (pressure) look_at_weight(report, *patch, sum[gross]);
      const double head = sum[energy] / sum[inflow];
      if (total && range > 0 && sum[inflow] > much * largest && head > told_head * range)
        report.findings.push_back(
            {.id = "inflow-at-total-pressure",
             .severity = base::Severity::note,
             .number = head / range,
             .limit = told_head,
             .sentence = fmt::format(
                 "outlet '{}': where fluid enters, 'pressure' is the total pressure of fluid at rest outside, so that the "
                 "pressure is lower by rho U^2/2, {:.3g} Pa on average, {:.2g} of its range; if it is that in the moving "
                 "fluid, set 'backflow-stabilisation: false'",
                 patch->name, head, head / range),
             .effect = "pressure of inflow",
             .subject = patch->name});
      const double wrong = inlet ? sum[net] : -sum[net];
      const bool falls = pressure && whole.range > 0;
      if ((!has_direction && !falls) || !(wrong > always * sum[gross]) || !(sum[gross] > much * largest))
        continue;
      report.findings.push_back(
          {.id = "flow-through-openings",
           .sentence =
               inlet
                   ? fmt::format("inlet '{}': outflow {:.3g} m^3 (expected: none): implausible; its velocity "
                                 "must point into the domain: check the signs",
                                 patch->name, wrong)
                   : fmt::format(
                         "outlet '{}': inflow {:.3g} m^3 (expected: none): questionable; the velocity "
                         "of inflow through an outlet is undetermined: {}",
                         patch->name, wrong,
                         falls
                             ? fmt::format(
                                   "gravity drives it, {:.3g} Pa of weight between openings of one pressure; of "
                                   "fluid at rest outside, each has 'pressure: {}'",
                                   whole.range, whole.pressure)
                             : "make it an inlet, or prescribe the driving pressure"),
           .subject = patch->name});
    }
  }
  void visit(io::Archive& archive) override {
    archive.sums("volumes", sums_);
    low_ = parallel::min(view_.mesh.comm, low_), high_ = parallel::max(view_.mesh.comm, high_);
    archive.common("pressures", low_, high_);
  }

 private:
  /// Reports one pressure over the height of an opening if the weight exceeds the dynamic pressure: fluid then leaves below and enters
  /// above. `volume`: that passed it in either direction [m^3].
  void look_at_weight(diagnostics::Report& report, const mesh::Patch& patch, double volume) const {
    const Weight weight = weight_over({&patch});
    const double speed = volume / (weight.area * (view_.step.time + view_.step.dt)),
                 dynamic = 0.5 * view_.parameters().density * speed * speed;
    if (!(weight.range > dynamic)) return;
    report.findings.push_back(
        {.id = "weight-over-an-opening",
         .number = weight.range,
         .limit = dynamic,
         .sentence = fmt::format(
             "outlet '{}': one pressure over its height, along which gravity ('body-force') changes that of fluid at "
             "rest by {:.3g} Pa (limit: the dynamic pressure, {:.2g} Pa): it drives fluid out below and in above",
             patch.name, weight.range, dynamic),
         .advice = fmt::format("use 'pressure: {}'", weight.pressure),
         .subject = patch.name});
  }
  /// Empty if the case gives pressures that differ. Collective.
  Weight weight_over(const std::vector<const mesh::Patch*>& patches) const {
    const FluidParameters& p = view_.parameters();
    if (p.body_force.empty() || patches.empty()) return {};
    const config::ExpressionText& text = p.boundaries.at(patches.front()->name).pressure;
    const fv::Expression given(text, "pressure");
    if (given.uses_space() || std::ranges::any_of(patches, [&](const mesh::Patch* patch) {
          return p.boundaries.at(patch->name).pressure.text != text.text;
        }))
      return {};
    const Placement<D>& at = *view_.fluid.state().placement;
    const auto for_faces = [&](const auto& use) {
      for (const mesh::Patch* patch : patches)
        for (Index f = patch->first; f < patch->first + patch->count; ++f)
          use(at.boundary_centre[f - view_.mesh.n_interior], at.area[f].norm());
    };
    std::array<double, 4> sums{};  // area times place, area
    for_faces([&](const Vec3& x, double area) {
      for (int k = 0; k < 3; ++k) sums[k] += area * x[k];
      sums[3] += area;
    });
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, view_.mesh.comm);
    const Vec3 middle = Vec3(sums.data()) / sums[3];
    const double t = view_.step.time + view_.step.dt, level = given(middle, t);
    Vec3 force = Vec3::Zero();  // [N/m^3]
    for (std::size_t k = 0; k < p.body_force.size(); ++k)
      force[Index(k)] = p.density * fv::Expression(p.body_force[k], "body-force")(middle, t);
    double low = 0, high = 0;
    for_faces([&](const Vec3& x, double) {
      low = std::min(low, force.dot(x - middle)), high = std::max(high, force.dot(x - middle));
    });
    Weight found{.area = sums[3],
                 .range = parallel::max(view_.mesh.comm, high) - parallel::min(view_.mesh.comm, low),
                 .pressure = level == 0 ? "" : fmt::format("{:.6g}", level)};
    for (int k = 0; k < D; ++k)
      if (std::abs(force[k]) > 1e-9 * force.norm())
        found.pressure +=
            fmt::format(fmt::runtime(force[k] < 0 ? "{0}{1:.6g}*({2:.4g}-{3})" : "{0}{1:.6g}*({3}-{2:.4g})"),
                        found.pressure.empty() ? "" : " + ", std::abs(force[k]), middle[k], "xyz"[k]);
    return found;
  }
  // Per opening on this rank: volume outward and in either direction, volume that entered through the moving
  // opening [m^3], its kinetic energy [J].
  enum { net, gross, inflow, energy, n_sums };
  FluidView<D> view_;
  std::vector<Opening> openings_;
  std::vector<const mesh::Patch*> with_pressure_;
  std::vector<double> sums_;
  double low_ = std::numeric_limits<double>::max(),
         high_ = std::numeric_limits<double>::lowest();  // pressures [Pa]
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
         .sentence = fmt::format("the pressure rings: {:.2g} of it (limit {:g}) are waves of less than "
                                 "four steps per period, which the trapezoidal rule does not damp",
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
diagnostics::Made flow_through_openings(const FluidView<D>& view) {
  return std::make_shared<FlowThroughOpenings<D>>(view);
}

template diagnostics::Made flow_through_openings(const FluidView<2>&);
template diagnostics::Made flow_through_openings(const FluidView<3>&);

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

}  // namespace couplet::fluid
