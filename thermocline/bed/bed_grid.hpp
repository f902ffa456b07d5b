// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// A horizontal layer of the bed.
struct BedLayer {
  double height = 0;                    ///< [m]
  double porosity = 0;                  ///< volume of the liquid [1]
  double diameter = 0;                  ///< effective, of the grains [m]
  std::optional<Filler> filler = {};    ///< grains of its own; else those of the tank
  std::optional<Melting> melting = {};  ///< capsules in place of grains
};

/// Cells from the bottom up. Layers begin and end at cell faces, so masses are exact; within a layer cells
/// are equal.
struct BedGrid {
  struct Run {
    int first, count;
    BedLayer layer;
  };
  BedGrid(const std::vector<BedLayer>& layers, int cells);

  std::vector<double> z, dz;  ///< centres and heights [m]
  std::vector<int> layer;     ///< of each cell
  std::vector<Run> runs;      ///< the cells of each layer
  double height = 0;
  int size() const { return int(z.size()); }
};

}  // namespace couplet::thermocline
