// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/quadratic_fit.hpp"

namespace couplet::solid {

/// The strain energy of a displacement seen twice: as the operator counts it, by the strains of faces over their pyramids, and smooth,
/// by a quadratic a cell, fitted to the vertices of the cells that share one with it, integrated over the cell. How much they
/// differ says how wrong the operator's stiffness is for this displacement (recovered displacements: Naga and Zhang, SIAM J.
/// Numer. Anal. 42 (2004) 1780).
///
/// Beside the true error of the displacement (scripts/validate solid-accuracy): on triangles 0.3 to 1.2 of it on Cook's panel, a ring and
/// an orthotropic bar, where recovered strains see 0.02 to 1.1; far above it where structured triangles are
/// sheared and their errors cancel. On other cells it knows less than those: 0.3 to 40 on tetrahedra that bend.
class SmoothEnergy {
 public:
  /// By reference.
  SmoothEnergy(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
  /// Triangles alone. Collective.
  static bool is_of_use(const mesh::Mesh& mesh);

  /// Displacement gradient of a flux face; those of partition faces on both ranks.
  void add(Index face, const Tensor3& gradient);
  /// Share of the smooth energy by which the counted one differs; 0 where there is none. `point_u`: the displacement of
  /// all local points, `dim` values each [m]. Looks at some 20 000 cells at most, evenly
  /// taken. Collective.
  double missed(std::span<const double> point_u) const;

 private:
  struct Patch;
  void gather(Index cell, Patch& patch) const;
  double smooth_energy(Index cell, const Patch& patch, std::span<const double> point_u) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
  std::vector<double> counted_;  // of owned cells: sum V_fP G : C : G
};

}  // namespace couplet::solid
