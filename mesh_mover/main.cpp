// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "common/linalg/petsc.hpp"
#include "mesh_mover/diagnostics.hpp"
#include "mesh_mover/effect_cards.hpp"
#include "mesh_mover/mover.hpp"

int main(int argc, char** argv) {
  couplet::mesh_mover::Parameters parameters;
  couplet::app::Program program{
      .name = "mesh_mover",
      .description =
          "moves the mesh points with the interface or as prescribed, by a Laplacian, an elastic body or "
          "rotations",
      .declare = [&](couplet::config::Section& s) { couplet::mesh_mover::declare(s, parameters); },
      .make =
          [&](const couplet::app::ParticipantContext& context) {
            return std::make_unique<couplet::mesh_mover::Mover>(parameters, context);
          },
      .diagnose =
          [](const couplet::coupling::Participant& participant, couplet::diagnostics::Diagnostics& all) {
            couplet::mesh_mover::add_diagnostics(dynamic_cast<const couplet::mesh_mover::Mover&>(participant),
                                                 all);
          },
      .environment = couplet::linalg::petsc_environment,
      .effects =
          [&](const couplet::diagnostics::CaseScene&) {
            return couplet::diagnostics::effects_of("mesh_mover", couplet::mesh_mover::effect_cards(),
                                                    parameters);
          }};
  return couplet::app::run_program(argc, argv, program);
}
