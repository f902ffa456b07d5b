// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/coupling/participant.hpp"

namespace couplet::coupling {

/// Values of a datum within a step, of participants that subdivide it: in an Exchange they stand beside the values at
/// its end by the name "datum@share", share of the step in (0, 1), for example "displacement@0.25". A participant that
/// asks for them announces "datum@" beside "datum" (docs/protocol.md).
struct WithinStep {
  static constexpr char mark = '@';
  static std::string name(const std::string& datum, double share);
  /// The datum and the share that a name stands for; nothing if it is no such name.
  static std::optional<std::pair<std::string, double>> parse(std::string_view name);
};

/// Calls visit(share, name, values) for the values of a datum within the step.
template <class Visit>
void for_within(const Exchange& data, const std::string& datum, Visit visit) {
  const std::string begins = datum + WithinStep::mark;
  for (auto it = data.lower_bound(begins); it != data.end() && it->first.starts_with(begins); ++it)
    if (const auto found = WithinStep::parse(it->first); found && found->first == datum)
      visit(found->second, it->first, it->second);
}

}  // namespace couplet::coupling
