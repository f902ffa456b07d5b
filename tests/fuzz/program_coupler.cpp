// SPDX-License-Identifier: Apache-2.0
#include "coupler/coupler.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz {

std::string ProgramUnderTest::name() const { return "coupler"; }

app::Program ProgramUnderTest::fresh() const {
  return {.name = name(),
          .description = "",
          .declare = with_fresh<coupler::CouplingParameters>(
              [](config::Section& s, coupler::CouplingParameters& p) { coupler::declare(s, p); }),
          .is_coupler = true};
}

}  // namespace couplet::fuzz
