// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "common/linalg/petsc.hpp"
#include "plate_modal/body/rigid_body.hpp"
#include "plate_modal/structure.hpp"

int main(int argc, char** argv) {
  couplet::plate::Parameters parameters;
  const couplet::app::Program program{
      .name = "plate_modal",
      .description =
          "a structure of few degrees of freedom: a plate or any linear structure by its modes, or a rigid body",
      .declare = [&](couplet::config::Section& s) { couplet::plate::declare(s, parameters); },
      .make =
          [&](const couplet::app::ParticipantContext& c) -> std::unique_ptr<couplet::coupling::Participant> {
        const couplet::plate::PlateContext context{c.comm,          c.name,         c.case_folder,
                                                   c.output_folder, c.restart_time, c.simulation.time_step};
        if (parameters.body) return std::make_unique<couplet::plate::RigidBody>(parameters, context);
        return std::make_unique<couplet::plate::Structure>(parameters, context);
      },
      .diagnose =
          [](const couplet::coupling::Participant& participant, couplet::diagnostics::Diagnostics& all) {
            if (const auto* body = dynamic_cast<const couplet::plate::RigidBody*>(&participant))
              return add_diagnostics(*body, all);
            add_diagnostics(dynamic_cast<const couplet::plate::Structure&>(participant).view(), all);
          },
      .environment = couplet::linalg::petsc_environment,
      .problems_of_files =
          [&](const couplet::diagnostics::CaseScene& scene) {
            return couplet::plate::problems_of_files(parameters, scene.folder);
          }};
  return couplet::app::run_program(argc, argv, program);
}
