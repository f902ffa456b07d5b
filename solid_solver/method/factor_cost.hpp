// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// What the factors of the symmetric gradient's matrix cost beside multigrid, processor seconds of one core of the machine
/// that benchmarks/linalg/factors.csv was measured on; their ratios are what counts.
struct FactorCost {
  double entries;   ///< non-zeros of the factors
  double set_up;    ///< [s]
  double solve;     ///< with the factors [s]
  double by_cycle;  ///< a solve by conjugate gradients with multigrid [s]
  /// So many solves with one matrix are as cheap by factors as by multigrid; infinity: never.
  double pays_after() const;
  /// They fit into the memory that a body of this size may take.
  bool fits() const { return entries <= most_entries; }

  static constexpr double most_entries = 1e8;  // 1 GB
};

/// Estimated from the mesh: nested dissection leaves N log2 N entries of a plane's matrix [george1973] and N (N / l)^(1/3) of
/// a body l times as long as thick, N the blocks of rows. `heaviness`: see newton_krylov.hpp. Collective.
FactorCost factor_cost(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double heaviness);

}  // namespace couplet::solid
