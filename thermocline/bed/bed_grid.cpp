// SPDX-License-Identifier: Apache-2.0
#include "thermocline/bed/bed_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/error.hpp"

namespace couplet::thermocline {

BedGrid::BedGrid(const std::vector<BedLayer>& layers, int cells) {
  if (cells < int(layers.size()))
    throw Error("bed: {} cells are not enough for {} layers; each layer needs at least one.", cells,
                layers.size());
  for (const BedLayer& l : layers) height += l.height;
  // Faces of the layers at the nearest face of the uniform grid, each layer with a cell at least.
  std::vector<int> ends;
  double below = 0;
  const int n_layers = int(layers.size());
  for (int l = 0; l < n_layers; ++l) {
    below += layers[l].height;
    const int least = (ends.empty() ? 0 : ends.back()) + 1, most = cells - (n_layers - 1 - l);
    ends.push_back(l + 1 == n_layers ? cells
                                     : std::clamp(int(std::lround(below / height * cells)), least, most));
  }
  z.resize(cells), dz.resize(cells), layer.resize(cells);
  double bottom = 0;
  for (int l = 0, first = 0; l < n_layers; first = ends[l++]) {
    const int count = ends[l] - first;
    runs.push_back({first, count, layers[l]});
    for (int i = 0; i < count; ++i) {
      dz[first + i] = layers[l].height / count;
      z[first + i] = bottom + (i + 0.5) * dz[first + i];
      layer[first + i] = l;
    }
    bottom += layers[l].height;
  }
}

}  // namespace couplet::thermocline
