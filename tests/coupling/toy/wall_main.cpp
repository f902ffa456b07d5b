// SPDX-License-Identifier: Apache-2.0
#include "tests/coupling/toy/modal.hpp"

int main(int argc, char** argv) {
  using namespace couplet;
  toy::ModalParameters parameters;
  return run_program(
      argc, argv,
      {"toy_wall", "an elastic wall in sine modes", [&](config::Section& s) { declare(s, parameters); },
       [&](const ParticipantContext& context) -> std::unique_ptr<Participant> {
         return std::make_unique<toy::ModalWall>(parameters, context);
       }});
}
