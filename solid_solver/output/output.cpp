// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/output/output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/time_scheme.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "solid_solver/body/stress.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "solid_solver/output/files.hpp"

namespace couplet::solid {

using Place = io::OutputField::Place;

SolidSurfaces::SolidSurfaces(const SolidFields& derived, const SolidBody& body, const SolidContext& context)
    : derived_(derived),
      body_(body),
      context_(context),
      series_(body.mesh(), body.geometry().points, body.parameters().output.surfaces, "output.surfaces"),
      wanted_(series_.points()) {}

void SolidSurfaces::write(double time, std::span<const double> points, std::span<const Vec3> places) {
  if (!is_open_) series_.open(context_.output_folder, true, context_.restart_time);
  is_open_ = true;
  const int dim = body_.mesh().dim;
  SidedTensors sides = derived_.stress_sides(points, wanted_);
  std::vector<double> traction = derived_.traction(places, sides);
  const std::vector<double> stress = worst_side(std::move(sides));
  std::vector<double> equivalent(wanted_.size(), 0);
  for (std::size_t v = 0; v < wanted_.size(); ++v)
    if (wanted_[v])
      equivalent[v] = equivalent_stress(unpack(std::span(stress).subspan(v * tensor_size, tensor_size)));
  FieldList fields;
  fields.list.push_back({"displacement", "m", Place::points, dim, points});
  fields.add("traction", "Pa", Place::cells, dim, std::move(traction));
  fields.add_tensor("stress", "Pa", Place::points, dim, stress);
  fields.add("equivalent-stress", "Pa", Place::points, 1, std::move(equivalent));
  if (const TemperatureField* temperature = body_.temperature()) {
    fields.add("temperature", "K", Place::points, 1, temperature->of_points());
    if (temperature->heat())
      fields.add("heat-flux", "W/m^2", Place::cells, 1, temperature->heat()->boundary_inflow());
  }
  for (std::size_t i = 0; i < series_.patches().size(); ++i) series_.write(i, time, places, fields.list);
}

namespace {

/// Values of all local cells; ghosts, which are not written, contain zeros.
std::vector<double> packed_cells(const mesh::Mesh& mesh, std::span<const Tensor3> owned) {
  std::vector<double> values(std::size_t(mesh.cells.n_local()) * tensor_size, 0);
  for (std::size_t c = 0; c < owned.size(); ++c)
    std::ranges::copy(pack(owned[c]), values.begin() + std::ptrdiff_t(c * tensor_size));
  return values;
}

void add_cell_stress(const SolidBody& body, const SolidFields& derived, std::span<const double> points,
                     FieldList& fields) {
  if (!body.parameters().output.stress) return;
  const mesh::Mesh& mesh = body.mesh();
  const std::vector<Tensor3> tensors = derived.cell_stress(points);
  fields.add_tensor("stress", "Pa", Place::cells, mesh.dim, packed_cells(mesh, tensors));
  std::vector<double> equivalent(mesh.cells.n_local(), 0);
  for (std::size_t c = 0; c < tensors.size(); ++c) equivalent[c] = equivalent_stress(tensors[c]);
  fields.add("equivalent-stress", "Pa", Place::cells, 1, std::move(equivalent));
}

}  // namespace

SolidOutput::SolidOutput(const SolidFields& derived, const SolidStepper& stepper, const SolidBody& body,
                         const SolidContext& context)
    : derived_(derived),
      stepper_(stepper),
      body_(body),
      context_(context),
      probes_(body, derived),
      series_(context, body.mesh().comm) {
  if (!body.parameters().output.surfaces.empty()) surfaces_.emplace(derived, body, context);
}

void SolidOutput::write_fields(double time, int number, std::span<const double> points) {
  if (context_.output_folder.empty()) return;
  const int dim = body_.mesh().dim;
  std::vector<Vec3> places = body_.geometry().points;
  for (std::size_t v = 0; v < places.size(); ++v)
    for (int a = 0; a < dim; ++a) places[v][a] += points[v * dim + a];
  if (context_.fields.due(number)) write_volume(time, points, places);
  if (surfaces_) surfaces_->write(time, points, places);
}

void SolidOutput::write_volume(double time, std::span<const double> points, std::span<const Vec3> places) {
  const mesh::Mesh& mesh = body_.mesh();
  const SolidOutputParameters& chosen = body_.parameters().output;
  const SolidState& state = stepper_.state();
  const int dim = mesh.dim;
  if (!fields_)
    fields_.emplace(mesh, body_.geometry().points, context_.output_folder, context_.name, true,
                    context_.restart_time, context_.fields);
  FieldList fields;
  fields.list.push_back({"displacement", "m", Place::points, dim, points});
  if (body_.parameters().analysis == SolidParameters::Analysis::dynamic)
    fields.add("velocity", "m/s", Place::points, dim, derived_.point_velocity());
  fields.list.push_back({"cell-displacement", "m", Place::cells, dim, state.cell_u});
  if (chosen.acceleration && !state.acceleration.empty()) {
    fields.add("acceleration", "m/s^2", Place::points, dim, derived_.point_acceleration());
    fields.list.push_back({"cell-acceleration", "m/s^2", Place::cells, dim, state.acceleration});
  }
  add_cell_stress(body_, derived_, points, fields);
  if (chosen.strain)
    fields.add_tensor("strain", "-", Place::cells, dim, packed_cells(mesh, derived_.cell_strain(points)));
  if (chosen.point_stress)
    fields.add_tensor("point-stress", "Pa", Place::points, dim, derived_.point_stress(points));
  if (const TemperatureField* temperature = body_.temperature()) {
    fields.add("temperature", "K", Place::points, 1, temperature->of_points());
    fields.add("cell-temperature", "K", Place::cells, 1, temperature->of_cells());
  }
  fields_->write(time, places, fields.list);
}

void SolidOutput::write_series(double time, std::span<const double> points) {
  if (context_.output_folder.empty()) return;
  if (!probes_.empty()) write_probes(time, points);
  write_reactions(time, points);
  const SolverEffort& effort = stepper_.effort();
  if (effort.solves > 0)  // At the start there was no solve.
    series_.add("solver.csv", {"time [s]", "solves", "iterations", "inner iterations", "residual"},
                std::array{time, static_cast<double>(effort.solves), static_cast<double>(effort.iterations),
                           static_cast<double>(effort.inner_iterations), effort.residual});
  if (const LoadPath* path = body_.load_path())
    series_.add("path.csv",
                {"time [s]", "load factor [1]", "length [m]", "lowest stiffness [1]", "stable [1]"},
                std::array{time, path->factor(), path->length(), path->stiffness(),
                           path->stiffness() > 0 ? 1.0 : 0.0});
  if (body_.parameters().output.energies) {
    const SolidEnergies e = stepper_.ledger().total(stepper_.state(), points);
    series_.add(
        "energies.csv",
        {"time [s]", "kinetic [J]", "strain [J]", "internal work [J]", "external work [J]",
         "damping loss [J]", "lost by the scheme [J]"},
        std::array{time, e.kinetic, e.strain, e.internal_work, e.external_work, e.damping_loss, e.lost()});
  }
  if (body_.seat()) write_contact(time);
}

void SolidOutput::write_spectrum(double dt) {
  if (context_.output_folder.empty() || spectrum_written_) return;
  spectrum_written_ = true;
  const std::vector<std::complex<double>> values = eigenvalues(body_);
  if (parallel::comm_rank(body_.mesh().comm) != 0) return;
  const SolidParameters& p = body_.parameters();
  const SolidDamping chosen = p.damping.value_or(SolidDamping{});
  const time::RayleighCoefficients damping{chosen.mass, chosen.stiffness};
  io::Series series(context_.output_folder / "spectrum.csv",
                    {"number", "real [1/s^2]", "imaginary [1/s^2]", "frequency [Hz]", "growth rate [1/s]",
                     "growth rate of the scheme [1/s]"});
  double growth = 0, discrete = -std::numeric_limits<double>::infinity();
  int n_complex = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double rate = time::growth_rate(values[i]),
                 of_scheme = time::growth_rate(scheme_of(p), dt, values[i], damping);
    growth = std::max(growth, rate);
    discrete = std::max(discrete, of_scheme);
    n_complex += values[i].imag() != 0;
    series.row(std::vector<double>{double(i + 1), values[i].real(), values[i].imag(),
                                   std::sqrt(values[i]).real() / (2 * std::numbers::pi), rate, of_scheme});
  }
  log::info(
      "spectrum of M^-1 K: {} eigenvalues, {} of them in complex pairs; undamped vibration grows by up to "
      "{:.3g} 1/s; with {} and dt = {:g} s{} by up to {:.3g} 1/s",
      values.size(), n_complex, growth, time::name(scheme_of(p).type), dt, p.damping ? ", damped," : "",
      discrete);
}

