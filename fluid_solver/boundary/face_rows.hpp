// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "fluid_solver/parameters/condition.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Consecutive boundary faces of one patch; on ranks without any `count` is 0.
struct FaceRange {
  Index first = 0, count = 0;
};

/// The FaceRow of every boundary face, and the faces by what of it they have. Arrays over "boundary faces" are indexed by
/// f - mesh.n_interior; lists ascend.
struct FaceRows {
  std::vector<double> pressure, slip_length, inflow;  ///< see FaceRow
  std::vector<Index> of_pressure;                     ///< the pressure is given
  std::vector<Index> of_flux;                         ///< all others: phi = w.S
  std::vector<Index> of_mesh;                         ///< of these: w is the normal velocity of the mesh
  std::vector<Index> of_velocity;                     ///< and the rest of them
  std::vector<char> with_mesh;                        ///< of all faces: w is the normal velocity of the mesh

  explicit FaceRows(Index count = 0)
      : pressure(count, 0.0), slip_length(count, 0.0), inflow(count, 1.0), with_mesh(count, 0) {}
  void set(const FaceRange& faces, const FaceRow& row, bool moves_with_mesh) {
    for (Index b = faces.first; b < faces.first + faces.count; ++b) {
      pressure[b] = row.pressure;
      slip_length[b] = row.slip_length;
      inflow[b] = row.inflow;
      with_mesh[b] = moves_with_mesh;
    }
  }
  /// Once all are set.
  void sort() {
    for (Index b = 0; b < static_cast<Index>(pressure.size()); ++b) {
      (pressure[b] > 0 ? of_pressure : of_flux).push_back(b);
      if (pressure[b] == 0) (with_mesh[b] ? of_mesh : of_velocity).push_back(b);
    }
  }

  /// t = S/(S + L g), the share of mu g (w - u_P) along the wall that friction has: 1 without slip, 0 without friction.
  /// `f`: the flux face of b.
  template <int D>
  double friction(const Placement<D>& at, Index b, Index f) const {
    const double area = at.area[f].norm();
    return area / (area + slip_length[b] * at.conductance[f]);
  }
};

}  // namespace couplet::fluid
