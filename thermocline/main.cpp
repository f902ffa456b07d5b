// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "thermocline/judge/effect_cards.hpp"
#include "thermocline/judge/elsewhere.hpp"
#include "thermocline/judge/files.hpp"
#include "thermocline/judge/table.hpp"

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
      .diagnose = couplet::thermocline::add_diagnostics,
      .effects =
          [&](const couplet::diagnostics::CaseScene&) {
            return couplet::diagnostics::effects_of("thermocline", couplet::thermocline::effect_cards(),
                                                    parameters);
          },
      .problems_of_files =
          [&](const std::filesystem::path& folder) {
            return couplet::thermocline::problems_of_files(parameters, folder);
          }};
  return couplet::app::run_program(argc, argv, program);
}
