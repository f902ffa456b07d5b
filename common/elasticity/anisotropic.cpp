// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/anisotropic.hpp"

namespace couplet::elastic {
ElasticMatrix orthotropic_matrix(const OrthotropicConstants& c) {
  ElasticMatrix compliance = ElasticMatrix::Zero();
  for (int a = 0; a < 3; ++a) {
    compliance(a, a) = 1 / c.youngs_modulus[a];
    compliance(3 + a, 3 + a) = 1 / c.shear_modulus[a];  // 12, 23, 13 correspond to xy, yz, xz
    const int i = first_index[3 + a], j = second_index[3 + a];
    compliance(i, j) = compliance(j, i) = -c.poissons_ratio[a] / c.youngs_modulus[i];
  }
  return compliance.inverse();
}

ElasticMatrix isotropic_matrix(const LameConstants& lame) {
  ElasticMatrix c = ElasticMatrix::Zero();
  c.topLeftCorner<3, 3>().setConstant(lame.lambda);
  c.diagonal().array() += lame.mu;
  c.diagonal().head<3>().array() += lame.mu;
  return c;
}

bool is_positive(const ElasticMatrix& matrix) {
  return matrix.allFinite() && Eigen::SelfAdjointEigenSolver<ElasticMatrix>(matrix, Eigen::EigenvaluesOnly)
                                       .eigenvalues()
                                       .minCoeff() > 0;
}

/// Bond matrix M: stress transforms as s'_ij = Q_ia Q_jb s_ab, strain with M^-T.
ElasticMatrix turned(const ElasticMatrix& matrix, const Tensor3& axes) {
  ElasticMatrix m;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 6; ++c) {
      const int i = first_index[r], j = second_index[r], a = first_index[c], b = second_index[c];
      m(r, c) = axes(i, a) * axes(j, b) + (a == b ? 0 : axes(i, b) * axes(j, a));
    }
  return m * matrix * m.transpose();
}

ElasticMatrix in_plane_stress(const ElasticMatrix& matrix) {
  constexpr int kept[3] = {0, 1, 3}, gone[3] = {2, 4, 5};
  Eigen::Matrix3d a, b, d;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      a(i, j) = matrix(kept[i], kept[j]);
      b(i, j) = matrix(kept[i], gone[j]);
      d(i, j) = matrix(gone[i], gone[j]);
    }
  const Eigen::Matrix3d left = a - b * d.inverse() * b.transpose();
  ElasticMatrix result = ElasticMatrix::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) result(kept[i], kept[j]) = left(i, j);
  return result;
}

LameConstants isotropic_mean(const ElasticMatrix& c) {
  const double along = c(0, 0) + c(1, 1) + c(2, 2), across = c(0, 1) + c(1, 2) + c(0, 2);
  const double bulk = (along + 2 * across) / 9;
  const double mu = (along - across + 3 * (c(3, 3) + c(4, 4) + c(5, 5))) / 15;
  return {mu, bulk - 2 * mu / 3};
}

StrainVector strain_vector(const Tensor3& g) {
  StrainVector e;
  for (int k = 0; k < 6; ++k)
    e[k] = k < 3 ? g(k, k) : g(first_index[k], second_index[k]) + g(second_index[k], first_index[k]);
  return e;
}

Tensor3 stress_of(const ElasticMatrix& matrix, const Tensor3& gradient) {
  const StrainVector s = matrix * strain_vector(gradient);
  Tensor3 stress;
  for (int k = 0; k < 6; ++k)
    stress(first_index[k], second_index[k]) = stress(second_index[k], first_index[k]) = s[k];
  return stress;
}

}  // namespace couplet::elastic
