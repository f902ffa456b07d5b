// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/program.hpp"
#include "thermocline/model/elements.hpp"

namespace couplet::fuzz {

std::string ProgramUnderTest::name() const { return "thermocline"; }

app::Program ProgramUnderTest::fresh() const {
  return {.name = name(),
          .description = "",
          .declare = with_fresh<thermocline::ElementParameters>(
              [](config::Section& s, thermocline::ElementParameters& p) { declare(s, p); })};
}

}  // namespace couplet::fuzz
