// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"
#include "mesh_mover/barrier/held_points.hpp"
#include "mesh_mover/barrier/simplices.hpp"

namespace couplet::mesh_mover {

/// Distortion energy of the simplices of a mesh, its gradient and its projected Hessian over the owned points. Positions
/// and directions: dim values per local point, ghosts current.
class BarrierSystem {
 public:
  enum class Hessian { exact, projected };
  /// All by reference. Collective.
  BarrierSystem(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Simplices& simplices,
                const HeldPoints& held);

  /// Sum of weight x W; infinite if a simplex is not positive. Collective.
  double energy(std::span<const double> displacement) const;
  /// Fills the matrix P H P + (I - P), where H may be without the negative parts of its simplices, and gives
  /// `residual` = -P (g + H `known`): right-hand side of the step that moves
  /// the held directions by `known`. Collective.
  void assemble(std::span<const double> displacement, std::span<const double> known,
                std::vector<double>& residual, Hessian hessian);
  /// Largest share of `direction`, at most 1, along which no simplex falls below `least` of its volume. Collective.
  double largest_step(std::span<const double> displacement, std::span<const double> direction,
                      double least) const;
  /// Where the cell with the largest energy per weight lies [m], moved. Collective.
  Vec3 worst_place(std::span<const double> displacement) const;
  const linalg::SparseMatrix& matrix() const { return *matrix_; }

 private:
  template <int D>
  void add_simplices(std::span<const double> displacement, std::span<const double> known,
                     std::vector<double>& residual, Hessian hessian);
  template <int D>
  void finish_rows(std::vector<double>& residual);
  void make_pattern();

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const Simplices& simplices_;
  const HeldPoints& held_;
  int dim_;
  mesh::Csr graph_;              // per owned point: local points of the simplices around it
  std::vector<Index> diagonal_;  // per owned point: its own entry of the graph
  std::vector<Index> entry_;  // per simplex and pair of its points: entry of the graph, -1: not an owned row
  std::vector<double> blocks_;  // per entry of the graph: dim x dim by rows
  std::unique_ptr<linalg::SparseMatrix> matrix_;
};

}  // namespace couplet::mesh_mover
