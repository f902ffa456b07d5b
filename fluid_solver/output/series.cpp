// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/processor_clones.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

namespace {

using WallPatches = std::vector<const mesh::Patch*>;

/// Adds the components of a vector.
template <int D>
void add_to_row(Row& row, const std::string& name, const char* unit, const double* values) {
  for (int c = 0; c < D; ++c)
    row.emplace_back(fmt::format("{} {} [{}]", name, base::axis_letters[c], unit), values[c]);
}

/// Forces of the fluid on each wall, means over the coupling step.
template <int D>
Row forces(const Fluid<D>& fluid, const WallPatches& walls) {
  const mesh::Mesh& mesh = fluid.mesh();
  std::vector<Vec<D>> totals;  // pressure, friction of each wall
  for (const mesh::Patch* patch : walls)
    for (const Vectors<D>* force : {&fluid.pressure_force(), &fluid.viscous_force()}) {
      totals.push_back(Vec<D>::Zero());
      for (Index f = patch->first; !force->empty() && f < patch->first + patch->count; ++f)
        totals.back() += (*force)[f - mesh.n_interior];
    }
  const std::span<double> sums = flat<D>(totals);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  Row row;
  for (std::size_t i = 0; i < walls.size(); ++i) {
    add_to_row<D>(row, walls[i]->name + " pressure", "N", totals[2 * i].data());
    add_to_row<D>(row, walls[i]->name + " viscous", "N", totals[2 * i + 1].data());
  }
  return row;
}

template <int D>
Row coefficients(const Fluid<D>& fluid) {
  Row row;
  for (const auto& [name, parameters] : fluid.parameters().output.coefficients) {
    const ForceCoefficients c = force_coefficients(fluid, parameters);
    row.insert(
        row.end(),
        {{name + " drag [-]", c.drag}, {name + " lift [-]", c.lift}, {name + " moment [-]", c.moment}});
  }
  return row;
}

template <int D>
Row wall_layers(const Fluid<D>& fluid, const WallPatches& walls) {
  Row row;
  for (const mesh::Patch* patch : walls) {
    const WallSummary w = summarise_wall(fluid, *patch);
    row.insert(row.end(), {{patch->name + " mean shear [Pa]", w.mean_shear},
                           {patch->name + " largest shear [Pa]", w.largest_shear},
                           {patch->name + " mean y+ [-]", w.mean_yplus},
                           {patch->name + " largest y+ [-]", w.largest_yplus}});
  }
  return row;
}

/// Fluxes through a patch out of the fluid, relative to a moving patch, at the accepted time. Loads are means
/// over the last step as in forces.csv. In a steady flow without body forces, volumes and momenta of all
/// patches sum to zero.
template <int D>
struct PatchFlux {
  std::string patch;
  double volume = 0;                 ///< [m^3/s]
  Vec<D> momentum = Vec<D>::Zero();  ///< rho sum u phi plus the load on what is outside [N]
  double pressure = 0;               ///< mean over the area [Pa]
};

/// Returns the fluxes of all patches with faces; none before the first step. Collective.
template <int D>
std::vector<PatchFlux<D>> patch_fluxes(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  const auto pressure = fluid.pressure();
  // A rank may have no face at the boundary.
  if (!pressure || !parallel::any(mesh.comm, !fluid.pressure_force().empty())) return {};
  constexpr int width = 3 + D;
  std::vector<std::array<double, width>> sums(mesh.patches.size());  // area, volume, p S, momentum
  for (std::size_t p = 0; p < sums.size(); ++p) {
    const mesh::Patch& patch = mesh.patches[p];
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index b = f - mesh.n_interior;
      const double flux = s.mesh_flux.empty() ? s.phi[f] : s.phi[f] - s.mesh_flux[f];
      const double area = s.placement->area[f].norm();
      sums[p][0] += area;
      sums[p][1] += flux;
      sums[p][2] += area * pressure->boundary[b];
      Eigen::Map<Vec<D>>(&sums[p][3]) += fluid.properties().rho * flux * s.u_boundary[b] +
                                         fluid.pressure_force()[b] + fluid.viscous_force()[b];
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()) * width, MPI_DOUBLE, MPI_SUM,
                mesh.comm);
  std::vector<PatchFlux<D>> result;
  for (std::size_t p = 0; p < sums.size(); ++p)
    if (const auto& sum = sums[p]; sum[0] > 0)
      result.push_back({mesh.patches[p].name, sum[1], Eigen::Map<const Vec<D>>(&sum[3]), sum[2] / sum[0]});
  return result;
}

