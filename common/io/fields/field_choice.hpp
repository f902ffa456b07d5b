// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "common/base/types.hpp"

namespace couplet::io {

/// What of the fields in the volume is written, and how.
struct FieldChoice {
  int every = 1;        ///< at each n-th output; 0: never
  int compression = 0;  ///< level of deflate, 0 to 9
  struct Box {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< [m]
  };
  std::optional<Box> box;  ///< only cells whose mean of points at rest lies in it

  bool due(int number) const { return every > 0 && number % every == 0; }
};

}  // namespace couplet::io
