// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/probes/mesh_scale.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid {
namespace {

template <int D>
void add_columns(std::vector<std::string>& columns, const std::string& after) {
  for (int c = 0; c < D; ++c)
    columns.push_back(fmt::format("velocity{} {} [m/s]", after, base::axis_letters[c]));
  columns.push_back(fmt::format("pressure{} [Pa]", after));
}

}  // namespace

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
  tables_ = tables_of(fluid_, walls_);
  if (!probes_.empty()) tables_.push_back({"probes.csv", [this] { return probes(); }});
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
void FluidOutput<D>::set_up_points(const mesh::Geometry& geometry) {
  const FluidParameters& p = fluid_.parameters();
  std::vector<Vec3> places;
  for (const auto& [name, probe] : p.probes) {
    probes_.emplace_back(mesh_, geometry.points, name, probe.point);
    places.push_back(probe.point);
  }
  io::doubt_mesh_scale(mesh_, geometry.points, places);
  for (const auto& [name, sample] : p.output.samples)
    samples_.emplace_back(mesh_, geometry.points, name, sample);
  if (!probes_.empty() || !samples_.empty()) point_values_.emplace(fluid_, geometry);
  sample_series_.resize(samples_.size());
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
  for (SeriesTable& table : tables_) {
    const Row row = table.row();
    if (!root_ || row.empty()) continue;
    std::vector<double> values{time};
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [column, value] : row) {
      values.push_back(value);
      if (!table.series) columns.push_back(column);
    }
    if (!table.series) table.series.emplace(open(table.file, columns));
    table.series->row(values);
  }
}

template <int D>
io::Series FluidOutput<D>::open(const std::string& file, const std::vector<std::string>& columns) const {
  return io::Series(context_.output_folder / file, columns, context_.restart_time);
}

template <int D>
void FluidOutput<D>::write_surfaces(double time) {
  if (surfaces_ && !context_.output_folder.empty()) surfaces_->write(time, context_);
}

template <int D>
Row FluidOutput<D>::probes() {
  Row row;
  if (!fluid_.state().pressure[0]) return row;
  point_values_->follow();
  std::vector<double> at_points(mesh_.points.n_local() * (D + 1), 0.0);
  point_values_->state(probes_, at_points);
  auto named = fluid_.parameters().probes.begin();
  for (const io::Probe& probe : probes_) {
    const std::string& name = named++->first;
    const std::vector<double> sampled = probe.sample(at_points, D + 1);  // on the root
    if (!root_) continue;
    add_to_row<D>(row, name + " velocity", "m/s", sampled.data());
    row.emplace_back(name + " pressure [Pa]", sampled[D]);
  }
  return row;
}

template <int D>
void FluidOutput<D>::write_samples(double time, const RunningStatistics<D>* statistics) {
  if (samples_.empty() || context_.output_folder.empty() || !fluid_.state().pressure[0]) return;
  point_values_->follow();
  const std::vector<Vec3>& points = fluid_.moving() ? fluid_.state().points : fluid_.points_at_rest();
  const int means = statistics ? 2 * (D + 1) : 0;
  std::vector<double> now(mesh_.points.n_local() * (D + 1), 0.0),
      of_time(mesh_.points.n_local() * means, 0.0);
  const std::span<const double> places{points.empty() ? nullptr : points.front().data(), 3 * points.size()};
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const Sample& sample = samples_[k];
    point_values_->state(sample.probes(), now);
    if (statistics) point_values_->means(*statistics, sample.probes(), of_time);
    const std::vector<double> at = sample.gather(mesh_.comm, places, 3),
                              values = sample.gather(mesh_.comm, now, D + 1),
                              mean = statistics ? sample.gather(mesh_.comm, of_time, means) : at;
    if (!root_) continue;
    if (!sample_series_[k]) {
      std::vector<std::string> columns{"time [s]", "along [-]", "up [-]", "x [m]", "y [m]", "z [m]"};
      add_columns<D>(columns, "");
      if (statistics) add_columns<D>(columns, "-mean");
      if (statistics) add_columns<D>(columns, "-rms");
      sample_series_[k].emplace(open("sample-" + sample.name() + ".csv", columns));
    }
    for (std::size_t i = 0; i < sample.probes().size(); ++i) {
      std::vector<double> row{time, sample.along()[i][0], sample.along()[i][1]};
      row.insert(row.end(), at.begin() + 3 * i, at.begin() + 3 * (i + 1));
      row.insert(row.end(), values.begin() + (D + 1) * i, values.begin() + (D + 1) * (i + 1));
      row.insert(row.end(), mean.begin() + means * i, mean.begin() + means * (i + 1));
      sample_series_[k]->row(row);
    }
  }
}

template class FluidOutput<2>;
template class FluidOutput<3>;

}  // namespace couplet::fluid
