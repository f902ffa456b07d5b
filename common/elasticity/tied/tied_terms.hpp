// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/elasticity/symmetric/shared_edges.hpp"
#include "common/elasticity/symmetric/shared_faces.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/tied/tied_unknowns.hpp"

namespace couplet::elastic {

/// A part of a gradient: G = sum_i (T_i u_i) b_i^T, entry (k, j) = d u_k / d x_j.
struct TiedTerm {
  GlobalIndex block;  ///< of u_i, see TiedUnknowns
  Vec3 b;             ///< [1/m]
  Tensor3 turn;       ///< T: I, a projector, a mirror
};

/// Of the symmetric gradient at a flux face: its nodes and vertices, five or six. Known ones are left out.
std::vector<TiedTerm> face_terms(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                 const TiedUnknowns& unknowns, Index f);

/// Of the mean displacement on a boundary face by the trial functions: u = sum_i b_x T_i u_i.
std::vector<TiedTerm> mean_terms(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                 const TiedUnknowns& unknowns, Index f);

/// The mean gradients of the owned edges, one list an edge (empty: of another rank). Collective.
std::vector<std::vector<TiedTerm>> edge_terms(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                              const TiedUnknowns& unknowns, const SharedFaces& shared,
                                              const SharedEdges& edges);

}  // namespace couplet::elastic
