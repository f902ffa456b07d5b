// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>

#include "common/base/types.hpp"
#include "common/elasticity/lame.hpp"

namespace couplet::elastic {

/// Linear elastic law in matrix form: stress = C strain, both in the order xx, yy, zz, xy, yz, xz with
/// engineering shear strains (twice the tensor entries) [Pa].
using ElasticMatrix = Eigen::Matrix<double, 6, 6>;
using StrainVector = Eigen::Matrix<double, 6, 1>;

/// Engineering constants of an orthotropic material, with pairs in the order 12, 23, 13. nu_12 is the
/// contraction along 2 under tension along 1; nu_12 / E_1 = nu_21 / E_2.
struct OrthotropicConstants {
  std::array<double, 3> youngs_modulus{}, poissons_ratio{}, shear_modulus{};
};

/// Stiffness in the material axes: inverse of the compliance (e.g. [lekhnitskii1963], chapter 1). If it is
/// not positive definite, the constants are not physical.
ElasticMatrix orthotropic_matrix(const OrthotropicConstants& constants);
ElasticMatrix isotropic_matrix(const LameConstants& lame);
bool is_positive(const ElasticMatrix& matrix);

/// Rotates the material axes to the columns of `axes` (orthonormal) by Bond's transformation, C' = M C M^T.
ElasticMatrix turned(const ElasticMatrix& matrix, const Tensor3& axes);
/// Stiffness with no stress on the planes z = const: rows and columns of zz, yz and xz are zero.
ElasticMatrix in_plane_stress(const ElasticMatrix& matrix);
/// Closest isotropic material (Voigt averages), for uses that only need the magnitude of the stiffness.
LameConstants isotropic_mean(const ElasticMatrix& matrix);

StrainVector strain_vector(const Tensor3& gradient);
Tensor3 stress_of(const ElasticMatrix& matrix, const Tensor3& gradient);

}  // namespace couplet::elastic
