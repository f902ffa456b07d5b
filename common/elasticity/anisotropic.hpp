// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "common/base/types.hpp"

namespace couplet::elastic {

/// Constants of sigma = mu (grad u + grad u^T) + lambda tr(grad u) I [Pa]. In plane stress lambda is 2 lambda
/// mu / (lambda + 2 mu).
struct LameConstants {
  double mu = 0, lambda = 0;
};

/// Constants of the deviatoric part in 3-D: sigma = 2 mu dev(e) + K tr(e) I.
inline LameConstants deviatoric(const LameConstants& lame) { return {lame.mu, -2 * lame.mu / 3}; }
inline double bulk_modulus(const LameConstants& lame) { return lame.lambda + 2 * lame.mu / 3; }

/// Volume strain on which the bulk modulus acts in the symmetric gradient: that of each face, the mean over a
/// cell's faces (no locking as nu approaches 1/2), or both. The first is too stiff, the second too soft. A
/// tenth of K at the faces gives the least error in bending. Much more than mu / 3 would lock.
enum class VolumeStrain { faces, cells, shared };
/// Part of the bulk modulus that acts on the volume strain of cells [Pa].
inline double bulk_of_cells(const LameConstants& lame, VolumeStrain by) {
  const double bulk = bulk_modulus(lame);
  if (by == VolumeStrain::shared) return bulk - std::min(bulk / 10, lame.mu / 3);
  return by == VolumeStrain::cells ? bulk : 0;
}
/// Remaining constants for the strain of the faces.
inline LameConstants part_of_faces(const LameConstants& lame, VolumeStrain by) {
  if (by == VolumeStrain::cells) return deviatoric(lame);
  return {lame.mu, lame.lambda - bulk_of_cells(lame, by)};
}

/// Linear elastic law in matrix form: stress = C strain, both in the order xx, yy, zz, xy, yz, xz with
/// engineering shear strains (twice the tensor entries) [Pa].
using ElasticMatrix = Eigen::Matrix<double, 6, 6>;
using StrainVector = Eigen::Matrix<double, 6, 1>;
/// Tensor indices of each entry.
inline constexpr int first_index[6] = {0, 1, 2, 0, 1, 0}, second_index[6] = {0, 1, 2, 1, 2, 2};

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
