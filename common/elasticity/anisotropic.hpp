// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>

#include "common/base/types.hpp"
#include "common/elasticity/lame.hpp"

namespace couplet::elastic {

/// Any linear elastic law as a matrix: stress = C strain, both in the order xx, yy, zz, xy, yz, xz, the shear strains
/// being the angles (twice the tensor's entries) [Pa].
using ElasticMatrix = Eigen::Matrix<double, 6, 6>;
using StrainVector = Eigen::Matrix<double, 6, 1>;

/// Engineering constants of a body with three planes of symmetry, indices 12, 23, 13 in this order where there are two:
/// nu_12 is the contraction along 2 for a pull along 1, nu_12 / E_1 = nu_21 / E_2.
struct OrthotropicConstants {
  std::array<double, 3> youngs_modulus{}, poissons_ratio{}, shear_modulus{};
};

/// In the axes of the material: the inverse of the compliance (e.g. [lekhnitskii1963], chapter 1). Not positive definite:
/// the constants are those of no body.
ElasticMatrix orthotropic_matrix(const OrthotropicConstants& constants);
ElasticMatrix isotropic_matrix(const LameConstants& lame);
bool is_positive(const ElasticMatrix& matrix);

/// The same body with its axes along the columns of `axes` (orthonormal): Bond's transformation, C' = M C M^T.
ElasticMatrix turned(const ElasticMatrix& matrix, const Tensor3& axes);
/// What is left where no stress acts on the planes z = const: rows and columns of zz, yz and xz are zero.
ElasticMatrix in_plane_stress(const ElasticMatrix& matrix);
/// The isotropic body nearest to it (Voigt's means of compression and shear), for what only needs a stiffness of the right size.
LameConstants isotropic_mean(const ElasticMatrix& matrix);

StrainVector strain_vector(const Tensor3& gradient);
Tensor3 stress_of(const ElasticMatrix& matrix, const Tensor3& gradient);

}  // namespace couplet::elastic
