// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/app/program.hpp"
#include "common/io/cut_mesh.hpp"
#include "common/linalg/petsc.hpp"
#include "solid_solver/boundary/checks.hpp"
#include "solid_solver/choices.hpp"
#include "solid_solver/solid.hpp"

namespace {

// Passes of a coupling per step, with one solve each.
constexpr double passes = 3;

/// Approximate number of solves with one matrix in the run.
double solves_of(const couplet::app::ParticipantContext& context) {
  const double steps = std::max(1.0, std::round(context.simulation.end_time / context.simulation.time_step));
  return context.coupled ? passes * steps : steps;
}

}  // namespace

int main(int argc, char** argv) {
  couplet::solid::SolidParameters parameters;
  const couplet::app::Program program{
      .name = "solid_solver",
      .description =
          "linear thermoelasticity, static or dynamic, and heat conduction, by the finite-volume method",
      .declare = [&](couplet::config::Section& section) { declare(section, parameters); },
      .make = [&](const couplet::app::ParticipantContext& context)
          -> std::unique_ptr<couplet::coupling::Participant> {
        couplet::mesh::LoadedMesh body = couplet::io::load_mesh(
            context.comm, context.case_folder / parameters.mesh, parameters.dimension,
            parameters.mesh_parameters, {}, couplet::solid::zones_of(parameters.materials), true,
            parameters.mesh_scale,
            parameters.touching_faces == couplet::solid::SolidParameters::TouchingFaces::tie);
        couplet::solid::check_touching(body, parameters);
        const couplet::solid::SolidContext where{context.name, context.output_folder, context.restart_time,
                                                 context.simulation.fields};
        parameters.method.solves = solves_of(context);
        if (parameters.analysis == couplet::solid::SolidParameters::Analysis::thermal)
          return std::make_unique<couplet::solid::ThermalSolid>(std::move(body), parameters, where);
        return std::make_unique<couplet::solid::Solid>(std::move(body), parameters, where);
      },
      .diagnose =
          [&](couplet::coupling::Participant& participant, couplet::diagnostics::Diagnostics& all) {
            if (parameters.analysis == couplet::solid::SolidParameters::Analysis::thermal)
              add_diagnostics(static_cast<couplet::solid::ThermalSolid&>(participant).view(), all);
            else
              add_diagnostics(static_cast<couplet::solid::Solid&>(participant).view(), all);
          },
      .environment = couplet::linalg::petsc_environment,
      .mesh =
          [&](const std::filesystem::path& folder) {
            return couplet::io::facts_of_file(folder / parameters.mesh, parameters.mesh_parameters,
                                              parameters.mesh_scale);
          },
      .choose =
          [&](const couplet::mesh::MeshFacts& mesh, const couplet::diagnostics::CaseScene& scene) {
            return couplet::solid::choose_effects(parameters, mesh, scene);
          }};
  return couplet::app::run_program(argc, argv, program);
}
