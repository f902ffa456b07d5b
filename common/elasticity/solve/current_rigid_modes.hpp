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

/// Current state of a deformed body: F of each flux face and the displacement of each local node (cells, then
/// boundary faces).
struct DeformedBody {
  std::vector<Tensor3> gradient;
  std::vector<Vec3> displacement;
};

/// Coarse space of rigid motions of cell aggregates about their current positions. Slender bodies bend by
/// slowly varying rotations, which component-wise operators resolve slowly. The correction is Z (Z^T A Z)^-1
/// Z^T r. A contains the springs and V dE : C : dE with dE = sym(F^T dF) and the small-strain constants, so
/// it is never indefinite. A face whose stencil lies in one aggregate has no contribution. The matrix is
/// factorized on every rank.
class CurrentRigidModes {
 public:
  /// `n_aggregates` is approximate, over all ranks. `node_inertia` is that of the unknown nodes [N/m], cells
  /// first, or empty. Keeps references to mesh and
  /// rows. Collective.
  CurrentRigidModes(const mesh::Mesh& mesh, const ElasticOperator& rows, int n_aggregates,
                    std::vector<double> node_inertia);
  /// Assembles and factorizes for the current state. Collective.
  void update(const DeformedBody& body);
  /// Adds Z (Z^T A Z)^-1 Z^T r to z. Collective.
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
  Numbering number_;              // one number per node; negative if known
  std::vector<Index> aggregate_;  // of each local cell, over all ranks
  std::vector<Vec3> centre_;      // of all aggregates, current positions
  std::vector<Vec3> arm_;         // from the center to each unknown node
  std::unique_ptr<Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>> factors_;
};

}  // namespace couplet::elastic
