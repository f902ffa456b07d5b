// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/output/fluxes.hpp"

namespace couplet::fluid {

template <int D>
FluidOutput<D>::FluidOutput(const Fluid<D>& fluid, const mesh::Geometry& geometry, FluidContext context)
    : fluid_(fluid),
      mesh_(fluid.mesh()),
      context_(std::move(context)),
      root_(parallel::comm_rank(mesh_.comm) == 0) {
  set_up_points(geometry);
  for (const mesh::Patch& patch : mesh_.patches)
    if (is_wall(fluid.parameters().boundaries.at(patch.name))) walls_.push_back(&patch);
  check_coefficients();
  if (!fluid.parameters().output.surfaces.empty()) surfaces_.emplace(fluid);
}

template <int D>
void FluidOutput<D>::check_coefficients() const {
  std::vector<std::string> names;
  for (const mesh::Patch* patch : walls_) names.push_back(patch->name);
  for (const auto& [name, c] : fluid_.parameters().output.coefficients)
    for (const std::string& patch : c.patches)
      if (std::ranges::find(names, patch) == names.end())
        throw Error("output.coefficients.{}.patches: '{}' is not a wall. {}", name, patch,
                    base::did_you_mean(patch, names, "walls"));
}

template <int D>
void FluidOutput<D>::write_coefficients(double time) {
  std::vector<double> row{time};
  const auto& all = fluid_.parameters().output.coefficients;
  for (const auto& [name, parameters] : all) {
    const Coefficients c = force_coefficients(fluid_, parameters);
    row.insert(row.end(), {c.drag, c.lift, c.moment});
  }
  if (!root_) return;
  if (!coefficients_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, unused] : all)
      for (const char* what : {"drag [-]", "lift [-]", "moment [-]"}) columns.push_back(name + " " + what);
    coefficients_.emplace(open("coefficients.csv", columns));
  }
  coefficients_->row(row);
}

template <int D>
void FluidOutput<D>::write_fields(double time, int number, const RunningStatistics<D>* statistics) {
  if (context_.output_folder.empty() || !context_.fields.due(number)) return;
  if (!fields_)
    fields_.emplace(mesh_, fluid_.points_at_rest(), context_.output_folder, context_.name, fluid_.moving(),
                    context_.restart_time, context_.fields);
  using Place = io::OutputField::Place;
  const State<D>& s = fluid_.state();
  const FluidOutputParameters& wanted = fluid_.parameters().output;
  const std::vector<double> none(mesh_.cells.n_local(), 0.0);
  const auto pressure = fluid_.pressure();
  std::vector<io::OutputField> fields{{"velocity", "m/s", Place::cells, D, flat<D>(s.u)},
                                      {"pressure", "Pa", Place::cells, 1, pressure ? pressure->p : none}};
  std::vector<double> curl, q, p_rms, shear;
  Vectors<D> u_rms;
  if (wanted.vorticity || wanted.q_criterion) {
    std::vector<Tensor<D>> gradient;
    velocity_gradient<D>(mesh_, *s.placement, s.u, s.u_boundary, gradient);
    if (wanted.vorticity) {
      curl = vorticity<D>(gradient);
      fields.push_back({"vorticity", "1/s", Place::cells, D == 2 ? 1 : 3, curl});
    }
    if (wanted.q_criterion) {
      q = q_criterion<D>(gradient);
      fields.push_back({"q-criterion", "1/s^2", Place::cells, 1, q});
    }
  }
  if (!s.eddy.empty()) fields.push_back({"eddy-viscosity", "m^2/s", Place::cells, 1, s.eddy});
  if (statistics) {
    u_rms = statistics->velocity_rms();
    p_rms = statistics->pressure_rms();
    shear = statistics->reynolds_shear();
    fields.push_back({"velocity-mean", "m/s", Place::cells, D,
                      flat<D>(statistics->velocity_mean()).first(statistics->cells() * D)});
    fields.push_back({"velocity-rms", "m/s", Place::cells, D,
                      std::span<const double>(flat<D>(u_rms)).first(statistics->cells() * D)});
    fields.push_back({"pressure-mean", "Pa", Place::cells, 1,
                      std::span(statistics->pressure_mean()).first(statistics->cells())});
    fields.push_back(
        {"pressure-rms", "Pa", Place::cells, 1, std::span<const double>(p_rms).first(statistics->cells())});
    fields.push_back({"reynolds-shear", "m^2/s^2", Place::cells, RunningStatistics<D>::n_shear, shear});
  }
  fields_->write(time, fluid_.moving() ? s.points : fluid_.points_at_rest(), fields);
}

template <int D>
void FluidOutput<D>::write_series(double time) {
  if (context_.output_folder.empty()) return;
  if (!walls_.empty()) write_forces(time);
  if (!fluid_.parameters().output.coefficients.empty()) write_coefficients(time);
  if (!walls_.empty() && (fluid_.parameters().turbulence || fluid_.parameters().output.walls))
    write_walls(time);
  if (fluid_.parameters().output.fluxes) write_fluxes(time);
  if (!fluid_.parameters().output.flow_areas.empty()) write_flow_areas(time);
  write_balance(time);
  if (fluid_.parameters().output.energy_budget) write_energy(time);
  if (fluid_.bodies()) write_bodies(time);
  if (fluid_.gaps()) write_gaps(time);
  if (!probes_.empty()) write_probes(time);
}

template <int D>
void FluidOutput<D>::write_surfaces(double time) {
  if (surfaces_ && !context_.output_folder.empty()) surfaces_->write(time, context_);
}

