// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {
namespace {

using diagnostics::When;
template <int D>
using FluidRow = diagnostics::TableRow<FluidView<D>>;

/// Diagnostic without memory: what a function finds in the accepted state.
template <int D>
class Finds final : public diagnostics::Diagnostic {
 public:
  using Function = std::optional<diagnostics::Finding> (*)(const FluidView<D>&);
  Finds(const FluidView<D>& view, Function function) : view_(view), function_(function) {}
  void look(diagnostics::Report& report) override {
    if (auto finding = function_(view_)) report.findings.push_back(std::move(*finding));
  }

 private:
  FluidView<D> view_;
  Function function_;
};

template <int D, typename Finds<D>::Function function>
diagnostics::Made finds(const FluidView<D>& view) {
  return std::make_shared<Finds<D>>(view, function);
}

template <int D>
constexpr std::array table{
    FluidRow<D>{"turbulence-model", When::always, finds<D, turbulence_model<D>>},
    FluidRow<D>{"eddies-in-two-dimensions", When::always, finds<D, eddies_in_two_dimensions<D>>},
    FluidRow<D>{"viscosity-law", When::always, finds<D, variation_of_viscosity<D>>},
    FluidRow<D>{"impossible-temperature", When::always, finds<D, impossible_temperature<D>>},
    FluidRow<D>{"resolved-walls", When::always, finds<D, resolved_walls<D>>},
    FluidRow<D>{"kinetic-energy", When::always, finds<D, kinetic_energy<D>>},
    FluidRow<D>{"compressibility", When::always, finds<D, compressibility<D>>},
    FluidRow<D>{"changes-of-density", When::always, finds<D, changes_of_density<D>>},
    FluidRow<D>{"mesh-at-rest", When::always, finds<D, mesh_at_rest<D>>},
    FluidRow<D>{"waves-of-pressure", When::always, waves_of_pressure<D>},
    FluidRow<D>{"ringing-pressure", When::always, ringing_pressure<D>},
    FluidRow<D>{"given-step", When::always, given_step<D>},
    FluidRow<D>{"flow-through-openings", When::always, flow_through_openings<D>},
    FluidRow<D>{"place-on-the-map", When::always, place_on_the_map<D>},
    FluidRow<D>{"flow-error", When::with_errors, flow_error<D>}};

}  // namespace

template <int D>
void add_diagnostics(const FluidView<D>& view, diagnostics::Diagnostics& all) {
  all.add(std::span<const FluidRow<D>>(table<D>), view);
}

template <int D>
std::vector<Index> moving_faces(const FluidView<D>& view) {
  std::vector<Index> faces;
  for (const mesh::Patch& patch : view.mesh.patches) {
    const FlowCondition& condition = condition_of(view.parameters().boundaries.at(patch.name));
    const GivenBy by = condition.velocity;
    if (by != GivenBy::structure && by != GivenBy::motion &&
        !(view.is_prescribed && condition.passage == Passage::none))
      continue;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) faces.push_back(f);
  }
  return faces;
}

template <int D>
double largest_speed(const FluidView<D>& view) {
  double square = 0;
  for (const Vec<D>& u : view.fluid.state().u) square = std::max(square, u.squaredNorm());
  return std::sqrt(parallel::max(view.mesh.comm, square));
}

template <int D>
std::optional<double> pressure_range(const FluidView<D>& view) {
  const auto latest = view.fluid.pressure();
  if (!latest || view.step.number == 0) return {};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (Index c = 0; c < view.mesh.cells.n_owned(); ++c)
    low = std::min(low, latest->p[c]), high = std::max(high, latest->p[c]);
  return parallel::max(view.mesh.comm, high) - parallel::min(view.mesh.comm, low);
}

template void add_diagnostics(const FluidView<2>&, diagnostics::Diagnostics&);
template void add_diagnostics(const FluidView<3>&, diagnostics::Diagnostics&);
template std::vector<Index> moving_faces(const FluidView<2>&);
template std::vector<Index> moving_faces(const FluidView<3>&);
template double largest_speed(const FluidView<2>&);
template double largest_speed(const FluidView<3>&);
template std::optional<double> pressure_range(const FluidView<2>&);
template std::optional<double> pressure_range(const FluidView<3>&);

}  // namespace couplet::fluid
