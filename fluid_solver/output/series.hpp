// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/io/series.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// Numbers of one time, each with its name and unit, "drag [-]".
using Row = std::vector<std::pair<std::string, double>>;

/// A file with one row per step, opened with the first row.
struct SeriesTable {
  std::string file;
  std::function<Row()> row;  ///< collective, counts on rank 0; empty: nothing is known yet
  std::optional<io::Series> series{};
};

/// The tables that the case asks for, and balance.csv. `walls`: patches that bear a force.
template <int D>
std::vector<SeriesTable> tables_of(const Fluid<D>& fluid, const std::vector<const mesh::Patch*>& walls);

}  // namespace couplet::fluid
