// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/finite/finite_law.hpp"
#include "solid_solver/method/scalar_systems.hpp"

namespace couplet::solid {

/// The thesis's operators on a body that stands elsewhere: the same mesh in the geometry of its moved vertices, steps 5 to 7 of the
/// algorithm in thesis 2.7.1.
class UpdatedFrame {
 public:
  /// `rows`: conditions and constants, of the undeformed body. Keeps the mesh by reference. Collective.
  UpdatedFrame(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, std::vector<Vec3> points);
  const elastic::ElasticKernel& kernel() const { return kernel_; }
  /// S_u of local faces [m^2], out of the owner.
  const std::vector<Vec3>& area() const { return geometry_.face_area; }
  /// For this inertia, made anew when the factor is another one. Collective.
  ScalarSystems& systems(double mass_factor, std::span<const double> inertia);
  /// Displacement of a linear body whose known columns move by `change`, loosely solved. Collective.
  std::vector<double> linear_answer(std::span<const double> change, MethodParameters method);

 private:
  const mesh::Mesh& mesh_;
  const mesh::Geometry geometry_;
  elastic::ElasticOperator rows_;
  elastic::ElasticKernel kernel_;
  double mass_factor_ = 0;
  std::unique_ptr<ScalarSystems> systems_;
};

/// P = dW/dF [Pa] and W [J/m^3] of a law at each F.
void first_piola(const elastic::FiniteLaw& law, std::span<const Tensor3> deformation,
                 std::span<Tensor3> stress, std::span<double> energy);
/// det(F) F^-T
Tensor3 cofactors_of(const Tensor3& deformation);

}  // namespace couplet::solid
