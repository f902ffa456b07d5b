// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {

template <int D>
std::optional<diagnostics::Finding> impossible_temperature(const FluidView<D>& view) {
  const auto& heat = view.parameters().heat;
  if (!heat) return {};
  double lowest = std::numeric_limits<double>::infinity();
  for (const double above : view.fluid.state().heat.temperature)
    lowest = std::min(lowest, heat->reference_temperature + above);
  lowest = parallel::min(view.mesh.comm, lowest);
  if (lowest >= 0) return {};
  return diagnostics::Finding{
      .id = "impossible-temperature",
      .severity = base::Severity::wrong,
      .number = lowest,
      .limit = 0,
      .sentence = fmt::format(
          "the temperature of the fluid falls to {:.4g} K, below absolute zero: more heat is withdrawn than the flow brings; "
          "check the signs and units of fluxes and films",
          lowest)};
}

template std::optional<diagnostics::Finding> impossible_temperature(const FluidView<2>&);
template std::optional<diagnostics::Finding> impossible_temperature(const FluidView<3>&);

}  // namespace couplet::fluid
