// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/parameters.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz {

std::string ProgramUnderTest::name() const { return "mesh_mover"; }

app::Program ProgramUnderTest::fresh() const {
  return {.name = name(),
          .description = "",
          .declare = with_fresh<mesh_mover::Parameters>(
              [](config::Section& s, mesh_mover::Parameters& p) { declare(s, p); })};
}

}  // namespace couplet::fuzz
