// SPDX-License-Identifier: Apache-2.0
#include "coupler/coupler.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz {

std::string ProgramUnderTest::name() const { return "coupler"; }

app::ProgramKind ProgramUnderTest::fresh() const {
  return {name(), "", true,
          with_fresh<coupler::CouplingParameters>(
              [](config::Section& s, coupler::CouplingParameters& p) { coupler::declare(s, p); })};
}

}  // namespace couplet::fuzz
