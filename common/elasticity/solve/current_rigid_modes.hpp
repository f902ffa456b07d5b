// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// What a coarse space of a deformed body must know of the present state. `gradient`: F of each flux face;
/// `displacement`: of each local node (cells, then boundary faces).
struct DeformedBody {
  std::vector<Tensor3> gradient;
  std::vector<Vec3> displacement;
};

/// Rigid motions of aggregates of cells about their present places: what bends a slender body is a slow
/// variation of rotations, which no component-wise operator sees cheaply, and which a body that has turned
/// carries out about where it is now. The correction is Z (Z^T A Z)^-1 Z^T r with the tangent's part that
/// strains, V dE : C : dE with dE = sym(F^T dF) and the law's constants at small strain, and the springs: never indefinite. A face
/// all of whose stencil lies in one aggregate carries nothing. Factorised whole on every rank.
class CurrentRigidModes {
 public:
  /// About `n_aggregates` over all ranks. `node_inertia`: of the unknown nodes [N/m]; empty: none.
  /// Mesh and rows by reference. Collective.
  CurrentRigidModes(const mesh::Mesh& mesh, const ElasticOperator& rows, int n_aggregates,
                    std::vector<double> node_inertia);
  /// Collective.
  void update(const DeformedBody& body);
  /// z += Z (Z^T A Z)^-1 Z^T r. Collective.
  void add_correction(std::span<const double> r, std::span<double> z) const;
  int n_aggregates() const { return static_cast<int>(centre_.size()); }

 private:
  Index aggregate_of(Index node) const;
  Vec3 place(Index node, const DeformedBody& body) const;
  Index unknown_node(std::size_t i) const;
  void add_faces(const DeformedBody& body, std::vector<double>& matrix) const;
  void add_springs(const DeformedBody& body, std::vector<double>& matrix) const;
  void add_inertia(std::vector<double>& matrix) const;
  Vec3 free_part(std::size_t i, const Vec3& v) const;
  void find_arms(const DeformedBody& body);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  int modes_;
  std::vector<double> inertia_;
  Numbering number_;              // nodes by themselves; negative: known
  std::vector<Index> aggregate_;  // of each local cell, over all ranks
  std::vector<Vec3> centre_;      // of all aggregates, present places
  std::vector<Vec3> arm_;         // of the unknown nodes from their centres
  std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> factors_;
};

}  // namespace couplet::elastic
