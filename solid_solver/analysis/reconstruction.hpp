// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/elasticity/elasticity.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/solid_state.hpp"

namespace couplet::solid {

/// Cubic about a cell's center.
struct Cubic {
  Vec3 value = Vec3::Zero();
  Tensor3 slope = Tensor3::Zero();  // entry (i, j) = d u_j / d x_i
  std::array<Tensor3, 3> curvature{Tensor3::Zero(), Tensor3::Zero(), Tensor3::Zero()};  // per component
  /// Per component the coefficients of x^3, x^2 y, x^2 z, x y^2, x y z, x z^2, y^3, y^2 z, y z^2 and z^3.
  std::array<std::array<double, 10>, 3> cubes{};

  Vec3 cubic_part(const Vec3& at) const {
    const double x = at[0], y = at[1], z = at[2];
    Vec3 u;
    for (int j = 0; j < 3; ++j) {
      const auto& c = cubes[std::size_t(j)];
      u[j] = x * (x * (c[0] * x + c[1] * y + c[2] * z) + y * (c[3] * y + c[4] * z) + c[5] * z * z) +
             y * (y * (c[6] * y + c[7] * z) + c[8] * z * z) + c[9] * z * z * z;
    }
    return u;
  }
  /// Gradient of the cubic part of a component from the products of the coordinates.
  template <class T>
  std::array<T, 3> slope_of_cubes(std::size_t component, const std::array<std::array<T, 3>, 3>& s) const {
    const auto& c = cubes[component];
    const T xx = s[0][0], xy = 2 * s[0][1], xz = 2 * s[0][2], yy = s[1][1], yz = 2 * s[1][2], zz = s[2][2];
    return {3 * c[0] * xx + c[1] * xy + c[2] * xz + c[3] * yy + 0.5 * c[4] * yz + c[5] * zz,
            c[1] * xx + c[3] * xy + 0.5 * c[4] * xz + 3 * c[6] * yy + c[7] * yz + c[8] * zz,
            c[2] * xx + 0.5 * c[4] * xy + c[5] * xz + c[7] * yy + c[8] * yz + 3 * c[9] * zz};
  }
  Vec3 at(const Vec3& x) const {
    Vec3 u = value + slope.transpose() * x + cubic_part(x);
    for (int j = 0; j < 3; ++j) u[j] += 0.5 * x.dot(curvature[std::size_t(j)] * x);
    return u;
  }
};

/// A displacement at a place.
struct Sample {
  Vec3 x, u;  // x from the cell's center
};

/// Displacements of the cells of this rank as cubics: quadratics by least squares over the cells that share a vertex, whose third
/// derivatives are the slopes of the neighbors' second ones.
class Reconstruction {
 public:
  /// Collective.
  Reconstruction(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, const SolidState& state);
  /// Cells that share a vertex with the last cell, and it.
  const std::vector<Index>& patch() const { return patch_; }
  /// Fit to the samples of an owned cell without their known cubic part.
  Cubic fitted(Index cell);
  /// Quadratic fit to samples, the first of which is the cell's.
  Cubic fit(const std::vector<Sample>& samples);

 private:
  void keep(Index cell, const std::array<Tensor3, 3>& curvature);
  void gather(Index cell);
  std::array<std::array<double, 10>, 3> cubes_of(Index cell) const;
  Vec3 place(Index cell) const;

  const mesh::Mesh& mesh_;
  const elastic::ElasticOperator& rows_;
  const SolidState& state_;
  mesh::Csr cells_of_point_, boundary_faces_;
  std::vector<Index> mark_, patch_;
  std::vector<Sample> samples_;
  QuadraticFit quadratic_;
  std::vector<double> curvature_;  // per local cell
};

}  // namespace couplet::solid