template <int D>
void FluidOutput<D>::write_fluxes(double time) {
  const std::vector<PatchFlux<D>> all = patch_fluxes(fluid_);
  if (all.empty() || !root_) return;
  std::vector<double> row{time};
  for (const PatchFlux<D>& flux : all) {
    row.push_back(flux.volume);
    row.insert(row.end(), flux.momentum.data(), flux.momentum.data() + D);
    row.push_back(flux.mean_pressure);
  }
  if (!fluxes_) {
    std::vector<std::string> columns{"time [s]"};
    for (const PatchFlux<D>& flux : all) {
      columns.push_back(flux.patch + " volume [m^3/s]");
      for (int c = 0; c < D; ++c)
        columns.push_back(fmt::format("{} momentum {} [N]", flux.patch, base::axis_letters[c]));
      columns.push_back(flux.patch + " mean pressure [Pa]");
    }
    fluxes_.emplace(open("fluxes.csv", columns));
  }
  fluxes_->row(row);
}

template <int D>
void FluidOutput<D>::write_walls(double time) {
  std::vector<double> row{time};
  for (const mesh::Patch* patch : walls_) {
    const WallSummary w = summarise_wall(fluid_, *patch);
    row.insert(row.end(), {w.mean_shear, w.largest_shear, w.mean_yplus, w.largest_yplus});
  }
  if (!root_) return;
  if (!walls_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const mesh::Patch* patch : walls_)
      for (const char* what : {"mean shear [Pa]", "largest shear [Pa]", "mean y+ [-]", "largest y+ [-]"})
        columns.push_back(fmt::format("{} {}", patch->name, what));
    walls_series_.emplace(open("walls.csv", columns));
  }
  walls_series_->row(row);
}

// Forces on the immersed bodies, and what leaks through their surfaces.
template <int D>
void FluidOutput<D>::write_bodies(double time) {
  const State<D>& s = fluid_.state();
  if (!s.pressure[0]) return;
  std::vector<double> row{time};
  for (const auto& [pressure, friction] :
       fluid_.bodies()->forces(*s.placement, *s.pressure[0], s.u, fluid_.parameters().viscosity))
    for (const Vec<D>& force : {pressure, friction}) row.insert(row.end(), force.data(), force.data() + D);
  row.push_back(fluid_.bodies()->leak(*s.placement, s.phi));
  if (!root_) return;
  if (!bodies_) {
    std::vector<std::string> columns{"time [s]"};
    for (const std::string& name : fluid_.bodies()->names())
      for (const char* part : {"pressure", "viscous"})
        for (int c = 0; c < D; ++c)
          columns.push_back(fmt::format("{} {} {} [N]", name, part, base::axis_letters[c]));
    columns.push_back("leak [m^3/s]");
    bodies_.emplace(open("bodies.csv", columns));
  }
  bodies_->row(row);
}

template <int D>
void FluidOutput<D>::write_gaps(double time) {
  if (!root_) return;
  const Gaps<D>& gaps = *fluid_.gaps();
  std::vector<double> row{time};
  for (const auto& facts : gaps.facts()) row.insert(row.end(), {facts.opening, facts.cells, facts.volume});
  if (!gaps_) {
    std::vector<std::string> columns{"time [s]"};
    for (const std::string& name : gaps.names())
      for (const char* what : {"opening [m]", "blocked cells [-]", "blocked volume [m^3]"})
        columns.push_back(fmt::format("{} {}", name, what));
    gaps_.emplace(open("gaps.csv", columns));
  }
  gaps_->row(row);
}

template <int D>
void FluidOutput<D>::write_energy(double time) {
  const EnergyBudget e = energy_budget(fluid_);
  if (!root_) return;
  if (!energy_)
    energy_.emplace(open("energy.csv", {"time [s]", "kinetic energy [J]", "viscous power [W]",
                                        "eddy power [W]", "pressure power [W]"}));
  energy_->row(std::array<double, 5>{time, e.kinetic, e.viscous, e.eddies, e.pressure});
}

template <int D>
io::Series FluidOutput<D>::open(const std::string& file, const std::vector<std::string>& columns) const {
  return io::Series(context_.output_folder / file, columns, context_.restart_time);
}

// Forces of the fluid on each wall, means over the coupling step.
template <int D>
void FluidOutput<D>::write_forces(double time) {
  std::vector<double> row{time};
  for (const mesh::Patch* patch : walls_)
    for (const Vectors<D>* force : {&fluid_.pressure_force(), &fluid_.viscous_force()}) {
      Vec<D> total = Vec<D>::Zero();
      if (!force->empty())
        for (Index f = patch->first; f < patch->first + patch->count; ++f)
          total += (*force)[f - mesh_.n_interior];
      for (int c = 0; c < D; ++c) row.push_back(total[c]);
    }
  MPI_Allreduce(MPI_IN_PLACE, row.data() + 1, static_cast<int>(row.size()) - 1, MPI_DOUBLE, MPI_SUM,
                mesh_.comm);
  if (!root_) return;
  if (!forces_) {
    std::vector<std::string> columns{"time [s]"};
    for (const mesh::Patch* patch : walls_)
      for (const char* part : {"pressure", "viscous"})
        for (int c = 0; c < D; ++c)
          columns.push_back(fmt::format("{} {} {} [N]", patch->name, part, base::axis_letters[c]));
    forces_.emplace(open("forces.csv", columns));
  }
  forces_->row(row);
}

template class FluidOutput<2>;
template class FluidOutput<3>;

}  // namespace couplet::fluid
