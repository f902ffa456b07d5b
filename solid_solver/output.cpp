// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output.hpp"

#include <array>
#include <cmath>
#include <string>

#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

constexpr std::array<const char*, 3> axis{"x", "y", "z"};

/// von Mises.
double equivalent_stress(const Tensor3& s) {
  const Tensor3 deviator = s - s.trace() / 3 * Tensor3::Identity();
  return std::sqrt(1.5 * deviator.squaredNorm());
}

struct StressField {
  const char* name;
  int row, column;
};
constexpr std::array<StressField, 6> stress_fields{{{"stress-xx", 0, 0},
                                                    {"stress-yy", 1, 1},
                                                    {"stress-zz", 2, 2},
                                                    {"stress-xy", 0, 1},
                                                    {"stress-yz", 1, 2},
                                                    {"stress-xz", 0, 2}}};

}  // namespace

SolidOutput::SolidOutput(const Solid& solid, const SolidContext& context) : solid_(solid), context_(context) {
  for (const auto& [name, probe] : solid.parameters().probes)
    probes_.emplace_back(solid.mesh(), name, probe.point);
}

void SolidOutput::write_fields(double time, std::span<const double> points) {
  if (context_.output_folder.empty()) return;
  const Mesh& mesh = solid_.mesh();
  const int dim = mesh.dim;
  if (!fields_)
    fields_.emplace(mesh, context_.output_folder, context_.name, solid_.parameters().output.deformed,
                    context_.restart_time);
  const std::vector<double> velocity = solid_.point_velocity();
  std::vector<Vec3> places = mesh.reference_points;
  for (std::size_t v = 0; v < places.size(); ++v)
    for (int a = 0; a < dim; ++a) places[v][a] += points[v * dim + a];
  std::vector<OutputField> fields{
      {"displacement", "m", OutputField::Place::points, dim, points},
      {"velocity", "m/s", OutputField::Place::points, dim, velocity},
      {"cell-displacement", "m", OutputField::Place::cells, dim, solid_.state().cell_u}};
  std::vector<std::vector<double>> columns;
  if (solid_.parameters().output.stress) {
    const std::vector<Tensor3> stress = solid_.cell_stress(points);
    const std::size_t n_components = dim == 2 ? 4 : 6;
    columns.assign(n_components + 1, std::vector<double>(mesh.cells.n_local(), 0));
    for (std::size_t c = 0; c < stress.size(); ++c) {
      for (std::size_t i = 0; i < n_components; ++i)
        columns[i][c] = stress[c](stress_fields[i].row, stress_fields[i].column);
      columns.back()[c] = equivalent_stress(stress[c]);
    }
    for (std::size_t i = 0; i < n_components; ++i)
      fields.push_back({stress_fields[i].name, "Pa", OutputField::Place::cells, 1, columns[i]});
    fields.push_back({"equivalent-stress", "Pa", OutputField::Place::cells, 1, columns.back()});
  }
  for (const auto& effect : solid_.effects()) effect->add_fields(fields);
  fields_->write(time, places, fields);
}

void SolidOutput::write_series(double time, std::span<const double> points) {
  if (context_.output_folder.empty()) return;
  if (!probes_.empty()) write_probes(time, points);
  write_reactions(time, points);
  write_effort(time);
}

void SolidOutput::write_probes(double time, std::span<const double> points) {
  const int dim = solid_.mesh().dim;
  std::vector<double> row{time};
  for (const Probe& probe : probes_) {
    const std::vector<double> value = probe.sample(points, dim);
    row.insert(row.end(), value.begin(), value.end());
  }
  if (comm_rank(solid_.mesh().comm) != 0) return;
  if (!probe_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, probe] : solid_.parameters().probes)
      for (int a = 0; a < dim; ++a) columns.push_back(name + " " + axis[a] + " [m]");
    probe_series_.emplace(context_.output_folder / "probes.csv", columns, context_.restart_time);
  }
  probe_series_->row(row);
}

void SolidOutput::write_reactions(double time, std::span<const double> points) {
  const int dim = solid_.mesh().dim;
  const std::vector<PatchForce> reactions = solid_.reactions(points);
  const Vec3 load = solid_.total_load();
  if (comm_rank(solid_.mesh().comm) != 0) return;
  std::vector<double> row{time};
  for (const PatchForce& r : reactions) row.insert(row.end(), r.force.data(), r.force.data() + dim);
  row.insert(row.end(), load.data(), load.data() + dim);
  if (!reaction_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const PatchForce& r : reactions)
      for (int a = 0; a < dim; ++a) columns.push_back(r.patch + " " + axis[a] + " [N]");
    for (int a = 0; a < dim; ++a) columns.push_back(std::string("load ") + axis[a] + " [N]");
    reaction_series_.emplace(context_.output_folder / "reactions.csv", columns, context_.restart_time);
  }
  reaction_series_->row(row);
}

void SolidOutput::write_effort(double time) {
  const SolverEffort& effort = solid_.effort();
  if (effort.solves == 0 || comm_rank(solid_.mesh().comm) != 0) return;  // at the start nothing was solved
  if (!solver_series_)
    solver_series_.emplace(
        context_.output_folder / "solver.csv",
        std::vector<std::string>{"time [s]", "solves", "iterations", "inner iterations", "residual"},
        context_.restart_time);
  const std::array<double, 5> row{time, static_cast<double>(effort.solves),
                                  static_cast<double>(effort.iterations),
                                  static_cast<double>(effort.inner_iterations), effort.residual};
  solver_series_->row(row);
}

}  // namespace couplet
