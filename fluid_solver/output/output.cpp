// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid {
namespace {

std::vector<std::string> columns_of(const std::vector<Quantity>& quantities) {
  std::vector<std::string> columns;
  for (const Quantity& q : quantities)
    for (int c = 0; c < q.components; ++c)
      columns.push_back(q.components == 1 ? fmt::format("{} [{}]", q.name, q.unit)
                                          : fmt::format("{} {} [{}]", q.name, base::axis_letters[c], q.unit));
  return columns;
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
  Quantities<D> quantities(fluid_);
  if (statistics) quantities.add(*statistics);
  quantities.add_in_cells(statistics);
  std::vector<io::OutputField> fields;
  for (const Quantity& q : quantities.all())
    fields.push_back({q.name, q.unit, io::OutputField::Place::cells, q.components, q.cells});
  fields_->write(time, fluid_.moving() ? fluid_.state().points : fluid_.points_at_rest(), fields);
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
  const Quantities<D> quantities(fluid_);
  const std::vector<std::string> columns = columns_of(quantities.all());
  std::vector<double> at_points(std::size_t(mesh_.points.n_local()) * columns.size(), 0.0);
  point_values_->fill(quantities, probes_, at_points);
  auto named = fluid_.parameters().probes.begin();
  for (const io::Probe& probe : probes_) {
    const std::string& name = named++->first;
    const std::vector<double> sampled = probe.sample(at_points, quantities.width());  // on the root
    for (std::size_t i = 0; i < sampled.size(); ++i) row.emplace_back(name + " " + columns[i], sampled[i]);
  }
  return row;
}

template <int D>
void FluidOutput<D>::write_samples(double time, const RunningStatistics<D>* statistics) {
  if (samples_.empty() || context_.output_folder.empty() || !fluid_.state().pressure[0]) return;
  point_values_->follow();
  const std::vector<Vec3>& points = fluid_.moving() ? fluid_.state().points : fluid_.points_at_rest();
  Quantities<D> quantities(fluid_);
  if (statistics) quantities.add(*statistics);
  const int width = quantities.width();
  std::vector<double> at_points(std::size_t(mesh_.points.n_local()) * width, 0.0);
  const std::span<const double> places{points.empty() ? nullptr : points.front().data(), 3 * points.size()};
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const Sample& sample = samples_[k];
    point_values_->fill(quantities, sample.probes(), at_points);
    const std::vector<double> at = sample.gather(mesh_.comm, places, 3),
                              values = sample.gather(mesh_.comm, at_points, width);
    if (!root_) continue;
    if (!sample_series_[k]) {
      std::vector<std::string> columns{"time [s]", "along [-]", "up [-]", "x [m]", "y [m]", "z [m]"};
      for (std::string& column : columns_of(quantities.all())) columns.push_back(std::move(column));
      sample_series_[k].emplace(open("sample-" + sample.name() + ".csv", columns));
    }
    for (std::size_t i = 0; i < sample.probes().size(); ++i) {
      std::vector<double> row{time, sample.along()[i][0], sample.along()[i][1]};
      row.insert(row.end(), at.begin() + 3 * i, at.begin() + 3 * (i + 1));
      row.insert(row.end(), values.begin() + width * i, values.begin() + width * (i + 1));
      sample_series_[k]->row(row);
    }
  }
}

template class FluidOutput<2>;
template class FluidOutput<3>;

}  // namespace couplet::fluid
