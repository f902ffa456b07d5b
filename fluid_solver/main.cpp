// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "common/io/cut/cut_mesh.hpp"
#include "common/linalg/petsc.hpp"
#include "fluid_solver/boundary/given_velocity.hpp"
#include "fluid_solver/parameters/auto_effects.hpp"
#include "fluid_solver/parameters/effect_cards.hpp"
#include "fluid_solver/participant.hpp"

int main(int argc, char** argv) {
  couplet::fluid::FluidParameters parameters;
  const couplet::app::Program program{
      .name = "fluid_solver",
      .description =
          "incompressible or weakly compressible flow on a moving mesh, second order in space and time",
      .declare = [&](couplet::config::Section& section) { couplet::fluid::declare(section, parameters); },
      .make =
          [&](const couplet::app::ParticipantContext& context) {
            couplet::mesh::LoadedMesh loaded = couplet::io::load_mesh(
                context.comm, context.case_folder / parameters.mesh, parameters.dimension,
                parameters.mesh_parameters, couplet::fluid::periodic_patches(parameters), {}, false,
                parameters.mesh_scale);
            for (auto& [patch, boundary] : parameters.boundaries)  // files lie beside the case
              if (boundary.table)
                boundary.table->file = (context.case_folder / boundary.table->file).string();
            couplet::fluid::MotionLink link;
            if (context.mesh_peer != MPI_COMM_NULL)
              link = [peer = context.mesh_peer](const couplet::mesh::Mesh& m,
                                                std::span<const couplet::Vec3> points) {
                return couplet::coupling::make_mesh_motion_source(peer, m, points);
              };
            return couplet::fluid::make_participant(
                std::move(loaded), parameters,
                {context.name, context.output_folder, context.restart_time, context.simulation.fields}, link);
          },
      .diagnose =
          [](const couplet::coupling::Participant& participant, couplet::diagnostics::Diagnostics& all) {
            couplet::fluid::add_diagnostics(participant, all);
          },
      .environment = couplet::linalg::petsc_environment,
      .effects =
          [&](const couplet::diagnostics::CaseScene& scene) {
            return couplet::diagnostics::effects_of(
                "fluid_solver", couplet::fluid::fluid_effect_cards(),
                couplet::fluid::FluidScene{parameters, scene.has_mover || parameters.motion, scene.coupled});
          },
      .choose =
          [&](const couplet::diagnostics::CaseScene& scene) {
            return couplet::fluid::choose_effects(
                parameters,
                couplet::io::facts_of_file(scene.folder / parameters.mesh, parameters.mesh_parameters,
                                           parameters.mesh_scale),
                scene);
          },
      .expected =
          [&](const couplet::diagnostics::CaseScene& scene) {
            return couplet::fluid::expected_cost(
                parameters, couplet::io::facts_of_file(scene.folder / parameters.mesh,
                                                       parameters.mesh_parameters, parameters.mesh_scale));
          },
      .problems_of_files =
          [&](const std::filesystem::path& folder) {
            return couplet::fluid::problems_of_files(parameters, folder);
          }};
  return couplet::app::run_program(argc, argv, program);
}