template <int D>
Row fluxes(const Fluid<D>& fluid) {
  Row row;
  for (const PatchFlux<D>& flux : patch_fluxes(fluid)) {
    row.emplace_back(flux.patch + " volume [m^3/s]", flux.volume);
    add_to_row<D>(row, flux.patch + " momentum", "N", flux.momentum.data());
    row.emplace_back(flux.patch + " mean pressure [Pa]", flux.pressure);
  }
  return row;
}

/// Area in which an ideal flow has the same mass flow and pressure difference, (KA)_e in [thesis] eq. (4.35).
/// Negative for flow against the pressure, NaN without a difference.
template <int D>
Row flow_areas(const Fluid<D>& fluid) {
  Row row;
  const double density = fluid.properties().rho;
  const std::vector<PatchFlux<D>> all = patch_fluxes(fluid);
  if (all.empty()) return row;
  const auto of = [&](const std::string& patch) -> const PatchFlux<D>& {
    const auto found = std::ranges::find(all, patch, &PatchFlux<D>::patch);
    if (found == all.end()) throw Error("output.flow-areas: the mesh has no faces in the patch '{}'.", patch);
    return *found;
  };
  for (const auto& [name, area] : fluid.parameters().output.flow_areas) {
    const PatchFlux<D>& from = of(area.from);
    const double mass = -density * from.volume, drop = from.pressure - of(area.to).pressure;
    const double ideal = mass / std::sqrt(2 * density * std::abs(drop)) * (drop < 0 ? -1 : 1);
    row.insert(row.end(), {{name + " mass flow [kg/s]", mass},
                           {name + " pressure drop [Pa]", drop},
                           {name + " effective area [m^2]",
                            drop != 0 ? ideal : std::numeric_limits<double>::quiet_NaN()}});
  }
  return row;
}

struct CellSums {
  double divergence = 0, volume = 0, squares = 0;  ///< |sum phi|, V, V |u|^2
  double worst = 0;                                ///< largest |sum phi| / V
};

template <int D>
COUPLET_PROCESSOR_CLONES CellSums sum_cells(std::span<const double> volume, const double* outflow,
                                            const Vec<D>* u) {
  CellSums sums;
  for (std::size_t c = 0; c < volume.size(); ++c) {
    const double out = std::abs(outflow[c]);
    sums.divergence += out;
    sums.volume += volume[c];
    sums.squares += volume[c] * u[c].squaredNorm();
    if (out > sums.worst * volume[c]) sums.worst = out / volume[c];
  }
  return sums;
}

/// Pressure and flow of each lumped end. The pressure of an outlet is its mean over the area.
template <int D>
void add_ends(const Fluid<D>& fluid, Row& row) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  const std::vector<LumpedEnd>& ends = fluid.boundary().ends();
  if (ends.empty()) return;
  const auto pressure = fluid.pressure();
  for (std::size_t i = 0; i < ends.size(); ++i) {
    double sums[3] = {};  // flow out of the fluid, area, area times pressure
    for (const auto& [first, count] : ends[i].faces)
      for (Index b = first; b < first + count; ++b) {
        const Index f = mesh.n_interior + b;
        const double area = s.placement->area[f].norm();
        sums[0] += s.phi[f];
        sums[1] += area;
        if (pressure) sums[2] += area * pressure->boundary[b];
      }
    MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
    if (ends[i].volume > 0) {
      row.emplace_back("pressure upstream [Pa]", s.pressure[0] ? s.pressure[0]->ends[i] : 0);
      row.emplace_back("flow from upstream [m^3/s]", -sums[0]);
      continue;
    }
    row.emplace_back(ends[i].name + " pressure [Pa]", sums[2] / sums[1]);
    row.emplace_back(ends[i].name + " flow [m^3/s]", s.circuits.flow[i]);
    if (ends[i].circuit.windkessel)
      row.emplace_back(ends[i].name + " compliance pressure [Pa]", s.circuits.stored[i]);
  }
}

