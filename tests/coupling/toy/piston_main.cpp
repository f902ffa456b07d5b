// SPDX-License-Identifier: Apache-2.0
#include "tests/coupling/toy/piston.hpp"

int main(int argc, char** argv) {
  using namespace couplet;
  toy::PistonParameters parameters;
  return app::run_program(
      argc, argv,
      {"toy_piston", "a fluid that is an added mass", [&](config::Section& s) { declare(s, parameters); },
       [&](const app::ParticipantContext& context) -> std::unique_ptr<coupling::Participant> {
         return std::make_unique<toy::Piston>(context, parameters);
       }});
}
