// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Least-squares fit of `components` quadratics in 2-D or 3-D,
///   f_k(x) = sum_i c_ik phi_i(x),   phi = 1, x_a, x_a x_b (a <= b),   x = (place - center) / scale,
/// to weighted samples and rows that couple the components. Undetermined curvature is minimized.
class QuadraticFit {
 public:
  static constexpr int most_terms = 10, most_components = 6;
  using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_terms, 1>;
  /// Column a contains the derivatives along axis a [1/m].
  using Slopes = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, most_terms, 3>;

  /// `scale` [m]: extent of the samples.
  void start(int dim, int components, const Vec3& centre, double scale);
  /// f(place) = values; `moment` [m^2]: mean of (x - place)(x - place)^T over the cell of a mean value.
  void add_sample(const Vec3& place, const Tensor3& moment, std::span<const double> values, double weight);
  /// Adds the row sum_ik row(i, k) c_ik = value.
  using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_terms, most_components>;
  void add_row(const Row& row, double value, double weight);
  void solve();

  Terms terms(const Vec3& place) const { return terms(place, Tensor3::Zero()); }
  Slopes slopes(const Vec3& place) const;
  int n_terms() const { return dim_ == 2 ? 6 : 10; }
  /// Coefficients c(i, k), after solve().
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }

 private:
  Terms terms(const Vec3& place, const Tensor3& moment) const;

  int dim_ = 3;
  Vec3 centre_ = Vec3::Zero();
  double scale_ = 1, weights_ = 0;
  Eigen::Index n_samples_ = 0, n_rows_ = 0;
  // Columns are samples or rows times the root of their weight; the last entries are the values.
  Eigen::MatrixXd samples_, rows_;
  Eigen::MatrixXd of_samples_, of_rows_, coefficients_;  // normal equations, lower half
};

/// Plane of symmetry, in which a patch of cells is continued by its mirror image.
struct MirrorPlane {
  Vec3 normal, origin;
  Tensor3 reflection() const { return Tensor3::Identity() - 2 * normal * normal.transpose(); }
  Vec3 reflect(const Vec3& v) const { return v - 2 * normal.dot(v) * normal; }
  Vec3 image(const Vec3& place) const { return place - 2 * normal.dot(place - origin) * normal; }
};
/// Adds the plane of a boundary face unless one with the same normal is there.
void add_mirror(const mesh::Geometry& geometry, Index face, std::vector<MirrorPlane>& mirrors);

/// Mean of (x - x_c) (x - x_c)^T over a local cell [m^2], from its vertices: exact for simplices and boxes.
Tensor3 cell_moment(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index cell);
/// Appends `cell` and the local cells of its material that share a vertex with it. `mark`: the cell
/// for which each local cell was last gathered, initially -1.
void gather_cells(const mesh::Mesh& mesh, const mesh::Csr& cells_of_point, Index cell,
                  std::vector<Index>& mark, std::vector<Index>& cells);
/// Boundary faces of each local cell, numbered among all faces.
mesh::Csr boundary_faces_of_cells(const mesh::Mesh& mesh);

/// One of several values at a point.
struct PointShare {
  GlobalIndex point;  ///< Mesh::point_id
  double share;
};

/// Median over all ranks of the shares at each `wanted` local point. NaN at other points and where there are
/// none. Intended for few points. Collective.
std::vector<double> medians(const mesh::Mesh& mesh, const std::vector<PointShare>& shares,
                            std::span<const std::uint8_t> wanted);

}  // namespace couplet::solid
