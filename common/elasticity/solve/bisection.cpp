// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/elasticity/solve/rigid_coarse_space.hpp"

namespace couplet::elastic {

std::vector<Index> bisect(std::span<const Vec3> places, int n_parts) {
  std::vector<Index> order(places.size()), part(places.size());
  std::iota(order.begin(), order.end(), 0);
  struct Piece {
    std::size_t first, last;
    int part, n;
  };
  std::vector<Piece> open{{0, places.size(), 0, n_parts}};
  while (!open.empty()) {
    const Piece piece = open.back();
    open.pop_back();
    if (piece.n <= 1) {
      for (std::size_t i = piece.first; i < piece.last; ++i) part[order[i]] = piece.part;
      continue;
    }
    Vec3 lower = Vec3::Constant(std::numeric_limits<double>::max()), upper = -lower;
    for (std::size_t i = piece.first; i < piece.last; ++i) {
      lower = lower.cwiseMin(places[order[i]]);
      upper = upper.cwiseMax(places[order[i]]);
    }
    int axis = 0;
    (upper - lower).maxCoeff(&axis);
    const int half = piece.n / 2;
    const std::size_t middle = piece.first + (piece.last - piece.first) * half / piece.n;
    std::nth_element(
        order.begin() + piece.first, order.begin() + middle, order.begin() + piece.last,
        [&](Index a, Index b) { return std::pair(places[a][axis], a) < std::pair(places[b][axis], b); });
    open.push_back({piece.first, middle, piece.part, half});
    open.push_back({middle, piece.last, piece.part + half, piece.n - half});
  }
  return part;
}

}  // namespace couplet::elastic
