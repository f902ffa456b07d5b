// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Least squares of `components` quadratics in the plane or in space,
///   f_k(x) = sum_i c_ik phi_i(x),   phi = 1, x_a, x_a x_b (a <= b),   x = (place - centre) / scale,
/// through weighted samples and rows between the components. Where they leave curvature open, the least is taken.
class QuadraticFit {
 public:
  static constexpr int most_terms = 10, most_components = 6;
  using Terms = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_terms, 1>;
  /// Column a: derivatives along the place's component a [1/m].
  using Slopes = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, most_terms, 3>;

  /// `scale` [m]: the reach of the samples.
  void start(int dim, int components, const Vec3& centre, double scale);
  /// f(place) = values; `moment` [m^2]: the mean of (x - place) (x - place)^T over the cell that `values` are the mean of.
  void add_sample(const Vec3& place, const Tensor3& moment, std::span<const double> values, double weight);
  /// sum_ik row(i, k) c_ik = value.
  using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_terms, most_components>;
  void add_row(const Row& row, double value, double weight);
  void solve();

  Terms terms(const Vec3& place) const { return terms(place, Tensor3::Zero()); }
  Slopes slopes(const Vec3& place) const;
  int n_terms() const { return dim_ == 2 ? 6 : 10; }
  /// c(i, k), after solve().
  const Eigen::MatrixXd& coefficients() const { return coefficients_; }

 private:
  Terms terms(const Vec3& place, const Tensor3& moment) const;

  int dim_ = 3;
  Vec3 centre_ = Vec3::Zero();
  double scale_ = 1, weights_ = 0;
  bool coupled_ = false;                    // some row was added
  Eigen::MatrixXd of_samples_, right_;      // terms x terms, terms x components
  Eigen::MatrixXd of_rows_, coefficients_;  // (components terms)^2
  Eigen::VectorXd right_of_rows_;
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
/// Appends the local cells that share a vertex with `cell` and have its material, itself among them. `mark`: per local cell for which
/// cell it was last gathered, at first -1.
void gather_cells(const mesh::Mesh& mesh, const mesh::Csr& cells_of_point, Index cell,
                  std::vector<Index>& mark, std::vector<Index>& cells);
/// Boundary faces of each local cell, counted among all faces.
mesh::Csr boundary_faces_of_cells(const mesh::Mesh& mesh);

/// One of several numbers that belong to a point.
struct PointShare {
  GlobalIndex point;  ///< Mesh::point_id
  double share;
};

/// Of each `wanted` local point the median of the shares that all ranks found for it; NaN of other points and where there are none.
/// Few points. Collective.
std::vector<double> medians(const mesh::Mesh& mesh, const std::vector<PointShare>& shares,
                            std::span<const std::uint8_t> wanted);

}  // namespace couplet::solid
