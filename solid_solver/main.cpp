// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "common/mesh/load.hpp"
#include "solid_solver/solid.hpp"

int main(int argc, char** argv) {
  couplet::SolidParameters parameters;
  const couplet::Program program{
      .name = "solid_solver",
      .description = "linear elasticity, static or dynamic, by the finite-volume method",
      .declare = [&](couplet::config::Section& section) { couplet::declare(section, parameters); },
      .make =
          [&](const couplet::ParticipantContext& context) {
            couplet::Mesh mesh = couplet::load_mesh(context.comm, context.case_folder / parameters.mesh,
                                                    parameters.dimension, parameters.mesh_parameters);
            return std::make_unique<couplet::Solid>(
                std::move(mesh), parameters,
                couplet::SolidContext{context.name, context.output_folder, context.restart_time});
          }};
  return couplet::run_program(argc, argv, program);
}
