// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::fv {

/// Flux faces of each owned cell.
mesh::Csr flux_faces_of_cells(const mesh::Mesh& mesh);

/// Global number of each local node (cells, then boundary faces) as an unknown, or -1. A rank numbers its
/// owned cells, then its boundary faces with an unknown. A bonded face has the number of its twin.
/// Collective.
std::vector<GlobalIndex> number_nodes(const mesh::Mesh& mesh, std::span<const Index> faces_with_unknown);

/// Kinds of weights for a point's nodes, thesis (2.48)-(2.51), see VertexInterpolation:
///   w_i = (1 + lambda . r_i) / d_i,   r_i = (x_V - x_i) / d_i,   sum_i r_i r_i^T lambda = - sum_i r_i
/// `least_squares` replaces lambda . r_i by lambda . r_i d_i. All sums are over the nodes and may be taken in
/// parts (over ranks, or over the copies of a point on periodic patches).
enum class VertexWeights { inverse_distance, least_squares };

/// Sums that determine lambda.
struct VertexSums {
  Tensor3 m = Tensor3::Zero();
  Vec3 s = Vec3::Zero();
  double inverse_distance = 0, count = 0;

  /// Adds a node at distance `from` = x_V - x_i [m]. Only the part of its direction in `within` counts.
  void add(const Vec3& from, VertexWeights kind, const Tensor3* within) {
    const double d = from.norm();
    inverse_distance += 1 / d;
    count += 1;
    Vec3 r = from / d;
    if (within) r = *within * r;
    m += (kind == VertexWeights::least_squares ? d : 1) * r * r.transpose();
    s += r;
  }
  /// Least-norm solution in the subspace `within`.
  Vec3 lambda(int dim, const Tensor3* within) const;
};

/// Sums of the unnormalized weights.
struct VertexWeightSums {
  double sum = 0, squares = 0;
  Vec3 miss = Vec3::Zero();  ///< weighted mean of the x_V - x_i, times the sum

  void add(double weight, const Vec3& from) {
    sum += weight;
    squares += weight * weight;
    miss += weight * from;
  }
  /// Returns true if no weighted mean of the nodes reaches the point, so that plain inverse distance is used.
  bool cancels(const VertexSums& nodes) const;
  /// Returns true if the weighted mean of the nodes is the point, so that linear fields are exact.
  bool meets(const VertexSums& nodes, const Tensor3* within) const;
};

inline double vertex_weight(const Vec3& from, const Vec3& lambda, VertexWeights kind) {
  const double d = from.norm();
  return (1 + lambda.dot(from) / (kind == VertexWeights::least_squares ? 1 : d)) / d;
}

/// Stencil for values at the vertices of a patch.
enum class PatchStencil {
  open,      ///< cells and boundary faces around the vertex (traction, free surface, interface)
  fixed,     ///< only surrounding faces of fixed patches (Dirichlet)
  symmetry,  ///< cells mirrored at the patch; the patch's own faces carry no value
};

/// Values at mesh points from the surrounding nodes: cell centers and boundary face centers.
///
/// Modified inverse distance, thesis (2.48)-(2.51) with the erratum of (2.50):
///   w_i = (1 + lambda . r_i) / d_i,   r_i = (x_V - x_i) / d_i,   sum_i r_i r_i^T lambda = - sum_i r_i
/// It is exact for linear fields if the nodes span the space. Otherwise lambda is the least-norm solution
/// (exact along the spanned directions), or the plain inverse distance is used if no weighted mean reaches
/// the point. If n sum w^2 > 40, lambda . r_i d_i replaces lambda . r_i: least-squares weights, which are the
/// smallest possible. At Mesh::wide_points they use the nodes around all points of the point's cells.
///
/// At symmetry planes mirrored nodes need not be stored, since their weights equal those of the nodes. It
/// suffices to restrict lambda to the planes and to remove a vector's component across them (see project()).
///
/// Each material at a vertex has its own weights for its own nodes, and the value is the mean over the
/// materials. This is exact for fields that are linear in each of them.
///
/// Local cell i is node i, boundary face b (entry of mesh.boundary) is node mesh.cells.n_local() + b. Only
/// points of owned cells, whose whole surroundings are on this rank, have rows.
class VertexInterpolation {
 public:
  /// Magnification n sum w^2 of the weights of a point: 1 at the center of n nodes, 9 at the edge of
  /// hexahedra, 28 at a corner.
  static double magnification(std::span<const double> weights) {
    double squares = 0;
    for (const double w : weights) squares += w * w;
    return double(weights.size()) * squares;
  }

