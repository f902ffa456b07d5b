// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {

// Findings of the accepted state, each in the file of its subject; nothing where they do not apply.
template <int D>
using Look = std::optional<diagnostics::Finding>(const FluidView<D>&);
template <int D>
Look<D> turbulence_model;
template <int D>
Look<D> eddies_in_two_dimensions;
template <int D>
Look<D> resolved_walls;
template <int D>
Look<D> kinetic_energy;
template <int D>
Look<D> compressibility;
template <int D>
Look<D> changes_of_density;
template <int D>
Look<D> mesh_at_rest;
template <int D>
Look<D> blocked_cells;
template <int D>
Look<D> walls_along_themselves;

// Diagnostics with memory; nullptr where they do not apply.
template <int D>
using Make = std::shared_ptr<diagnostics::Diagnostic>(const FluidView<D>&);
template <int D>
Make<D> waves_of_pressure;
template <int D>
Make<D> ringing_pressure;
template <int D>
Make<D> given_step;
template <int D>
Make<D> flow_through_openings;
template <int D>
Make<D> friction_of_the_guess;
template <int D>
Make<D> place_on_the_map;
template <int D>
Make<D> flow_error;

template <int D>
void add_diagnostics(const FluidView<D>& view, diagnostics::Diagnostics& all) {
  const std::pair<const char*, Look<D>*> looks[] = {{"turbulence-model", turbulence_model<D>},
                                                    {"eddies-in-two-dimensions", eddies_in_two_dimensions<D>},
                                                    {"resolved-walls", resolved_walls<D>},
                                                    {"kinetic-energy", kinetic_energy<D>},
                                                    {"compressibility", compressibility<D>},
                                                    {"changes-of-density", changes_of_density<D>},
                                                    {"mesh-at-rest", mesh_at_rest<D>},
                                                    {"blocked-cells", blocked_cells<D>},
                                                    {"walls-along-themselves", walls_along_themselves<D>}};
  const std::pair<const char*, Make<D>*> makes[] = {
      {"waves-of-pressure", waves_of_pressure<D>},
      {"ringing-pressure", ringing_pressure<D>},
      {"given-step", given_step<D>},
      {"flow-through-openings", flow_through_openings<D>},
      {"friction-of-the-guess", friction_of_the_guess<D>},
      {"place-on-the-map", place_on_the_map<D>},
      {"flow-error", all.with_errors() ? flow_error<D> : nullptr}};
  for (const auto& [name, look] : looks) all.add(name, std::make_shared<Finds<D>>(view, look));
  for (const auto& [name, make] : makes)
    if (auto one = make ? make(view) : nullptr) all.add(name, std::move(one));
}

template <int D>
std::vector<Index> moving_faces(const FluidView<D>& view) {
  std::vector<Index> faces;
  for (const mesh::Patch& patch : view.mesh.patches) {
    const GivenBy by = condition_of(view.parameters().boundaries.at(patch.name)).velocity;
    if (by != GivenBy::structure && by != GivenBy::motion) continue;
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
