// SPDX-License-Identifier: Apache-2.0
// What the output writes at single places: probes, lines, planes.
#include <fmt/format.h>

#include <array>

#include "common/base/constants.hpp"
#include "common/io/probes/mesh_scale.hpp"
#include "fluid_solver/output/output.hpp"

namespace couplet::fluid {
namespace {

template <int D>
void add_columns(std::vector<std::string>& columns, const std::string& before, const std::string& after) {
  for (int c = 0; c < D; ++c)
    columns.push_back(fmt::format("{}velocity{} {} [m/s]", before, after, base::axis_letters[c]));
  columns.push_back(fmt::format("{}pressure{} [Pa]", before, after));
}

}  // namespace

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
void FluidOutput<D>::write_probes(double time) {
  if (!fluid_.state().pressure[0]) return;
  point_values_->follow();
  std::vector<double> row{time}, at_points(mesh_.points.n_local() * (D + 1), 0.0);
  point_values_->state(probes_, at_points);
  for (const io::Probe& probe : probes_) {
    const std::vector<double> sampled = probe.sample(at_points, D + 1);
    row.insert(row.end(), sampled.begin(), sampled.end());
  }
  if (!root_) return;
  if (!probe_series_) {
    std::vector<std::string> columns{"time [s]"};
    for (const auto& [name, unused] : fluid_.parameters().probes) add_columns<D>(columns, name + " ", "");
    probe_series_.emplace(open("probes.csv", columns));
  }
  probe_series_->row(row);
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
      add_columns<D>(columns, "", "");
      if (statistics) add_columns<D>(columns, "", "-mean");
      if (statistics) add_columns<D>(columns, "", "-rms");
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

template void FluidOutput<2>::set_up_points(const mesh::Geometry&);
template void FluidOutput<3>::set_up_points(const mesh::Geometry&);
template void FluidOutput<2>::write_probes(double);
template void FluidOutput<3>::write_probes(double);
template void FluidOutput<2>::write_samples(double, const RunningStatistics<2>*);
template void FluidOutput<3>::write_samples(double, const RunningStatistics<3>*);

}  // namespace couplet::fluid