/// Volume, energy and divergence.
template <int D>
Row balance(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  const std::span<const double> volumes = std::span(s.placement->volume).first(mesh.cells.n_owned());
  enum { inflow, outflow, volume, energy, divergence, taken_up };
  double sums[6] = {};
  std::vector<double> out(mesh.cells.n_local(), 0.0);
  add_outflow(mesh, s.phi, out);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    (s.phi[f] < 0 ? sums[inflow] : sums[outflow]) += std::abs(s.phi[f]);
  if (s.blocked)  // held by their gaps as a whole
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      if ((*s.blocked)[c]) out[c] = 0;
  const CellSums over_cells = sum_cells<D>(volumes, out.data(), s.u.data());
  sums[divergence] = over_cells.divergence, sums[volume] = over_cells.volume;
  sums[energy] = 0.5 * fluid.properties().rho * over_cells.squares;
  if (s.pressure[0]) sums[taken_up] = s.pressure[0]->taken_up;
  MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, mesh.comm);
  const double worst = parallel::max(mesh.comm, over_cells.worst);
  Row row{{"inflow [m^3/s]", sums[inflow]},
          {"outflow [m^3/s]", sums[outflow]},
          {"volume [m^3]", sums[volume]},
          {"kinetic energy [J]", sums[energy]},
          {"largest divergence [1/s]", worst},
          {"mean divergence [1/s]", sums[divergence] / sums[volume]},
          {"mass defect [m^3/s]", sums[outflow] - sums[inflow] + sums[taken_up]},
          {"sub-steps [-]", double(fluid.statistics().sub_steps)}};
  add_ends(fluid, row);
  return row;
}

template <int D>
Row energies(const Fluid<D>& fluid) {
  const EnergyBudget e = energy_budget(fluid);
  return {{"kinetic energy [J]", e.kinetic},
          {"viscous power [W]", e.viscous},
          {"eddy power [W]", e.eddies},
          {"pressure power [W]", e.pressure}};
}

/// Heat that is conducted and carried into the fluid through each patch at the accepted time, the range of the temperature, the heat
/// stored above the reference temperature, and its part that no patch has supplied.
template <int D>
Row heat(const Fluid<D>& fluid) {
  const mesh::Mesh& mesh = fluid.mesh();
  const State<D>& s = fluid.state();
  const HeatParameters& p = *fluid.parameters().heat;
  const double capacity = fluid.properties().rho * p.specific_heat;
  enum { volume, stored, received, patches };
  std::vector<double> sums(patches + 2 * mesh.patches.size(), 0.0);  // of each patch: flow, faces
  double most[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double t = s.heat.temperature[c];
    sums[volume] += s.placement->volume[c];
    sums[stored] += s.placement->volume[c] * t;
    most[0] = std::max(most[0], -t), most[1] = std::max(most[1], t);
  }
  sums[received] = s.heat.received;
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    const mesh::Patch& patch = mesh.patches[i];
    const bool is_open = condition_of(fluid.parameters().boundaries.at(patch.name)).passage != Passage::none;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Index b = f - mesh.n_interior;
      sums[patches + 2 * i] += s.heat.flow[b];
      if (!is_open) continue;  // the flux of a wall at the end of the step is not the mean one of the mesh
      const double flux = s.mesh_flux.empty() ? s.phi[f] : s.phi[f] - s.mesh_flux[f];
      sums[patches + 2 * i] -= flux * s.heat.boundary[b];
    }
    sums[patches + 2 * i + 1] = patch.count;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, mesh.comm);
  Row row;
  for (std::size_t i = 0; i < mesh.patches.size(); ++i)
    if (sums[patches + 2 * i + 1] > 0)
      row.emplace_back(mesh.patches[i].name + " [W]", capacity * sums[patches + 2 * i]);
  const double zero = p.reference_temperature;
  row.insert(row.end(), {{"mean temperature [K]", zero + sums[stored] / sums[volume]},
                         {"least temperature [K]", zero - most[0]},
                         {"largest temperature [K]", zero + most[1]},
                         {"stored [J]", capacity * sums[stored]},
                         {"imbalance [J]", capacity * (sums[stored] - sums[received])}});
  return row;
}

