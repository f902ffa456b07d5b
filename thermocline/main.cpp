// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"
#include "thermocline/tank.hpp"

int main(int argc, char** argv) {
  couplet::thermocline::TankParameters parameters;
  couplet::Program program{
      .name = "thermocline",
      .description =
          "a packed-bed thermocline tank: bed, filler mechanics, shell, insulation, ullage, ground, plant",
      .declare = [&](couplet::config::Section& s) { couplet::thermocline::declare(s, parameters); },
      .make =
          [&](const couplet::ParticipantContext& context) {
            return std::make_unique<couplet::thermocline::Tank>(parameters, context);
          }};
  return couplet::run_program(argc, argv, program);
}
