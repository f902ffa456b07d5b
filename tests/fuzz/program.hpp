// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common/app/case/case_file.hpp"

namespace couplet::fuzz {

/// The keys of the program that this test is linked with.
class ProgramUnderTest {
 public:
  std::string name() const;
  /// Bound to parameters that nothing has been read into yet.
  app::Program fresh() const;
};

/// The declaration for parameters of its own, which live as long as it.
template <class Parameters, class Declare>
config::Section::Declare with_fresh(Declare declare) {
  return
      [parameters = std::make_shared<Parameters>(), declare](config::Section& s) { declare(s, *parameters); };
}

}  // namespace couplet::fuzz
