// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Patches whose faces move as rigid bodies, by small angles: u_i = U + w x (x_i - c) at the centres x_i of their faces (an RBE2 of
/// finite elements). No penalty and no unknowns of their own: with P the orthogonal projection of the unknowns on such motions,
/// P A P u = P b is solved within the range of P. Sums of rigid motions are rigid, so that every time scheme keeps them. Vertices are
/// means of the nodes around them, as elsewhere: what a face's trial function gives to them of its force acts on the cells there.
class RigidPatches {
 public:
  RigidPatches() = default;
  /// `faces`: of owned cells, by patch, as many patches on all ranks. The faces must have an unknown. Collective.
  RigidPatches(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
               const std::vector<std::vector<Index>>& faces);

  bool empty() const { return patches_.empty(); }
  /// P, on unknowns as ElasticOperator has them. Collective.
  void project(std::span<double> unknowns) const;

 private:
  struct Patch {
    std::vector<std::size_t> node;   // of the unknowns
    std::vector<Vec3> arm;           // x_i - c
    double share = 0;                // 1 / number of faces of all ranks
    Tensor3 spin = Tensor3::Zero();  // inverse of sum (|r|^2 I - r r^T); nothing about a line of faces
  };
  void make(Patch& patch) const;

  const mesh::Mesh* mesh_ = nullptr;
  std::vector<Patch> patches_;
};

}  // namespace couplet::solid
