// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/results.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/base/error.hpp"
#include "common/base/point_tree.hpp"
#include "common/diagnostics/results.hpp"
#include "common/log/log.hpp"
#include "common/mesh/load.hpp"

namespace couplet::plate {
namespace {

/// Logs the size, which reveals a mesh in another unit.
void log_size(const Structure& structure) {
  const modes::ModalModel& model = structure.model();
  const Vec3 side = modes::extent_of(model);
  std::string slender;
  if (const double h = structure.parameters().thickness; structure.parameters().mesh && h > 0) {
    Vec3 sorted = side;
    std::ranges::sort(sorted, std::greater());
    slender = fmt::format(", thickness over its shorter span 1/{:.3g}", sorted[1] / h);
  }
  log::info("the structure measures {:.4g} x {:.4g} x {:.4g} m and has a mass of {:.4g} kg{}", side.x(),
            side.y(), side.z(), model.mass, slender);
  if (structure.parameters().mesh) diagnostics::set_mesh_size(side, 3, structure.parameters().mesh_scale);
}

}  // namespace

SurfacePlace nearest_place(const modes::ModalModel& model, const Vec3& point) {
  SurfacePlace best;
  best.distance = std::numeric_limits<double>::infinity();
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      const std::array<Index, 3> v{corners[0], corners[i], corners[i + 1]};
      const base::NearestPoint<3> nearest =
          base::nearest_on_triangle(model.vertices[v[0]], model.vertices[v[1]], model.vertices[v[2]], point);
      if (nearest.distance >= best.distance) continue;
      best = {{v.begin(), v.end()}, {nearest.weights.begin(), nearest.weights.end()}, nearest.distance};
    }
  }
  return best;
}

std::vector<Vec3> PlateResults::places() const {
  return root_ ? structure_.model().vertices : std::vector<Vec3>();
}

PlateResults::PlateResults(const Structure& structure)
    : structure_(structure),
      active_(!structure.context().output_folder.empty()),
      root_(parallel::comm_rank(structure.context().comm) == 0),
      surface_(mesh_of_surface(structure.context().comm, structure.model().vertices.size(),
                               structure.model().faces)) {
  const modes::ModalModel& model = structure.model();
  mesh::on_root(structure.context().comm, [&] {
    double size = 0;
    for (const Vec3& x : model.vertices) size = std::max(size, (x - model.vertices.front()).norm());
    for (const auto& [name, probe] : structure.parameters().probes) {
      probes_.push_back(nearest_place(model, probe.point));
      const double distance = probes_.back().distance;
      const double allowed = std::max(0.01 * size, structure.parameters().thickness);
      const Vec3& x = probe.point;
      if (distance > allowed)
        throw Error(
            "participants.{}.probes.{}: ({:g}, {:g}, {:g}) is {:.3g} m away from the surface of the structure; {:.3g} m at "
            "most is allowed.",
            structure.context().name, name, x.x(), x.y(), x.z(), distance, allowed);
      if (distance < 1e-6 * size) continue;
      Vec3 at = Vec3::Zero();
      for (std::size_t i = 0; i < probes_.back().vertices.size(); ++i)
        at += probes_.back().weights[i] * model.vertices[probes_.back().vertices[i]];
      log::info(
          "probes.{}: ({:g}, {:g}, {:g}) is {:.3g} m from the upper or lower face of the structure; moved to ({:g}, {:g}, {:g}).",
          name, x.x(), x.y(), x.z(), distance, at.x(), at.y(), at.z());
    }
  });
}

io::Series& PlateResults::series(std::optional<io::Series>& one, const char* file,
                                 const std::vector<std::string>& columns) {
  if (!one)
    one.emplace(structure_.context().output_folder / file, columns, structure_.context().restart_time);
  return *one;
}

void PlateResults::write_start() {
  if (root_) {
    log_size(structure_);
    const auto& frequency = structure_.model().frequency;
    std::string list;
    for (std::size_t m = 0; m < std::min<std::size_t>(8, frequency.size()); ++m)
      list += fmt::format(" {:.5g}", frequency[m]);
    log::info("{} modes, Hz:{}{}", frequency.size(), list, frequency.size() > 8 ? " ..." : "");
  }
  if (!active_) return;
  if (root_) write_frequencies();
  if (structure_.parameters().output.modes || structure_.parameters().analysis == Parameters::Analysis::modal)
    write_shapes();
}

void PlateResults::log() const {
  if (!root_) return;
  const std::vector<double>&frequency = structure_.model().frequency, &u = structure_.displacement();
  diagnostics::set_result({.name = "frequencies",
                           .unit = "Hz",
                           .values = {frequency.begin(), frequency.begin() + std::min<std::ptrdiff_t>(
                                                                                 5, std::ssize(frequency))}});
  if (structure_.parameters().analysis == Parameters::Analysis::modal || u.empty()) return;
  std::size_t most = 0;
  const auto size = [&](std::size_t v) { return Vec3(&u[3 * v]).norm(); };
  for (std::size_t v = 1; 3 * v < u.size(); ++v)
    if (size(v) > size(most)) most = v;
  diagnostics::set_result({.name = "largest displacement",
                           .unit = "m",
                           .values = {size(most)},
                           .place = diagnostics::place_text(structure_.model().vertices[most])});
}