/// Forces on the immersed bodies, and the leakage through their surfaces.
template <int D>
Row bodies(const Fluid<D>& fluid) {
  Row row;
  const State<D>& s = fluid.state();
  if (!s.pressure[0]) return row;
  const auto all = fluid.bodies()->forces(*s.placement, *s.pressure[0], s.u, fluid.properties().mu);
  for (std::size_t i = 0; i < all.size(); ++i) {
    add_to_row<D>(row, fluid.bodies()->names()[i] + " pressure", "N", all[i].first.data());
    add_to_row<D>(row, fluid.bodies()->names()[i] + " viscous", "N", all[i].second.data());
  }
  row.emplace_back("leak [m^3/s]", fluid.bodies()->leak(*s.placement, s.phi));
  return row;
}

template <int D>
Row gaps(const Fluid<D>& fluid) {
  Row row;
  const std::vector<std::string>& names = fluid.gaps()->names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& facts = fluid.gaps()->facts()[i];
    row.insert(row.end(), {{names[i] + " opening [m]", facts.opening},
                           {names[i] + " blocked cells [-]", facts.cells},
                           {names[i] + " blocked volume [m^3]", facts.volume}});
  }
  return row;
}

}  // namespace

template <int D>
std::vector<SeriesTable> tables_of(const Fluid<D>& fluid, const WallPatches& walls) {
  const FluidParameters& p = fluid.parameters();
  std::vector<SeriesTable> all;
  WallPatches with_friction;
  std::ranges::copy_if(walls, std::back_inserter(with_friction),
                       [&](const mesh::Patch* patch) { return is_wall(p.boundaries.at(patch->name)); });
  const auto add = [&](bool wanted, const char* file, const auto& row) {
    if (wanted) all.push_back({file, row});
  };
  add(!walls.empty(), "forces.csv", [&] { return forces(fluid, walls); });
  add(!p.output.coefficients.empty(), "coefficients.csv", [&] { return coefficients(fluid); });
  add(!with_friction.empty() && (p.turbulence || p.output.walls), "walls.csv",
      [&fluid, with_friction] { return wall_layers(fluid, with_friction); });
  add(p.output.fluxes, "fluxes.csv", [&] { return fluxes(fluid); });
  add(!p.output.flow_areas.empty(), "flow-areas.csv", [&] { return flow_areas(fluid); });
  add(true, "balance.csv", [&] { return balance(fluid); });
  add(p.output.energy_budget, "energy.csv", [&] { return energies(fluid); });
  add(p.heat.has_value(), "heat.csv", [&] { return heat(fluid); });
  add(fluid.bodies() != nullptr, "bodies.csv", [&] { return bodies(fluid); });
  add(fluid.gaps() != nullptr, "gaps.csv", [&] { return gaps(fluid); });
  return all;
}

template std::vector<SeriesTable> tables_of<2>(const Fluid<2>&, const WallPatches&);
template std::vector<SeriesTable> tables_of<3>(const Fluid<3>&, const WallPatches&);

}  // namespace couplet::fluid
