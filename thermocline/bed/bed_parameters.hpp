// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "thermocline/bed/closures.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

/// Horizontal layer of the bed.
struct BedLayer {
  double height = 0;                            ///< [m]
  double porosity = 0;                          ///< volume fraction of the liquid [1]
  double diameter = 0;                          ///< effective grain diameter [m]
  std::optional<FillerParameters> filler = {};  ///< grains of this layer; else those of the tank
  std::optional<Melting> melting = {};          ///< capsules instead of grains
};

/// Cells from the bottom up. Layer boundaries are cell faces, so masses are exact; the cells of a layer are
/// equal.
struct BedGrid {
  struct Run {
    int first, count;
    BedLayer layer;
  };
  BedGrid(const std::vector<BedLayer>& layers, int cells);

  std::vector<double> z, dz;  ///< centers and heights [m]
  std::vector<int> layer;     ///< of each cell
  std::vector<Run> runs;      ///< the cells of each layer
  double height = 0;
  int size() const { return int(z.size()); }
};

/// Advection scheme of the front.
enum class Advection {
  upwind,    ///< explicit, first order, as in the thesis; numerical diffusion G c dz (1 - Courant)/2
  tvd,       ///< explicit, van Leer's limiter, second order in space and time, bounded
  implicit,  ///< first-order upwind at the new time: any step, bounded
};

struct BedParameters {
  int cells = 500;
  std::vector<BedLayer> layers;  ///< from the bottom up
  int shells = 5;                ///< per grain
  Advection advection = Advection::upwind;
  double courant = 0.5;           ///< step relative to the advective limit; at most 0.5 for tvd, 1 for upwind
  bool conducting_inlet = false;  ///< heat conduction through the inlet face, too
  bool mix_inversions = false;    ///< mix cold fluid above hot fluid
  ClosureParameters closures;
  double initial_temperature = 293.15;                 ///< [K]
  std::vector<double> profile_z, profile_temperature;  ///< or a profile, piecewise linear
};
void declare(config::Section& section, BedParameters& parameters);

}  // namespace couplet::thermocline
