// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"
#include "thermocline/model/elements.hpp"

int main(int argc, char** argv) {
  couplet::thermocline::ElementParameters parameters;
  couplet::app::Program program{
      .name = "thermocline",
      .description =
          "a packed-bed thermocline tank: bed, filler mechanics, shell, insulation, ullage, ground, plant",
      .declare = [&](couplet::config::Section& s) { couplet::thermocline::declare(s, parameters); },
      .make =
          [&](const couplet::app::ParticipantContext& context) {
            return couplet::thermocline::make_element(parameters, context);
          },
      .diagnose =
          [](const couplet::coupling::Participant& participant, couplet::diagnostics::Diagnostics& all) {
            if (const auto* tank = dynamic_cast<const couplet::thermocline::Tank*>(&participant))
              add_diagnostics(tank->view(), all);
          },
      .problems_of_files =
          [&](const couplet::diagnostics::CaseScene& scene) {
            return couplet::thermocline::problems_of_files(parameters, scene.folder);
          }};
  return couplet::app::run_program(argc, argv, program);
}
