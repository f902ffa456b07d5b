// SPDX-License-Identifier: Apache-2.0
#include "tests/coupling/toy/spring.hpp"

int main(int argc, char** argv) {
  using namespace couplet;
  toy::SpringParameters parameters;
  return app::run_program(
      argc, argv,
      {"toy_spring", "masses on springs", [&](config::Section& s) { declare(s, parameters); },
       [&](const app::ParticipantContext& context) -> std::unique_ptr<coupling::Participant> {
         return std::make_unique<toy::Spring>(context.comm, parameters);
       }});
}