void PlateResults::write_frequencies() {
  const modes::ModalModel& model = structure_.model();
  io::Series file(structure_.context().output_folder / "frequencies.csv",
                  {"mode", "frequency [Hz]", "effective mass x [kg]", "effective mass y [kg]",
                   "effective mass z [kg]", "largest displacement [1/sqrt(kg)]"});
  const std::size_t n = model.n_modes();
  for (std::size_t m = 0; m < n; ++m) {
    std::vector<double> row{double(m + 1), model.frequency[m]};
    for (int c = 0; c < 3; ++c) row.push_back(std::pow(model.participation[std::size_t(c) * n + m], 2));
    row.push_back(modes::largest_displacement(model, m));
    file.row(row);
  }
}

void PlateResults::write_shapes() {
  const modes::ModalModel& model = structure_.model();
  const std::size_t n = model.n_modes();
  io::FieldWriter writer(surface_, places(), structure_.context().output_folder, "modes-shapes", false,
                         std::numeric_limits<double>::quiet_NaN());
  for (std::size_t m = 0; m < n; ++m) {
    std::vector<double> shape(3 * surface_.point_id.size());
    const double largest = modes::largest_displacement(model, m);
    for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = model.vertex_shape[i * n + m] / largest;
    writer.write(double(m + 1), {}, {{"mode", "", io::OutputField::Place::points, 3, shape}});
  }
}

void PlateResults::write_fields(double time) {
  if (!active_ || !structure_.parameters().output.fields ||
      structure_.parameters().analysis == Parameters::Analysis::modal)
    return;
  std::vector<double> u, v;
  if (root_) u = structure_.displacement(), v = structure_.surface().motion(structure_.state().v);
  std::vector<Vec3> moved = places();
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += Vec3(&u[3 * i]);
  if (!fields_)
    fields_.emplace(surface_, places(), structure_.context().output_folder, structure_.context().name, true,
                    structure_.context().restart_time);
  fields_->write(time, moved,
                 {{"displacement", "m", io::OutputField::Place::points, 3, u},
                  {"velocity", "m/s", io::OutputField::Place::points, 3, v}});
}

void PlateResults::write_series(double time) {
  if (!active_ || structure_.parameters().analysis == Parameters::Analysis::modal || structure_.repeats())
    return;
  if (!root_) return;
  const std::vector<double>& u = structure_.displacement();
  if (structure_.contact()) write_contact(time);
  const ModalState& state = structure_.state();
  std::vector<std::string> columns{"time [s]"};
  for (std::size_t m = 1; m <= state.q.size(); ++m) columns.push_back(fmt::format("q{} [sqrt(kg) m]", m));
  std::vector<double> row{time};
  row.insert(row.end(), state.q.begin(), state.q.end());
  series(modal_, "modal.csv", columns).row(row);
  if (structure_.parameters().analysis == Parameters::Analysis::dynamic) write_energies(time);
  if (const auto& d = structure_.deflection())
    series(static_, "static.csv",
           {"time [s]", "largest [m]", "largest by modes [m]", "largest difference [m]"})
        .row(std::vector<double>{time, d->direct, d->by_modes, d->apart});
  if (probes_.empty()) return;
  columns = {"time [s]"};
  row = {time};
  for (const auto& [name, probe] : structure_.parameters().probes)
    for (const char* axis : {" x [m]", " y [m]", " z [m]"}) columns.push_back(name + axis);
  for (const SurfacePlace& place : probes_)
    for (int c = 0; c < 3; ++c) {
      double value = 0;
      for (std::size_t i = 0; i < place.vertices.size(); ++i)
        value += place.weights[i] * u[3 * std::size_t(place.vertices[i]) + c];
      row.push_back(value);
    }
  series(probe_series_, "probes.csv", columns).row(row);
}

void PlateResults::write_energies(double time) {
  const Energies& e = structure_.state().energies;
  series(energies_, "energies.csv",
         {"time [s]", "kinetic [J]", "strain [J]", "gravity [J]", "seat [J]", "work of loads [J]",
          "work of impact [J]", "damping loss [J]", "mismatch [J]"})
      .row(std::vector<double>{time, e.kinetic, e.strain, e.gravity, e.contact, e.load_work, e.impact_work,
                               e.damping_loss, e.mismatch()});
}

void PlateResults::write_contact(double time) {
  Contact::ContactResult seat;
  structure_.contact()->find(structure_.state().q, seat);
  series(contact_, "contact.csv", {"time [s]", "force [N]", "penetration [m]", "energy [J]"})
      .row(std::vector<double>{time, seat.total, seat.penetration, seat.energy});
}

}  // namespace couplet::plate