  /// `stencils` has one entry per patch. Keeps a reference to the mesh; of the geometry only the weights are
  /// stored.
  VertexInterpolation(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                      std::span<const PatchStencil> stencils);
  /// One stencil per local boundary face. `material_of_cell` is per local cell, or empty for one material.
  struct ByFace {
    std::vector<PatchStencil> stencil;
    std::span<const int> material_of_cell;
    /// Builds only the rows of points on boundary faces (including bonded ones). Others depend on no stencil.
    bool surface_only = false;
  };
  VertexInterpolation(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const ByFace& boundary);

  /// Recomputes the weights for new point positions without allocation.
  void update(const mesh::Geometry& geometry);

  std::span<const Index> nodes(Index point) const {
    return {node_.data() + offset_[point], std::size_t(offset_[point + 1] - offset_[point])};
  }
  std::span<const double> weights(Index point) const {
    return {weight_.data() + offset_[point], std::size_t(offset_[point + 1] - offset_[point])};
  }
  /// Returns true if the point lies on a fixed patch. Its row contains faces of fixed patches; callers may
  /// set a more accurate value.
  bool is_fixed(Index point) const { return fixed_[point] != 0; }
  /// Projector I minus the normals of the symmetry planes at the point, or I.
  const Tensor3& projector(Index point) const { return projectors_[projector_of_[point]]; }
  bool on_symmetry(Index point) const { return projector_of_[point] != 0; }
  /// Owned points whose value is not exact for linear fields, because their nodes do not span the space.
  /// Ascending; for the positions of the last update().
  const std::vector<Index>& inexact_points() const { return inexact_; }
  /// Points at which a symmetry patch is curved (neither flat nor at an edge).
  const std::vector<Index>& bent_points() const { return bent_; }

  /// Values at this point from `components` per node in `cells` and `boundary`, without projection.
  template <int Components>
  Vec<Components> scalar_at(Index point, std::span<const double> cells,
                            std::span<const double> boundary) const {
    Vec<Components> value = Vec<Components>::Zero();
    for (std::int64_t i = offset_[point]; i < offset_[point + 1]; ++i) {
      const double* node = node_[i] < n_cells_
                               ? cells.data() + std::size_t(node_[i]) * Components
                               : boundary.data() + std::size_t(node_[i] - n_cells_) * Components;
      for (int c = 0; c < Components; ++c) value[c] += weight_[i] * node[c];
    }
    return value;
  }
  /// Values of a vector field at this point, without components across symmetry planes.
  template <int D>
  Vec<D> vector_at(Index point, std::span<const double> cells, std::span<const double> boundary) const {
    const Vec<D> value = scalar_at<D>(point, cells, boundary);
    return on_symmetry(point) ? Vec<D>(projector(point).template topLeftCorner<D, D>() * value) : value;
  }

 private:
  struct Around;
  void gather_rows(const Around& around, const ByFace& boundary);
  void gather_wide_row(Index point, const Around& around, const ByFace& boundary);
  void group_by_material(Index point, std::span<const int> material_of_cell);
  void find_projectors(const Around& around, const mesh::Geometry& geometry,
                       std::span<const PatchStencil> stencil);
  bool fill_weights(Index point, std::int64_t first, std::int64_t last, const mesh::Geometry& geometry,
                    const Vec3& at, bool least_squares);
  bool find_weights(Index point, std::int64_t first, std::int64_t last, const mesh::Geometry& geometry,
                    const Vec3& at);

  const mesh::Mesh* mesh_;
  Index n_cells_;
  std::vector<std::int64_t> offset_;
  std::vector<Index> node_;
  // End of the nodes of each material, for points with several materials.
  std::vector<std::int64_t> ends_;
  // First entry of each point in ends_, or -1 for one material; empty if there is only one in total.
  std::vector<Index> ends_first_;
  std::vector<Index> inexact_, bent_;
  std::vector<double> weight_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Index> projector_of_;
  std::vector<Tensor3> projectors_;  // [0] is the identity
};

}  // namespace couplet::fv
