// SPDX-License-Identifier: Apache-2.0
// Walls that move on a mesh at rest, and gaps that block the flow.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {
namespace {

/// Largest sum |w . S| / sum |w| |S| of the moving walls of a fixed mesh; NaN without motion. Collective.
template <int D>
double through_moving_walls(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const mesh::Patch& patch : mesh.patches) {
    if (!is_moving_wall(fluid.parameters().boundaries.at(patch.name))) continue;
    double through = 0, size = 0;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec<D>& w = s.w[f - mesh.n_interior];
      through += std::abs(w.dot(s.placement->area[f]));
      size += w.norm() * s.placement->area[f].norm();
    }
    through = parallel::sum(mesh.comm, through), size = parallel::sum(mesh.comm, size);
    if (size > 0) worst = std::isnan(worst) ? through / size : std::max(worst, through / size);
  }
  return worst;
}

}  // namespace

template <int D>
std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<D>& view) {
  if (view.fluid.moving() || !view.stands_still()) return {};
  return diagnostics::finding_of(
      {.effect = "mesh motion",
       .number = view.wall_displacement,
       .limit = 0.1,
       .what =
           fmt::format("max interface displacement / adjacent cell height = {:.2g}", view.wall_displacement),
       .advice = "add a mesh mover: 'coupling: {mesh: {participant: ...}}'"});
}

// A wall with normal motion on a mesh at rest acts as an inlet.
template <int D>
std::optional<diagnostics::Finding> walls_along_themselves(const FluidView<D>& view) {
  bool has_moving_wall = false;
  for (const auto& [name, b] : view.parameters().boundaries) has_moving_wall |= is_moving_wall(b);
  if (view.fluid.moving() || !has_moving_wall) return {};
  const double through = through_moving_walls(view.fluid);
  return diagnostics::finding_of(
      {.effect = "walls that move along themselves",
       .number = through,
       .limit = 0.1,
       .what = fmt::format("a moving wall has a normal velocity of {:.2g} times its speed", through),
       .advice =
           "its mesh is at rest, so fluid crosses the wall: use a tangential velocity, make it an inlet, "
           "or move it with 'motion'",
       .left_out = false});
}

template <int D>
std::optional<diagnostics::Finding> blocked_cells(const FluidView<D>& view) {
  if (!view.fluid.gaps()) return {};
  double blocked = 0;
  for (const auto& gap : view.fluid.gaps()->facts()) blocked += gap.cells;
  blocked /= double(view.mesh.cells.n_global());
  return diagnostics::finding_of({.effect = "gaps that close",
                                  .number = blocked,
                                  .limit = 0.5,
                                  .what = fmt::format("blocked by gaps: {:.2g} of all cells", blocked),
                                  .advice = "is 'opening' in meters, and smaller than the channel?",
                                  .left_out = false});
}

// The guard stops fast growth; this reports slow growth.
template <int D>
std::optional<diagnostics::Finding> kinetic_energy(const FluidView<D>& view) {
  const EnergyLedger& ledger = view.fluid.state().ledger;
  if (!ledger.is_judged()) return {};
  const double excess = ledger.excess / ledger.reference;
  return diagnostics::finding_of(
      {.effect = "balance of the kinetic energy",
       .number = excess,
       .limit = 0.1,
       .what =
           fmt::format("kinetic energy without work of boundaries or forces = {:.2g} of the total", excess),
       .advice = "the time scheme generates it: remove 'time-step' or reduce it",
       .left_out = false,
       .wrong_from = 0.5});
}

template std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<2>&);
template std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<3>&);
template std::optional<diagnostics::Finding> walls_along_themselves(const FluidView<2>&);
template std::optional<diagnostics::Finding> walls_along_themselves(const FluidView<3>&);
template std::optional<diagnostics::Finding> blocked_cells(const FluidView<2>&);
template std::optional<diagnostics::Finding> blocked_cells(const FluidView<3>&);
template std::optional<diagnostics::Finding> kinetic_energy(const FluidView<2>&);
template std::optional<diagnostics::Finding> kinetic_energy(const FluidView<3>&);

}  // namespace couplet::fluid
