// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/output/output.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/probes/place_search.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid {

namespace {

std::vector<std::string> columns_of(const std::vector<FlowQuantity>& quantities) {
  std::vector<std::string> columns;
  for (const FlowQuantity& q : quantities)
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
    if (const BoundaryParameters& b = fluid.parameters().boundaries.at(patch.name);
        is_wall(b) || b.type == BoundaryType::slip)
      walls_.push_back(&patch);
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
  io::check_mesh_scale(mesh_, geometry.points, places, p.mesh_scale);
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
  FlowQuantities<D> quantities(fluid_);
  if (statistics) quantities.add(*statistics);
  quantities.add_in_cells(statistics);
  std::vector<io::OutputField> fields;
  for (const FlowQuantity& q : quantities.all())
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
  const FlowQuantities<D> quantities(fluid_);
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
  FlowQuantities<D> quantities(fluid_);
  if (statistics) quantities.add(*statistics);
  const int width = quantities.width();
  std::vector<double> at_points(std::size_t(mesh_.points.n_local()) * width, 0.0);
  const std::span<const double> places{points.empty() ? nullptr : points.front().data(), 3 * points.size()};
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const Profile& sample = samples_[k];
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

template <int D>
PointValues<D>::PointValues(const Fluid<D>& fluid, const mesh::Geometry& geometry)
    : fluid_(fluid),
      interpolation_(fluid.mesh(), geometry,
                     std::vector<fv::PatchStencil>(fluid.mesh().patches.size(), fv::PatchStencil::open)) {}

template <int D>
void PointValues<D>::follow() {
  const State<D>& s = fluid_.state();
  if (fluid_.moving()) interpolation_.update(mesh::compute_geometry(fluid_.mesh(), s.points));
}

template <int D>
void PointValues<D>::fill(const FlowQuantities<D>& quantities, std::span<const io::Probe> probes,
                          std::span<double> values) const {
  const mesh::Mesh& mesh = fluid_.mesh();
  const int width = quantities.width();
  int first = 0;
  for (const FlowQuantity& q : quantities.all()) {
    std::vector<double> boundary(q.boundary.begin(), q.boundary.end());
    boundary.resize(std::size_t(mesh.boundary.n_local()) * q.components, 0.0);
    mesh.boundary.update_ghosts(boundary, q.components);
    for (const io::Probe& probe : probes)
      for (const Index point : probe.points()) {
        double* at = values.data() + std::size_t(point) * width + first;
        if (q.components == D) {
          const Vec<D> value = interpolation_.template scalar_at<D>(point, q.cells, boundary);
          std::copy_n(value.data(), D, at);
        } else {
          *at = interpolation_.template scalar_at<1>(point, q.cells, boundary)[0];
        }
      }
    first += q.components;
  }
}

Profile::Profile(const mesh::Mesh& mesh, std::span<const Vec3> places, std::string name,
                 const SampleParameters& p)
    : name_(std::move(name)) {
  const int rows = p.type == SampleParameters::Type::plane ? p.rows : 1;
  const io::PlaceSearch search(mesh, places);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < p.points; ++i) {
      const double s = double(i) / (p.points - 1), r = rows > 1 ? double(j) / (rows - 1) : 0.0;
      auto probe = io::Probe::in(search, p.from + s * (p.to - p.from) + r * (p.up - p.from));
      if (!probe) continue;  // on all ranks
      probes_.push_back(*std::move(probe));
      along_.push_back({s, r});
    }
  if (probes_.empty()) try {
      io::Probe(mesh, places, name_, p.from);
    } catch (const Error& outside) {
      throw Error("output.samples.{}: none of its points is in the mesh. {}", name_, outside.what());
    }
  const auto asked = std::size_t(p.points) * std::size_t(rows);
  if (probes_.size() < asked && parallel::comm_rank(mesh.comm) == 0)
    log::info("output.samples.{}: {} of {} points are outside the mesh and are omitted", name_,
              asked - probes_.size(), asked);
}

std::vector<double> Profile::gather(MPI_Comm comm, std::span<const double> at_points, int components) const {
  std::vector<double> values(probes_.size() * components, 0.0);
  for (std::size_t k = 0; k < probes_.size(); ++k) {
    const io::Probe& probe = probes_[k];
    for (std::size_t i = 0; i < probe.points().size(); ++i)
      for (int c = 0; c < components; ++c)
        values[k * components + c] +=
            probe.weights()[i] * at_points[std::size_t(probe.points()[i]) * components + c];
  }
  const bool root = parallel::comm_rank(comm) == 0;  // all ranks but one bring zeros
  MPI_Reduce(root ? MPI_IN_PLACE : values.data(), values.data(), static_cast<int>(values.size()), MPI_DOUBLE,
             MPI_SUM, 0, comm);
  if (!root) values.clear();
  return values;
}

template class PointValues<2>;
template class PointValues<3>;

/// Per owned boundary face; vectors of D values each.
template <int D>
struct FluidSurfaces<D>::Faces {
  std::vector<double> traction, shear, yplus;
  std::vector<double> temperature{}, heat_flux{};  // empty without heat
};

template <int D>
FluidSurfaces<D>::FluidSurfaces(const Fluid<D>& fluid)
    : fluid_(fluid),
      series_(fluid.mesh(), fluid.points_at_rest(), fluid.parameters().output.surfaces, "output.surfaces") {}

// Forces equal those of forces.csv, and so does their sum.
template <int D>
typename FluidSurfaces<D>::Faces FluidSurfaces<D>::faces() const {
  const mesh::Mesh& mesh = fluid_.mesh();
  const std::size_t n = mesh.boundary.n_owned();
  const auto units = wall_units(fluid_);
  Faces faces{std::vector<double>(n * D), std::vector<double>(n * D), std::vector<double>(n)};
  for (std::size_t b = 0; b < n; ++b) {
    const Vec<D>& area = fluid_.state().placement->area[mesh.n_interior + static_cast<Index>(b)];
    const double size = area.norm();
    const Vec<D> normal = area / size, &friction = fluid_.viscous_force()[b];
    Eigen::Map<Vec<D>>(faces.traction.data() + b * D) = (fluid_.pressure_force()[b] + friction) / size;
    Eigen::Map<Vec<D>>(faces.shear.data() + b * D) = (friction - friction.dot(normal) * normal) / size;
    faces.yplus[b] = units[b][1];
  }
  const HeatLevel& heat = fluid_.state().heat;
  if (!heat.is_solved) return faces;
  const HeatParameters& p = *fluid_.parameters().heat;
  faces.temperature = heat.boundary;
  faces.heat_flux = heat.flow;
  for (std::size_t b = 0; b < n; ++b) {
    faces.temperature[b] += p.reference_temperature;
    faces.heat_flux[b] *= fluid_.properties().rho * p.specific_heat /
                          fluid_.state().placement->area[mesh.n_interior + static_cast<Index>(b)].norm();
  }
  return faces;
}

/// Per boundary face; empty if no coefficients use this patch, else those of the first by name.
template <int D>
std::vector<double> FluidSurfaces<D>::pressure_coefficient(const mesh::Patch& patch,
                                                           std::span<const double> pressure) const {
  for (const auto& [name, c] : fluid_.parameters().output.coefficients) {
    if (std::ranges::find(c.patches, patch.name) == c.patches.end()) continue;
    const double q = 0.5 * fluid_.properties().rho * c.speed * c.speed;
    std::vector<double> result(pressure.begin(), pressure.end());
    for (double& value : result) value = (value - c.pressure) / q;
    return result;
  }
  return {};
}

template <int D>
void FluidSurfaces<D>::write(double time, const FluidContext& context) {
  const auto pressure = fluid_.pressure();
  if (!pressure || !parallel::any(fluid_.mesh().comm, !fluid_.pressure_force().empty())) return;
  if (!is_open_) series_.open(context.output_folder, fluid_.moving(), context.restart_time);
  is_open_ = true;
  const Faces all = faces();
  using Place = io::OutputField::Place;
  for (std::size_t i = 0; i < series_.patches().size(); ++i) {
    const mesh::Patch& patch = *series_.patches()[i];
    std::vector<io::OutputField> fields{{"pressure", "Pa", Place::cells, 1, pressure->boundary},
                                        {"traction", "Pa", Place::cells, D, all.traction},
                                        {"wall-shear", "Pa", Place::cells, D, all.shear}};
    if (is_wall(fluid_.parameters().boundaries.at(patch.name)))
      fields.push_back({"y-plus", "-", Place::cells, 1, all.yplus});
    const std::vector<double> cp = pressure_coefficient(patch, pressure->boundary);
    if (!cp.empty()) fields.push_back({"pressure-coefficient", "-", Place::cells, 1, cp});
    if (fluid_.parameters().heat) {
      fields.push_back({"temperature", "K", Place::cells, 1, all.temperature});
      fields.push_back({"heat-flux", "W/m^2", Place::cells, 1, all.heat_flux});
    }
    series_.write(i, time, fluid_.moving() ? fluid_.state().points : fluid_.points_at_rest(), fields);
  }
}

template class FluidSurfaces<2>;
template class FluidSurfaces<3>;

}  // namespace couplet::fluid
