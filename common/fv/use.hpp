// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "common/base/types.hpp"
#include "common/config/section.hpp"

namespace couplet::fv {

/// Record on this rank of the effect that a part of the case (an expression, a table, a body, an inlet) had in this run.
struct Use {
  /// An effect acts if it is ever other than 0. A table is read over a variable of the scene, a property over the
  /// temperature. The energy of the state is 0 at rest.
  enum class Kind { effect, table, property, energy } kind = Kind::effect;
  std::string given;        ///< its text, for messages
  config::KeyFacts key{};   ///< of an expression
  double from = 0, to = 0;  ///< range of a table
  // Smallest and largest effect; of a table, of its variable.
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  /// Largest amount by which values between two times exceed those at both, and where.
  double unseen = 0, unseen_at = 0;
  double last_time = std::numeric_limits<double>::quiet_NaN();  ///< latest at which it was evaluated [s]
  double since = last_time, earlier = last_time;  ///< the two times before it [s]; NaN if unknown
  Vec3 place = Vec3::Zero();                      ///< of the largest value

  void note(double value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  bool is_used() const { return lowest <= highest; }
  double largest() const { return std::max(-lowest, highest); }
  /// Archives what the run did.
  template <class Numbers>
  void visit(Numbers& numbers) {
    int what = int(kind);
    numbers(what, given, from, to, lowest, highest, unseen, unseen_at, last_time, since, earlier, place[0],
            place[1], place[2]);
    kind = Kind(what);
  }
};

/// Uses of this process by the name of the part. Each rank of a program has the same parts.
std::map<std::string, Use>& uses();

}  // namespace couplet::fv
