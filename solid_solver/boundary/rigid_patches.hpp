// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Patches whose faces move as rigid bodies with small angles: u_i = U + w x (x_i - c) at face centers x_i
/// (RBE2 elements). There is no penalty and no additional unknown: P A P u = P b is solved in the range of P,
/// the orthogonal projection onto such motions. Sums of rigid motions are rigid, so every time scheme
/// preserves them. Vertices are means of nodes as elsewhere: their share of a face's force acts on cells.
class RigidPatches {
 public:
  RigidPatches() = default;
  /// `faces`: of owned cells, one list per patch on all ranks. Each face must have an unknown. Collective.
  RigidPatches(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
               const std::vector<std::vector<Index>>& faces);

  bool empty() const { return patches_.empty(); }
  /// Applies P to unknowns of ElasticOperator. Collective.
  void project(std::span<double> unknowns) const;

 private:
  struct Patch {
    std::vector<std::size_t> node;   // index of the unknown
    std::vector<Vec3> arm;           // x_i - c
    double share = 0;                // 1 / number of faces of all ranks
    Tensor3 spin = Tensor3::Zero();  // inverse of sum (|r|^2 I - r r^T); zero about a line of faces
  };
  void make(Patch& patch) const;

  const mesh::Mesh* mesh_ = nullptr;
  std::vector<Patch> patches_;
};

}  // namespace couplet::solid
