// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "fluid_solver/output/fluxes.hpp"
#include "fluid_solver/output/output.hpp"

namespace couplet::fluid {

template <int D>
void FluidOutput<D>::check_flow_areas() const {
  std::vector<std::string> names;
  for (const mesh::Patch& patch : mesh_.patches) names.push_back(patch.name);
  const auto check = [&](const std::string& name, const char* key, const std::string& patch) {
    if (std::ranges::find(names, patch) == names.end())
      throw Error("output.flow-areas.{}.{}: there is no patch '{}'. {}", name, key, patch,
                  base::did_you_mean(patch, names, "patches"));
  };
  for (const auto& [name, area] : fluid_.parameters().output.flow_areas) {
    check(name, "from", area.from);
    check(name, "to", area.to);
  }
}

template <int D>
void FluidOutput<D>::write_flow_areas(double time) {
  const std::vector<PatchFlux<D>> all = patch_fluxes(fluid_);
  if (all.empty() || !root_) return;
  const auto of = [&](const std::string& patch) -> const PatchFlux<D>& {
    return *std::ranges::find(all, patch, &PatchFlux<D>::patch);
  };
  const FluidParameters& p = fluid_.parameters();
  if (!flow_areas_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, unused] : p.output.flow_areas)
      for (const char* what : {"mass flow [kg/s]", "pressure drop [Pa]", "effective area [m^2]"})
        columns.push_back(name + " " + what);
    flow_areas_.emplace(open("flow-areas.csv", columns));
  }
  std::vector<double> row{time};
  for (const auto& [name, area] : p.output.flow_areas) {
    const FlowArea now = flow_area(of(area.from), of(area.to), p.density);
    row.insert(row.end(), {now.mass_flow, now.pressure_drop, now.area});
  }
  flow_areas_->row(row);
}

template void FluidOutput<2>::check_flow_areas() const;
template void FluidOutput<3>::check_flow_areas() const;
template void FluidOutput<2>::write_flow_areas(double);
template void FluidOutput<3>::write_flow_areas(double);

}  // namespace couplet::fluid
