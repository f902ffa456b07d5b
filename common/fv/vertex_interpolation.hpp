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

/// Global number of each local node (cells, then boundary faces) as an unknown, -1: none. A rank numbers its
/// owned cells, then these boundary faces of its own; a bonded face has the number of its twin. Collective.
std::vector<GlobalIndex> number_nodes(const mesh::Mesh& mesh, std::span<const Index> faces_with_unknown);

/// How the weights of a point's nodes are found, thesis (2.48)-(2.51), see VertexInterpolation:
///   w_i = (1 + lambda . r_i) / d_i,   r_i = (x_V - x_i) / d_i,   sum_i r_i r_i^T lambda = - sum_i r_i
/// `least_squares`: lambda . r_i d_i in place of lambda . r_i. All sums are over the nodes, so that they may be taken in parts
/// (over ranks, or over the copies of a point on periodic patches).
enum class VertexWeights { inverse_distance, least_squares };

/// The sums that lambda follows from.
struct VertexSums {
  Tensor3 m = Tensor3::Zero();
  Vec3 s = Vec3::Zero();
  double inverse_distance = 0, count = 0;

  /// `from`: x_V - x_i [m]; only the part of its direction in `within` counts.
  void add(const Vec3& from, VertexWeights kind, const Tensor3* within) {
    const double d = from.norm();
    inverse_distance += 1 / d;
    count += 1;
    Vec3 r = from / d;
    if (within) r = *within * r;
    m += (kind == VertexWeights::least_squares ? d : 1) * r * r.transpose();
    s += r;
  }
  /// Least-norm solution, within `within`.
  Vec3 lambda(int dim, const Tensor3* within) const;
};

/// What the weights, not yet of sum 1, make together.
struct VertexWeightSums {
  double sum = 0, squares = 0;
  Vec3 miss = Vec3::Zero();  ///< weighted mean of the x_V - x_i, times the sum

  void add(double weight, const Vec3& from) {
    sum += weight;
    squares += weight * weight;
    miss += weight * from;
  }
  /// The weights cancel: no weighted mean of the nodes reaches the point, and the plain inverse distance serves.
  bool cancels(const VertexSums& nodes) const;
  /// The weighted mean of the nodes is the point: linear fields are met.
  bool meets(const VertexSums& nodes, const Tensor3* within) const;
};

inline double vertex_weight(const Vec3& from, const Vec3& lambda, VertexWeights kind) {
  const double d = from.norm();
  return (1 + lambda.dot(from) / (kind == VertexWeights::least_squares ? 1 : d)) / d;
}

/// How the values at the vertices of a patch are found.
enum class PatchStencil {
  open,      ///< cells and boundary faces around the vertex (traction, free surface, interface)
  fixed,     ///< the surrounding faces of fixed patches only (Dirichlet)
  symmetry,  ///< cells mirrored at the patch; the patch's own faces carry no value
};

/// Values at mesh points from the nodes around them: cell centres and boundary face centres.
///
/// Modified inverse distance, thesis (2.48)-(2.51) with the erratum of (2.50): w_i = (1 + lambda . r_i) /
/// d_i, where r_i = (x_V - x_i) / d_i and sum_i r_i r_i^T lambda = - sum_i r_i; exact for linear fields
/// whenever the nodes span the space. Where they do not, lambda is the least-norm solution (exact along the
/// directions that are spanned), and where no weighted mean of the nodes can reach the point at all, the
/// plain inverse distance is taken. Where these weights magnify, n sum w^2 > 40, lambda . r_i d_i takes the
/// place of lambda . r_i: weighted least squares, whose weights are the least there are; at Mesh::wide_points
/// over the nodes around all points of the point's cells.
///
/// At symmetry planes the mirrored nodes are not stored: their weight equals that of the node itself, so that
/// it is enough to look for lambda within the planes, and to remove a vector's component across them (see
/// project()).
///
/// Where several materials meet at a vertex, each has its own weights for its own nodes (its cells, and the
/// faces of these), and the value is the mean of the materials': exact for fields that are linear in each of
/// them.
///
/// Node numbers: local cell i is node i, boundary face b (entry of mesh.boundary) is node
/// mesh.cells.n_local() + b. Rows exist for the points of owned cells (those whose whole surroundings are on
/// this rank); others are empty.
class VertexInterpolation {
 public:
  /// n sum w^2 of the weights of a point: 1 in the midst of n nodes, 9 at the edge of hexahedra, 28 at a
  /// corner.
  static double magnification(std::span<const double> weights) {
    double squares = 0;
    for (const double w : weights) squares += w * w;
    return double(weights.size()) * squares;
  }

  /// `stencils`: one a patch. Keeps the mesh by reference, and nothing of the geometry but the weights.
  VertexInterpolation(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                      std::span<const PatchStencil> stencils);
  /// One stencil a local boundary face; `material_of_cell`: per local cell, empty: one material.
  struct ByFace {
    std::vector<PatchStencil> stencil;
    std::span<const int> material_of_cell;
    /// Rows of the points of boundary faces (bonded ones, too) alone; those of others depend on no stencil.
    bool surface_only = false;
  };
  VertexInterpolation(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const ByFace& boundary);

  /// The weights for another placement of the points. Allocates nothing.
  void update(const mesh::Geometry& geometry);

  std::span<const Index> nodes(Index point) const {
    return {node_.data() + offset_[point], std::size_t(offset_[point + 1] - offset_[point])};
  }
  std::span<const double> weights(Index point) const {
    return {weight_.data() + offset_[point], std::size_t(offset_[point + 1] - offset_[point])};
  }
  /// The point lies on a fixed patch: its row holds faces of fixed patches; whoever knows better sets the
  /// value itself.
  bool is_fixed(Index point) const { return fixed_[point] != 0; }
  /// I minus the directions across the symmetry planes the point lies on; I where there are none.
  const Tensor3& projector(Index point) const { return projectors_[projector_of_[point]]; }
  bool on_symmetry(Index point) const { return projector_of_[point] != 0; }
  /// Points whose value is not exact for linear fields: the nodes around them do not span the space.
  /// Ascending; for the placement of the last update(). Owned points only.
  const std::vector<Index>& inexact_points() const { return inexact_; }
  /// A symmetry patch is neither flat nor does it have an edge at these points.
  const std::vector<Index>& bent_points() const { return bent_; }

  /// Values at this point: `cells` and `boundary` hold `components` a node. No projection.
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
  /// A vector field: the same, and no component across symmetry planes.
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
  // Where the nodes of each material end, of points with several materials ...
  std::vector<std::int64_t> ends_;
  // ... and per point its first entry there, -1: one material; empty: one in all.
  std::vector<Index> ends_first_;
  std::vector<Index> inexact_, bent_;
  std::vector<double> weight_;
  std::vector<std::uint8_t> fixed_;
  std::vector<Index> projector_of_;
  std::vector<Tensor3> projectors_;  // [0] is the identity
};

}  // namespace couplet::fv
