// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace couplet::effects {

/// Where a run stands on a map of the atlas (docs/stability.md), in the terms of its axis.
struct Coordinate {
  std::string quantity;  ///< "Courant number"
  double value = 0;
  double limit = 0;    ///< up to here the map is green
  std::string map{};   ///< "fluid-convection"
  bool floor = false;  ///< true: from here up
  /// Of the way to the limit [1]: beyond it above 1. With a floor the way begins at 1, the best value.
  double used() const { return floor ? (1 - value) / (1 - limit) : value / limit; }
  /// For checkpoints.
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(quantity, value, limit, map, floor);
  }
};

/// The one of each quantity that is nearer to its limit.
void keep_nearest(std::vector<Coordinate>& kept, const std::vector<Coordinate>& seen);

/// "on the map: Courant number 0.8 of 1, ...; nearest limit: ..."; empty without coordinates.
std::string position_sentence(const std::vector<Coordinate>& position);

}  // namespace couplet::effects
