// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

constexpr std::array<const char*, 3> axis{"x", "y", "z"};

bool is_wall(BoundaryType type) {
  return type == BoundaryType::no_slip || type == BoundaryType::moving_wall ||
         type == BoundaryType::interface;
}

}  // namespace

template <int D>
FluidOutput<D>::FluidOutput(const Fluid<D>& fluid, FluidContext context)
    : fluid_(fluid), mesh_(fluid.mesh()), context_(std::move(context)), root_(comm_rank(mesh_.comm) == 0) {
  for (const auto& [name, probe] : fluid.parameters().probes) probes_.emplace_back(mesh_, name, probe.point);
  if (!probes_.empty())
    interpolation_.emplace(mesh_, std::vector<PatchStencil>(mesh_.patches.size(), PatchStencil::open));
  for (const Patch& patch : mesh_.patches)
    if (is_wall(fluid.parameters().boundaries.at(patch.name).type)) walls_.push_back(&patch);
}

template <int D>
void FluidOutput<D>::write_fields(double time) {
  if (context_.output_folder.empty()) return;
  if (!fields_)
    fields_.emplace(mesh_, context_.output_folder, context_.name, fluid_.moving(), context_.restart_time);
  const State<D>& s = fluid_.state();
  const std::vector<double> none(mesh_.cells.n_local(), 0.0);
  fields_->write(time, fluid_.moving() ? s.points : mesh_.reference_points,
                 {{"velocity", "m/s", OutputField::Place::cells, D, flat<D>(s.u)},
                  {"pressure", "Pa", OutputField::Place::cells, 1, s.pressure[0] ? s.pressure[0]->p : none}});
}

template <int D>
void FluidOutput<D>::write_series(double time) {
  if (context_.output_folder.empty()) return;
  if (!walls_.empty()) write_forces(time);
  write_balance(time);
  if (!probes_.empty()) write_probes(time);
}

template <int D>
Series FluidOutput<D>::open(const std::string& file, const std::vector<std::string>& columns) const {
  return Series(context_.output_folder / file, columns, context_.restart_time);
}

// Forces of the fluid on each wall, means over the coupling step.
template <int D>
void FluidOutput<D>::write_forces(double time) {
  std::vector<double> row{time};
  for (const Patch* patch : walls_)
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
    for (const Patch* patch : walls_)
      for (const char* part : {"pressure", "viscous"})
        for (int c = 0; c < D; ++c)
          columns.push_back(fmt::format("{} {} {} [N]", patch->name, part, axis[c]));
    forces_.emplace(open("forces.csv", columns));
  }
  forces_->row(row);
}

template <int D>
void FluidOutput<D>::write_balance(double time) {
  const State<D>& s = fluid_.state();
  const Placement<D>& at = *s.placement;
  enum { inflow, outflow, volume, energy };
  double sums[4] = {};
  divergence_.assign(mesh_.cells.n_local(), 0.0);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    divergence_[mesh_.owner[f]] += s.phi[f];
    if (f < mesh_.n_interior)
      divergence_[mesh_.neighbour[f]] -= s.phi[f];
    else
      (s.phi[f] < 0 ? sums[inflow] : sums[outflow]) += std::abs(s.phi[f]);
  }
  double worst = 0;
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    worst = std::max(worst, std::abs(divergence_[c]) / at.volume[c]);
    sums[volume] += at.volume[c];
    sums[energy] += 0.5 * fluid_.parameters().density * at.volume[c] * s.u[c].squaredNorm();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  worst = max(mesh_.comm, worst);
  if (!root_) return;
  if (!balance_)
    balance_.emplace(open(
        "balance.csv", {"time [s]", "inflow [m^3/s]", "outflow [m^3/s]", "volume [m^3]", "kinetic energy [J]",
                        "largest divergence [1/s]", "sub-steps [-]", "pressure iterations so far [-]"}));
  balance_->row(std::array<double, 8>{time, sums[inflow], sums[outflow], sums[volume], sums[energy], worst,
                                      double(fluid_.statistics().sub_steps),
                                      double(fluid_.statistics().pressure_iterations)});
}

template <int D>
void FluidOutput<D>::write_probes(double time) {
  const State<D>& s = fluid_.state();
  if (!s.pressure[0]) return;
  if (fluid_.moving()) interpolation_->update(compute_geometry(mesh_, s.points), s.points);
  Vectors<D> u_boundary = s.u_boundary;
  u_boundary.resize(mesh_.boundary.n_local(), Vec<D>::Zero());
  mesh_.boundary.update_ghosts(flat<D>(u_boundary), D);
  std::vector<double> p_boundary = s.pressure[0]->boundary;
  p_boundary.resize(mesh_.boundary.n_local(), 0.0);
  mesh_.boundary.update_ghosts(p_boundary);

  std::vector<double> row{time};
  std::vector<double> at_points(mesh_.points.n_local() * (D + 1), 0.0);
  for (const Probe& probe : probes_) {
    for (const Index point : probe.points()) {
      double* values = at_points.data() + std::size_t(point) * (D + 1);
      const Vec<D> velocity = interpolation_->template scalar_at<D>(point, flat<D>(s.u), flat<D>(u_boundary));
      std::copy_n(velocity.data(), D, values);
      values[D] = interpolation_->template scalar_at<1>(point, s.pressure[0]->p, p_boundary)[0];
    }
    const std::vector<double> sampled = probe.sample(at_points, D + 1);
    row.insert(row.end(), sampled.begin(), sampled.end());
  }
  if (!root_) return;
  if (!probe_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, unused] : fluid_.parameters().probes) {
      for (int c = 0; c < D; ++c) columns.push_back(fmt::format("{} velocity {} [m/s]", name, axis[c]));
      columns.push_back(fmt::format("{} pressure [Pa]", name));
    }
    probe_series_.emplace(open("probes.csv", columns));
  }
  probe_series_->row(row);
}

template class FluidOutput<2>;
template class FluidOutput<3>;

}  // namespace couplet::fluid
