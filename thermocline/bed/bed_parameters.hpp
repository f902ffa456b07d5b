// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thermocline/bed/closures.hpp"
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

/// How the front is carried.
enum class Advection {
  upwind,    ///< explicit, first order, as the thesis: its numerical diffusion is G c dz (1 - Courant)/2
  tvd,       ///< explicit, van Leer's limiter, second order in space and time, bounded
  implicit,  ///< first-order upwind at the new time: any step, stays bounded
};

struct BedParameters {
  int cells = 500;
  std::vector<BedLayer> layers;  ///< from the bottom up
  int shells = 5;                ///< in a grain
  Advection advection = Advection::upwind;
  double courant = 0.5;           ///< step over the advective limit; at most 0.5 for tvd, 1 for upwind
  bool conducting_inlet = false;  ///< heat conduction through the inlet face too
  bool mix_inversions = false;    ///< cold fluid above hot is mixed
  ClosureParameters closures;
  double initial_temperature = 293.15;                 ///< [K]
  std::vector<double> profile_z, profile_temperature;  ///< or a profile, piecewise linear
};
void declare(config::Section& section, BedParameters& parameters);

}  // namespace couplet::thermocline
