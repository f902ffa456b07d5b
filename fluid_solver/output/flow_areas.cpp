// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/error.hpp"
#include "fluid_solver/output/fluxes.hpp"
#include "fluid_solver/output/output.hpp"

namespace couplet::fluid {

template <int D>
void FluidOutput<D>::write_flow_areas(double time) {
  const std::vector<PatchFlux<D>> all = patch_fluxes(fluid_);
  if (all.empty()) return;
  const auto of = [&](const std::string& patch) -> const PatchFlux<D>& {
    const auto found = std::ranges::find(all, patch, &PatchFlux<D>::patch);
    if (found == all.end()) throw Error("output.flow-areas: the mesh has no faces in the patch '{}'.", patch);
    return *found;
  };
  const FluidParameters& p = fluid_.parameters();
  std::vector<double> row{time};
  for (const auto& [name, area] : p.output.flow_areas) {
    const FlowArea now = flow_area(of(area.from), of(area.to), p.density);
    row.insert(row.end(), {now.mass_flow, now.pressure_drop, now.area});
  }
  if (!root_) return;
  if (!flow_areas_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, unused] : p.output.flow_areas)
      for (const char* what : {"mass flow [kg/s]", "pressure drop [Pa]", "effective area [m^2]"})
        columns.push_back(name + " " + what);
    flow_areas_.emplace(open("flow-areas.csv", columns));
  }
  flow_areas_->row(row);
}

template void FluidOutput<2>::write_flow_areas(double);
template void FluidOutput<3>::write_flow_areas(double);

}  // namespace couplet::fluid
