// SPDX-License-Identifier: Apache-2.0
// Free vibrations and buckling in SolidOutput.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/diagnostics/results.hpp"
#include "common/log/log.hpp"
#include "common/modes/modal_model.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "solid_solver/output/output.hpp"

namespace couplet::solid {
namespace {

/// [kg]
std::vector<double> cell_masses(const SolidBody& body) {
  std::vector<double> mass;
  for (Index c = 0; c < body.mesh().cells.n_owned(); ++c)
    mass.push_back(body.density(c) * body.geometry().volume[c]);
  return mass;
}

}  // namespace

std::string missing_shapes(const SolidBody& body) {
  const SolidParameters& p = body.parameters();
  std::vector<std::string> planes;
  for (const mesh::Patch& patch : body.mesh().patches) {
    const auto found = p.boundaries.find(patch.name);
    if (found != p.boundaries.end() && is_symmetry_plane(found->second)) planes.push_back(patch.name);
  }
  return couplet::modes::missing_by_symmetry(
      planes, "'type: fixed-displacement' with 'components' of 0 along the plane");
}

void SolidOutput::write_modes() {
  if (context_.output_folder.empty() || modes_written_) return;
  modes_written_ = true;
  const std::optional<SolidProblem> problem = vibration(body_);
  if (!problem)
    throw Error(
        "output.modes: free vibrations require 'analysis: dynamic' and 'solution-method: {face-gradient: "
        "symmetric}': the stiffness of the other face gradients is not symmetric.");
  const std::vector<double> mass = cell_masses(body_);
  const int n = body_.parameters().output.modes;
  modes::EigenModes found;
  try {
    found = solid_modes(*problem, body_.parameters().method, mass, n);
  } catch (const SolveFailure& e) {
    throw Error("output.modes: {}", e.what());  // no shorter step would help
  }
  write_vibrations(*problem, found, "");
}

/// Writes shapes to <file>.h5 and .xdmf, as point fields <name>-1, ... Collective.
void SolidOutput::write_shapes(const char* file, const char* name,
                               const std::vector<std::vector<double>>& shapes) {
  const mesh::Mesh& mesh = body_.mesh();
  std::vector<std::vector<double>> points;
  std::vector<io::OutputField> fields;
  for (const std::vector<double>& shape : shapes) {
    std::vector<double>& values =
        points.emplace_back(std::size_t(mesh.points.n_local()) * std::size_t(mesh.dim));
    body_.kernel().point_values(shape, {}, values);
    mesh.points.update_ghosts(values, mesh.dim);
  }
  for (std::size_t m = 0; m < points.size(); ++m)
    fields.push_back(
        {fmt::format("{}-{}", name, m + 1), "-", io::OutputField::Place::points, mesh.dim, points[m]});
  if (!fields.empty())
    io::FieldWriter(mesh, body_.geometry().points, context_.output_folder, file, false,
                    std::numeric_limits<double>::quiet_NaN())
        .write(stepper_.state().time, body_.geometry().points, fields);
}

/// `of`: object that vibrates, for the log.
void SolidOutput::write_vibrations(const SolidProblem& problem, const modes::EigenModes& found,
                                   const char* of) {
  const mesh::Mesh& mesh = body_.mesh();
  modes::ModalModel model = modal_model(problem, found);
  model.mass = 0;
  for (const double m : cell_masses(body_)) model.mass += m;
  model.mass = parallel::sum(mesh.comm, model.mass);
  std::vector<double> errors = mode_errors(body_, found);
  write_shapes("mode-shapes", "mode", found.shape);
  if (parallel::comm_rank(mesh.comm) != 0) return;
  io::Series series(context_.output_folder / "modes.csv",
                    {"number", "frequency [Hz]", "effective mass x [kg]", "effective mass y [kg]",
                     "effective mass z [kg]"});
  for (std::size_t m = 0; m < model.n_modes(); ++m) {
    std::vector<double> row{double(m + 1), model.frequency[m]};
    for (std::size_t a = 0; a < 3; ++a)
      row.push_back(std::pow(model.participation[a * model.n_modes() + m], 2));
    series.row(row);
  }
  if (mesh.dim == 3) couplet::modes::write_modes(context_.output_folder / "modes.h5", model, "");
  const auto first = std::ranges::find_if(model.frequency, [](double f) { return f > 0; });
  const std::ptrdiff_t rigid = first - model.frequency.begin(), left = model.frequency.end() - first;
  const double error = errors.empty() ? 0 : std::ranges::max(errors);
  const std::string name =
      fmt::format("free vibrations{}", rigid > 0 ? fmt::format(" after {} rigid-body modes", rigid) : "");
  diagnostics::set_result({name, "Hz", {first, first + std::min<std::ptrdiff_t>(5, left)}});
  diagnostics::set_errors(name, std::move(errors));
  log::info(
      "modes: {} free vibrations{} from {:.6g} to {:.6g} Hz in modes.csv, shapes in mode-shapes.xdmf{}; max residual {:.1e}; estimated error due "
      "to the mesh up to {:.2g} %",
      model.n_modes(), of, model.frequency.front(), model.frequency.back(),
      mesh.dim == 3 ? ", their surface shapes in modes.h5 (plate_modal: 'modes: {file: ...}')" : "",
      found.worst_residual, 100 * error);
}

void SolidOutput::write_preloaded_modes() {
  if (context_.output_folder.empty()) return;
  const elastic::Prestress prestress =
      prestress_of(body_, derived_, stepper_.state().time, stepper_.last_solve().interface);
  try {
    const modes::EigenModes found = preloaded_modes(body_, prestress, body_.parameters().output.modes);
    write_vibrations({body_.mesh(), body_.elastic(), {}, body_.kernel(), 0}, found,
                     " about the loaded equilibrium");
  } catch (const SolveFailure& e) {
    throw Error("output.modes: {}", e.what());
  }
}

void SolidOutput::write_buckling() {
  if (context_.output_folder.empty()) return;
  const mesh::Mesh& mesh = body_.mesh();
  const int asked = body_.parameters().output.buckling;
  Buckling found;
  try {
    found = find_buckling(
        body_, prestress_of(body_, derived_, stepper_.state().time, stepper_.last_solve().interface), asked);
  } catch (const SolveFailure& e) {
    throw Error("output.buckling: {}", e.what());
  }
  write_shapes("buckling", "buckling", found.shape);
  if (parallel::comm_rank(mesh.comm) == 0) {
    if (!found.factor.empty()) diagnostics::set_result({"load factors of buckling", "1", found.factor});
    io::Series series(context_.output_folder / "buckling.csv", {"number", "load factor [-]"});
    for (std::size_t m = 0; m < found.factor.size(); ++m)
      series.row(std::vector<double>{double(m + 1), found.factor[m]});
    if (found.factor.empty())
      log::info("buckling: these loads cannot buckle the body at any magnitude");
    else
      log::info(
          "buckling: the loads at the end multiplied by {:.6g} buckle the body; {} factors in buckling.csv, "
          "shapes in buckling.xdmf",
          found.factor.front(), found.factor.size());
  }
  if (!found.factor.empty()) buckling_factor_ = found.factor.front();
}

}  // namespace couplet::solid
