// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "solid_solver/method/equilibrium.hpp"

namespace couplet::solid {

/// How the equilibrium of a body at large strain is found, and what its stress is at a state.
class LargeStrain : public Equilibrium {
 public:
  /// By reference.
  LargeStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
      : mesh_(mesh), geometry_(rows.geometry()), rows_(rows) {}

  /// Relative already.
  double share_left(double residual, double) const override { return residual; }
  void to_strain(std::span<Tensor3> gradients) const override;
  std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) override;
  std::vector<Tensor3> cell_stress(const Displaced& state) override;
  std::span<const Vec3> surface(std::span<const Vec3> moved) const override { return moved; }

  /// Takes (face, F, P): F(i, j) = d x_i / d X_j, P the first Piola-Kirchhoff stress [Pa], of this rank's faces.
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  virtual void visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) = 0;

 protected:
  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const elastic::ElasticOperator& rows_;
};

/// What rounding leaves in the rows at least [N]: some last digits of the stiffness times the area of a face.
/// Collective.
double rounding_of_forces(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
/// What the last digit of a displacement makes of forces, over that displacement [N/m]: a slender body moves by many times the distance
/// of its cells, and no equilibrium is nearer than the numbers are. Collective.
double rounding_of_motion(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows);
/// The face with the smallest det F of all ranks, in words; `face` of this rank, -1: none is below 1. Collective.
std::string worst_cell(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double ratio, Index face);

}  // namespace couplet::solid
