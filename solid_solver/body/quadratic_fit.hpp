// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Normal equations of a linear least-squares problem with several right-hand sides.
class NormalEquations {
 public:
  void start(int terms, int values);
  /// Returns a row of the problem to be filled with the terms, then the values.
  double* next_row() {
    if (waiting_ == 4) flush();
    ++waiting_;
    return last_row();
  }
  double* last_row() { return batch_.data() + std::size_t(width_ * (waiting_ - 1)); }
  /// Adds the rows that wait.
  void flush();
  /// Entry of the upper triangle or, from column `terms` on, of a right-hand side; after solve(), a solution there.
  double& at(int i, int j) { return products_[std::size_t(i * width_ + j)]; }
  void solve();

 private:
  int terms_ = 0, width_ = 0, waiting_ = 0;
  std::vector<double> batch_, products_;  // rows of `width_`, a multiple of four
};

/// Least-squares fit of `components` quadratics in 2-D or 3-D,
///   f_k(x) = sum_i c_ik phi_i(x),   phi = 1, x_a, x_a x_b (a <= b),   x = (place - center) / scale,
/// to weighted samples and rows that couple the components.
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
  /// Adds f(place) = values with the weight 1 / (0.05 + x^2).
  void add_near(const Vec3& place, std::span<const double> values);
  /// Adds the row sum_ik row(i, k) c_ik = value.
  using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_terms, most_components>;
  void add_row(const Row& row, double value, double weight);
  /// Undetermined curvature is minimized.
  void solve();
  /// Undetermined terms become small, those of directions without samples zero. Without rows.
  void solve_near();

  Terms terms(const Vec3& place) const;
  Slopes slopes(const Vec3& place) const;
  int n_terms() const { return dim_ == 2 ? 6 : 10; }
  /// Coefficients c(i, k), after the solution.
  const Row& coefficients() const { return coefficients_; }

 private:
  void add_values(const Vec3& place, std::span<const double> values, double weight);

  int dim_ = 3, components_ = 0;
  Vec3 centre_ = Vec3::Zero();
  double scale_ = 1, weights_ = 0;
  bool has_rows_ = false;
  NormalEquations samples_, coupled_;
  Row coefficients_;
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
