// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/symmetric/axisymmetric_faces.hpp"
#include "common/elasticity/symmetric/space_kernel.hpp"

namespace couplet::elastic {

/// The symmetric operator of a body of revolution: K = B^T C V B with the strains of AxisymmetricFace, hoop strain
/// included, and the volumes of rings, so that energies, forces and masses are those of the whole body. x is the radius.
class AxisymmetricKernel final : public SpaceKernel<2> {
 public:
  AxisymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows);

  /// With the hoop strain as entry (2, 2).
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end) override;

 private:
  static constexpr std::size_t stride = SymmetricSpace<2>::stride;
  struct Face {
    double b[4][2], hoop[4];
    double mu, lambda;          // times the volume
    std::array<Index, 2> node;  // owner, across
    std::array<Index, 2> point;
    double shear;  // 0: none
  };
  void internal_forces() override;
  void spread_pressure(std::span<const double> pressure) override;
  /// radial, axial, hoop strain and the engineering shear.
  std::array<double, 4> strain_of(const double (&b)[4][2], const double (&hoop)[4],
                                  const std::array<const double*, 4>& u) const;

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  std::vector<Face> faces_;
};

}  // namespace couplet::elastic
