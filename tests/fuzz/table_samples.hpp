// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz {

/// One right file of each kind: tables, grids, flows, weather, a series.
std::vector<std::string> samples();
/// Files that nobody would write: no end of one thing, other formats.
std::vector<std::string> odd_files();
/// Some cells, separators, line ends replaced, rows made longer or shorter.
std::string mutate_cells(const std::string& text, Dice& dice);

/// Numbers, and one way of writing them.
struct WrittenTable {
  std::string bytes;
  std::vector<double> at, values;
  bool is_plain = false;  ///< decimal points, one separator: it must be read
};
WrittenTable random_table(Dice& dice);

/// A small file whose text is large.
struct Bomb {
  std::string what, bytes;
};
std::vector<Bomb> bombs();

}  // namespace couplet::fuzz
