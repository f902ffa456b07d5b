// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace couplet::config {

/// Physics that Couplet does not compute, and the words by which cases ask for it. `limit` and `instead` are the
/// cells of its row in docs/limitations.md, without markup.
struct MissingPhysics {
  std::string_view program;
  std::string_view words;  ///< keys and values, or parts of them between hyphens
  std::string_view limit, instead;
};

std::span<const MissingPhysics> missing_physics();

/// Returns what to do instead if a key or value asks a program for such physics, with the limit, or is one that
/// earlier versions had. Otherwise an empty text.
std::string limit_named_by(std::string_view key_or_value, std::string_view program);

}  // namespace couplet::config
