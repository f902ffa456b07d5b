// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::fv {

/// Geometric coefficients of the gradient at a face.
struct FaceLine {
  Vec3 normal;        ///< unit vector out of the owner
  double area;        ///< [m^2]
  double inverse_dn;  ///< 1 / (d . n) [1/m]
  Vec3 skew;          ///< k = n - d / (d . n)
};
FaceLine face_line(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index face);
/// Coefficients c_V of the points around the face [1/m], see FaceGradient; at most four.
void tangential_weights(const mesh::Mesh& mesh, std::span<const Vec3> points, Index face,
                        const FaceLine& line, Vec3* c);

/// Gradient at a face from the two nodes beside it and its vertices, thesis (2.53)-(2.58):
///   grad_t phi = sum_V c_V phi_V   (surface Gauss theorem, edge values = mean of their end points)
///   n . grad phi = (phi_N - phi_P) / (d . n) + k . grad_t phi,   d = x_N - x_P,   k = n - d / (d . n)
/// N is the center of the neighbor cell, or of the face on the boundary. Exact for linear fields on any, also
/// warped, face.
struct FaceGradient {
  FaceGradient(const mesh::Mesh& mesh, const mesh::Geometry& geometry);
  /// Recomputes the coefficients for new point positions without allocation.
  void update(const mesh::Mesh& mesh, const mesh::Geometry& geometry);

  std::vector<Vec3> normal;        ///< per local face: unit vector out of the owner
  std::vector<double> inverse_dn;  ///< per local face: 1 / (d . n) [1/m]
  std::vector<Vec3> skew;          ///< per local face: k
  std::vector<Vec3> tangential;    ///< c_V, aligned with mesh.face_points.index [1/m]

  /// grad_t at face f from `D` values per local point. Entry (i, j) is the derivative of component j along i.
  template <int D>
  Tensor<D> tangential_gradient(const mesh::Mesh& mesh, Index f, std::span<const double> vertex) const {
    Tensor<D> gradient = Tensor<D>::Zero();
    for (Index e = mesh.face_points.offset[f]; e < mesh.face_points.offset[f + 1]; ++e) {
      const double* value = vertex.data() + std::size_t(mesh.face_points.index[e]) * D;
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) gradient(i, j) += tangential[e][i] * value[j];
    }
    return gradient;
  }
};

}  // namespace couplet::fv