void SolidOutput::write_probes(double time, std::span<const double> points) {
  std::vector<double> row = probes_.sample(points);
  std::vector<std::string> columns(probes_.columns().begin(), probes_.columns().end());
  row.insert(row.begin(), time);
  columns.insert(columns.begin(), "time [s]");
  series_.add("probes.csv", columns, row);
}

/// Uses spring forces at the accepted time, for a rigid seat those of the last solve.
void SolidOutput::write_contact(double time) {
  const Seat& seat = *body_.seat();
  const SolidState& state = stepper_.state();
  const std::vector<double> still(seat.is_rigid() ? seat.size() : 0, 0);
  const std::vector<double>& solved = stepper_.last_solve().contact;
  const Seat::Look seen =
      seat.look(seat.penetration(body_.unknowns_of(state.cell_u, state.face_u), state.known),
                seat.is_rigid() && !solved.empty() ? solved : still);
  series_.add("contact.csv",
              {"time [s]", "force [N]", "penetration [m]", "energy [J]", "largest pressure [Pa]",
               "area in contact [m^2]"},
              std::array{time, seen.force, seen.penetration, seen.energy, seen.pressure, seen.area});
}

void SolidOutput::write_reactions(double time, std::span<const double> points) {
  const int dim = body_.mesh().dim;
  const SolidOutputParameters& chosen = body_.parameters().output;
  const Vec3 load = derived_.total_load();
  const int first = dim == 2 ? 2 : 0;  // a plane scene turns about z
  std::vector<std::string> columns{"time [s]"};
  std::vector<double> row{time};
  const auto add = [&](const std::string& name, int axis, const char* unit, double value) {
    columns.push_back(name + " " + base::axis_letters[axis] + unit);
    row.push_back(value);
  };
  for (const PatchForce& r : derived_.reactions(points)) {
    const Vec3 moment = r.moment_about(Vec3::Zero());
    for (int a = 0; a < dim; ++a) add(r.patch, a, " [N]", r.force[a]);
    for (int a = first; chosen.moments && a < 3; ++a) add(r.patch + " moment", a, " [N m]", moment[a]);
  }
  for (int a = 0; a < dim; ++a) add("load", a, " [N]", load[a]);
  series_.add("reactions.csv", columns, row);
}

}  // namespace couplet::solid
