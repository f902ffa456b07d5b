// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/axisymmetric_faces.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// The symmetric operator of a body of revolution: K = B^T C V B with the strains of AxisymmetricFace, hoop strain
/// included, and the volumes of rings, so that energies, forces and masses are those of the whole body. x is the radius.
class AxisymmetricKernel final : public ElasticKernel::Implementation {
 public:
  AxisymmetricKernel(const mesh::Mesh& mesh, const ElasticOperator& rows);

  void apply(std::span<const double> unknowns, std::span<const double> known,
             std::span<double> result) override;
  void apply_with_mass(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                       bool with_stiffness, std::span<double> result) override;
  double product(ElasticPart part, const ElasticField& u, const ElasticField& v) override;
  /// With the hoop strain as entry (2, 2).
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end) override;
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) override;
  bool set_density(std::span<const double> of_cells) override;
  Vec3 add_face_forces(std::span<const double> forces, std::span<double> rhs) override;
  void add_cell_forces(std::span<const double> forces, std::span<double> rhs) override;
  void add_pressure(std::span<const double> pressure, std::span<double> rhs) override;
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads) override;

 private:
  static constexpr std::size_t stride = SymmetricSpace<2>::stride;
  struct Face {
    double b[4][2], hoop[4];
    double mu, lambda;          // times the volume
    std::array<Index, 2> node;  // owner, across
    std::array<Index, 2> point;
    double shear;  // 0: none
  };
  void internal_forces();
  void spread_pressure(std::span<const double> pressure);
  /// radial, axial, hoop strain and the engineering shear.
  std::array<double, 4> strain_of(const double (&b)[4][2], const double (&hoop)[4],
                                  const std::array<const double*, 4>& u) const;

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  SymmetricSpace<2> space_;
  std::vector<Face> faces_;
};

}  // namespace couplet::elastic
