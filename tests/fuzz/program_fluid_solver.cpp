// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/parameters/parameters.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz {

std::string ProgramUnderTest::name() const { return "fluid_solver"; }

app::Program ProgramUnderTest::fresh() const {
  return {.name = name(),
          .description = "",
          .declare = with_fresh<fluid::FluidParameters>(
              [](config::Section& s, fluid::FluidParameters& p) { declare(s, p); })};
}

}  // namespace couplet::fuzz
