// SPDX-License-Identifier: Apache-2.0
#include "tests/coupling/toy/modal.hpp"

int main(int argc, char** argv) {
  using namespace couplet;
  toy::ModalParameters parameters;
  return app::run_program(
      argc, argv,
      {"toy_wall", "an elastic wall in sine modes", [&](config::Section& s) { declare(s, parameters); },
       [&](const app::ParticipantContext& context) -> std::unique_ptr<coupling::Participant> {
         return std::make_unique<toy::ModalWall>(parameters, context);
       }});
}
