// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// Fraction of the largest diagonal entry for modes that move no cell (the spin of a single row of cells),
/// whose row would be empty.
inline constexpr double floor_of_diagonal = 1e-10;

/// Coarse space of rigid motions of cell aggregates. Slender bodies bend by slowly varying rotations, which
/// component-wise operators resolve slowly. Z holds the rigid modes (3 in 2-D, 6 in 3-D) of each aggregate.
/// The correction is Z (Z^T A Z)^-1 Z^T r. Z^T uses only cell rows; boundary nodes move with their cell.
///
/// Z^T A Z is assembled by faces, skipping those whose stencil lies in one aggregate, and factorized on every
/// rank.
class RigidCoarseSpace {
 public:
  /// `n_aggregates` is approximate, over all ranks. Collective.
  RigidCoarseSpace(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const double> inertia,
                   int n_aggregates);
  ~RigidCoarseSpace();

  /// Adds Z (Z^T A Z)^-1 Z^T r to z. Collective.
  void add_correction(std::span<const double> r, std::span<double> z) const;
  int n_aggregates() const { return static_cast<int>(centre_.size()); }

 private:
  struct Assembly;
  void number_aggregates(std::span<const Index> local, int n_here);
  Vec3 arm(Index cell) const { return geometry_->cell_centre[cell] - centre_[aggregate_[cell]]; }

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  const ElasticOperator* rows_;
  int modes_;
  std::vector<Index> aggregate_;  // of each local cell, over all ranks
  std::vector<Vec3> centre_;      // of all aggregates
  std::unique_ptr<Eigen::SparseLU<Eigen::SparseMatrix<double>>> factors_;
};

/// Partitions positions into nearly equal parts 0 .. n - 1 by repeated bisection along the longest side.
std::vector<Index> bisect(std::span<const Vec3> places, int n_parts);

}  // namespace couplet::elastic
