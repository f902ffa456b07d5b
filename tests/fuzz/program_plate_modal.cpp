// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/parameters.hpp"
#include "tests/fuzz/program.hpp"

namespace couplet::fuzz {

std::string ProgramUnderTest::name() const { return "plate_modal"; }

app::Program ProgramUnderTest::fresh() const {
  return {.name = name(),
          .description = "",
          .declare =
              with_fresh<plate::Parameters>([](config::Section& s, plate::Parameters& p) { declare(s, p); })};
}

}  // namespace couplet::fuzz
