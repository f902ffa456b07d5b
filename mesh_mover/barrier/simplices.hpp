// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"

namespace couplet::mesh_mover {

/// The simplices that a barrier keeps from turning over: each triangle and tetrahedron by itself, of other cells one
/// at each corner, spanned by its edges there. Flat arrays over the local cells, those of owned cells first.
struct Simplices {
  int dim = 0;
  Index n_owned = 0;            ///< of owned cells: every simplex of the mesh counts on one rank
  std::vector<Index> points;    ///< dim + 1 local points each
  std::vector<double> inverse;  ///< of the reference edges, dim x dim by columns each [1/m]
  std::vector<double> weight;   ///< share of its cell's reference volume times (V / mean V)^-chi [m^dim]
  std::vector<Index> cell;      ///< local cell each
  double total = 0;             ///< sum of the weights over all ranks
  Index size() const { return static_cast<Index>(weight.size()); }
};

/// `volumes`: V per local cell. Throws SolveFailure if a simplex of the reference mesh is flat or inverted. Collective.
Simplices make_simplices(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double stiffening,
                         const std::vector<double>& volumes);

}  // namespace couplet::mesh_mover
