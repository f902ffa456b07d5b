// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/fv/use.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {
namespace {

// Minimum share of the volume through an opening in one direction (more than an oscillation), and of the
// volume through the largest opening (more than a trickle).
constexpr double always = 0.9, much = 0.1;
// Head of inflow at a total pressure over the range of the pressure in the run, from which it is told.
constexpr double told_head = 1e-3;

/// Direction of the flow through inlets and outlets. If fluid always left through an inlet or entered through
/// an outlet, a sign or name is wrong. Outlets report fluid that enters at total pressure.
template <int D>
class FlowThroughOpenings final : public diagnostics::Diagnostic {
 public:
  explicit FlowThroughOpenings(const FluidView<D>& view) : view_(view) {
    // A moving wall may draw fluid in through an outlet.
    const bool at_rest = !view.has_mover && !view.is_prescribed && !view.has_interface;
    for (const mesh::Patch& patch : view.mesh.patches) {
      const BoundaryParameters& b = view.parameters().boundaries.at(patch.name);
      const bool inlet = condition_of(b).passage == Passage::in;
      // A pressure given on purpose may drive the flow.
      const bool outlet = at_rest && gives_pressure(b) && b.pressure.text == "0";
      const bool total = gives_pressure(b) && b.backflow_stabilisation;
      const bool is_closed =
          b.velocity.empty() ? !b.mean_speed || b.mean_speed->text == "0"
                             : std::ranges::all_of(b.velocity, [](const auto& v) { return v.text == "0"; });
      if (inlet && !is_closed)
        fv::uses()["boundaries." + patch.name].given = "the inlet, through which fluid enters,";
      if (inlet || outlet || total) openings_.push_back({&patch, inlet, inlet || outlet, total});
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
    for (std::size_t i = 0; i < openings_.size(); ++i) {
      const auto& [patch, inlet, has_direction, total] = openings_[i];
      const double* sum = &sums[n_sums * i];
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
      if (!has_direction || !(wrong > always * sum[gross]) || !(sum[gross] > much * largest)) continue;
      report.findings.push_back(
          {.id = "flow-through-openings",
           .sentence =
               inlet
                   ? fmt::format("inlet '{}': outflow {:.3g} m^3 (expected: none): implausible; its velocity "
                                 "must point into the domain: check the signs",
                                 patch->name, wrong)
                   : fmt::format(
                         "outlet '{}': inflow {:.3g} m^3 (expected: none): questionable; the velocity "
                         "of inflow through an outlet is undetermined: make it an inlet, or prescribe "
                         "the driving pressure",
                         patch->name, wrong),
           .subject = patch->name});
    }
  }
  void visit(io::Archive& archive) override {
    archive.sums("volumes", sums_);
    low_ = parallel::min(view_.mesh.comm, low_), high_ = parallel::max(view_.mesh.comm, high_);
    archive.common("pressures", low_, high_);
  }

 private:
  struct Opening {
    const mesh::Patch* patch;
    bool inlet, has_direction, total;  // total: takes the total pressure of inflow
  };
  // Per opening on this rank: volume outward and in either direction, volume that entered through the moving
  // opening [m^3], its kinetic energy [J].
  enum { net, gross, inflow, energy, n_sums };
  FluidView<D> view_;
  std::vector<Opening> openings_;
  std::vector<double> sums_;
  double low_ = std::numeric_limits<double>::max(),
         high_ = std::numeric_limits<double>::lowest();  // pressures [Pa]
};

}  // namespace

template <int D>
diagnostics::Made flow_through_openings(const FluidView<D>& view) {
  return std::make_shared<FlowThroughOpenings<D>>(view);
}

template diagnostics::Made flow_through_openings(const FluidView<2>&);
template diagnostics::Made flow_through_openings(const FluidView<3>&);

}  // namespace couplet::fluid
