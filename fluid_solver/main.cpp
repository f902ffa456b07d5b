// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "common/io/cut_mesh.hpp"
#include "common/linalg/petsc.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/participant.hpp"

int main(int argc, char** argv) {
  using namespace couplet;
  fluid::FluidParameters parameters;
  const app::Program program{
      .name = "fluid_solver",
      .description =
          "incompressible or weakly compressible flow on a moving mesh, second order in space and time",
      .declare = [&](config::Section& section) { fluid::declare(section, parameters); },
      .make =
          [&](const app::ParticipantContext& context) {
            mesh::LoadedMesh loaded =
                io::load_mesh(context.comm, context.case_folder / parameters.mesh, parameters.dimension,
                              parameters.mesh_parameters, fluid::periodic_patches(parameters), {}, false,
                              parameters.mesh_scale);
            for (auto& [patch, boundary] : parameters.boundaries)  // files are next to the case
              if (boundary.table)
                boundary.table->file = (context.case_folder / boundary.table->file).string();
            fluid::MotionLink link;
            if (context.mesh_peer != MPI_COMM_NULL)
              link = [peer = context.mesh_peer](const mesh::Mesh& m, std::span<const Vec3> points) {
                return coupling::make_mesh_motion_source(peer, m, points);
              };
            return fluid::make_participant(std::move(loaded), parameters,
                                           {context.name, context.output_folder, context.restart_time,
                                            context.simulation.fields, context.loads_at_rest},
                                           link);
          },
      .diagnose = [](const coupling::Participant& participant,
                     diagnostics::Diagnostics& all) { fluid::add_diagnostics(participant, all); },
      .environment = linalg::petsc_environment,
      .mesh =
          [&](const std::filesystem::path& folder) {
            return io::facts_of_file(folder / parameters.mesh, parameters.mesh_parameters,
                                     parameters.mesh_scale);
          },
      .choose =
          [&](const mesh::MeshFacts& mesh, const diagnostics::CaseScene& scene) {
            return fluid::choose_effects(parameters, mesh, scene);
          },
      .problems_of_files =
          [&](const diagnostics::CaseScene& scene) { return fluid::problems_of_files(parameters, scene); }};
  return app::run_program(argc, argv, program);
}
