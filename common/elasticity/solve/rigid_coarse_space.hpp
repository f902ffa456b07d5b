// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::elastic {

/// A mode that moves no cell (the spin of a single row of cells) has an empty row; this part of the largest diagonal
/// keeps it solvable, its amplitude is nothing.
inline constexpr double floor_of_diagonal = 1e-10;

/// Rigid motions of aggregates of cells as a coarse space for elasticity: what bends a slender body is a slow
/// variation of rotations, which no component-wise operator sees cheaply. With Z the rigid modes (3 in 2-D, 6
/// in 3-D) of each aggregate, the correction is Z (Z^T A Z)^-1 Z^T r; Z^T looks at cell rows only, boundary
/// nodes move with their cell.
///
/// Z^T A Z is assembled face by face: a face all of whose stencil lies in one aggregate carries no force. It
/// is factorised whole on every rank.
class RigidCoarseSpace {
 public:
  /// About `n_aggregates` over all ranks. Collective.
  RigidCoarseSpace(const mesh::Mesh& mesh, const ElasticOperator& rows, std::span<const double> inertia,
                   int n_aggregates);
  ~RigidCoarseSpace();

  /// z += Z (Z^T A Z)^-1 Z^T r. Collective.
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

/// Parts 0 .. n - 1 of nearly equal size by halving along the longest side again and again.
std::vector<Index> bisect(std::span<const Vec3> places, int n_parts);

}  // namespace couplet::elastic
