// SPDX-License-Identifier: Apache-2.0
// Flow through inlets and outlets.
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
    // Fluid may flow back into a volume behind the inlets.
    const bool prescribed = !waves || !(waves->upstream_volume > 0);
    for (const mesh::Patch& patch : view.mesh.patches) {
      const BoundaryParameters& b = view.parameters().boundaries.at(patch.name);
      const bool inlet = condition_of(b).passage == Passage::in;
      // A pressure given on purpose may drive the flow.
      const bool outlet = at_rest && gives_pressure(b) && b.pressure.text == "0" && b.circuit.count() == 0;
      const bool pressure = gives_pressure(b), total = pressure && b.backflow_stabilisation;
      if (pressure) with_pressure_.push_back(&patch);
      const bool is_closed =
          b.velocity.empty()
              ? (b.mean_speed ? b.mean_speed : b.flow_rate).value_or(config::ExpressionText()).text == "0"
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
        sums[energy] += 0.5 * view_.properties().rho * speed * speed * in;
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
      if (pressure) check_weight(report, *patch, sum[gross]);
      if (inlet && has_direction) check_way(report, *patch, sum[gross], sum[net]);
      const double head = sum[energy] / sum[inflow];
      if (total && range > 0 && sum[inflow] > much * largest && head > told_head * range)
        report.findings.push_back(
            {.id = "flow-through-openings",
             .severity = base::Severity::note,
             .number = head / range,
             .limit = told_head,
             .sentence = fmt::format(
                 "outlet '{}': where fluid enters, 'pressure' is the total pressure of the fluid at rest outside. The "
                 "pressure in the opening is lower by rho U^2/2, on average {:.3g} Pa or {:.2g} % of the range of pressures; "
                 "if 'pressure' is that of the moving fluid, set 'backflow-stabilisation: false'",
                 patch->name, head, 100 * head / range),
             .effect = "pressure of inflow",
             .subject = patch->name + ", inflow"});
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
                                   "gravity drives it, because openings with the same pressure differ by {:.3g} Pa of "
                                   "hydrostatic pressure; for fluid at rest outside, set 'pressure: {}' at each",
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
  /// Reports a flow that hardly enters a domain at rest, as in a mesh in millimeters that is read in meters. `volume`: as below.
  void check_way(diagnostics::Report& report, const mesh::Patch& patch, double volume, double net) const {
    constexpr double least = 0.01;  // of the domain
    if (view_.has_mover || view_.is_prescribed || view_.has_interface || view_.parameters().mesh_scale != 1)
      return;
    // Waves, and a flow that swings, need not cross the domain.
    if (view_.parameters().is_compressible() || std::abs(net) < 0.5 * volume) return;
    double area = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      area += view_.fluid.state().placement->area[f].norm();
    const double way = volume / parallel::sum(view_.mesh.comm, area);
    const Vec3 extent = mesh::extent_of(view_.mesh.comm, view_.fluid.points_at_rest()).size();
    if (!(way > 0) || way > least * extent.maxCoeff()) return;
    report.findings.push_back(
        {.id = "questionable-mesh-scale",
         .number = way / extent.maxCoeff(),
         .limit = least,
         .sentence = fmt::format(
             "inlet '{}': during the whole run the fluid advances by only {:.3g} m into a domain of {:.3g} x {:.3g} x {:.3g} "
             "m: questionable",
             patch.name, way, extent[0], extent[1], extent[2]),
         .advice =
             "if the mesh was drawn in millimeters, set 'mesh-scale: 0.001'; otherwise continue until the flow has crossed the "
             "domain"});
  }
  /// Reports one pressure over the height of an opening if the weight exceeds the dynamic pressure: fluid then leaves below and enters
  /// above. `volume`: that passed it in either direction [m^3].
  void check_weight(diagnostics::Report& report, const mesh::Patch& patch, double volume) const {
    const Weight weight = weight_over({&patch});
    const double speed = volume / (weight.area * (view_.step.time + view_.step.dt)),
                 dynamic = 0.5 * view_.properties().rho * speed * speed;
    if (!(weight.range > dynamic)) return;
    report.findings.push_back(
        {.id = "flow-through-openings",
         .number = weight.range,
         .limit = dynamic,
         .sentence = fmt::format(
             "outlet '{}': the pressure is uniform over its height, over which gravity ('body-force') changes the pressure of "
             "fluid at rest by {:.3g} Pa (limit: the dynamic pressure, {:.2g} Pa): this drives fluid out at the bottom and in "
             "at the top",
             patch.name, weight.range, dynamic),
         .advice = fmt::format("use 'pressure: {}'", weight.pressure),
         .subject = patch.name + ", weight"});
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

}  // namespace

template <int D>
diagnostics::Made flow_through_openings(const FluidView<D>& view) {
  return std::make_shared<FlowThroughOpenings<D>>(view);
}

template diagnostics::Made flow_through_openings(const FluidView<2>&);
template diagnostics::Made flow_through_openings(const FluidView<3>&);

}  // namespace couplet::fluid
