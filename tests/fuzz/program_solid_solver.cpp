// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/parameters.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz {

using namespace solid;

std::string ProgramUnderTest::name() const { return "solid_solver"; }

app::Program ProgramUnderTest::fresh() const {
  return {
      .name = name(),
      .description = "",
      .declare = with_fresh<SolidParameters>([](config::Section& s, SolidParameters& p) { declare(s, p); })};
}

}  // namespace couplet::fuzz
