// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/finite/finite_law.hpp"
#include "common/linalg/acceleration.hpp"
#include "solid_solver/equilibrium/large_strain.hpp"
#include "solid_solver/parameters/parameters.hpp"
#include "solid_solver/thesis/segregated.hpp"

namespace couplet::solid {

/// The thesis's operators on a displaced body: the same mesh with moved vertices, steps 5 to 7 of the algorithm in thesis 2.7.1.
class UpdatedFrame {
 public:
  /// `rows`: conditions and constants of the undeformed body. Keeps a reference to the mesh. Collective.
  UpdatedFrame(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, std::vector<Vec3> points);
  const elastic::ElasticKernel& kernel() const { return kernel_; }
  /// S_u of local faces [m^2], out of the owner.
  const std::vector<Vec3>& area() const { return geometry_.face_area; }
  /// Systems for this inertia, recomputed when the factor changes. Collective.
  ScalarSystems& systems(double mass_factor, std::span<const double> inertia);
  /// Displacement of a linear body whose known columns move by `change`, with a loose tolerance. Collective.
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

/// Updated Lagrangian method of the thesis for large strain, thesis (2.37)-(2.40) and (2.68)-(2.72). Each
/// step refers to the configuration at its start (index u), whose geometry follows from the moved vertices:
///   f = I + [grad_u (du)]^T,  j = det f,  F = f F_u,  force through a face = sigma(F) . (j f^-T S_u)
/// The face gradient is the thesis's on that geometry, and du the displacement since then. Uses the
/// segregated method. Masses are those of the undeformed cells, rho_u V_u = rho_0 V_0.
class UpdatedLagrangian final : public LargeStrain {
 public:
  /// Throws Error for unsupported conditions. Keeps references to mesh and rows. Collective.
  UpdatedLagrangian(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                    const SolidParameters& parameters);
  ~UpdatedLagrangian() override;

  std::string name() const override;
  void set_pressure(std::vector<double> of_faces) override { pressure_ = std::move(of_faces); }
  linalg::SolveStatistics find(const EquilibriumLoad& load, SolidSystem& system,
                               std::span<double> u) override;
  std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) override;
  double energy(std::span<const double> unknowns, std::span<const double> known) override;
  void visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) override;
  Vec3 pressure_force() const override { return pressure_force_; }
  std::vector<elastic::Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                              const elastic::ElasticLoads& loads) override;
  /// Ends the current step; accept() makes it the start of the next one. Throws SolveFailure.
  void end_step(std::span<const double> unknowns, std::span<const double> known);
  void accept();
  void visit(io::Archive& archive, std::span<const double> unknowns, std::span<const double> known) override;

 private:
  /// Configuration of the body and its deformation.
  struct Place {
    std::vector<Vec3> points;       // per local point [m]
    std::vector<Tensor3> gradient;  // F_u, per flux face
    std::vector<double> u, known;   // total displacement
  };
  /// Operators at the start of the step, created on first use.
  UpdatedFrame& frame();
  /// Displacement since the start of the step.
  struct Change {
    std::vector<double> u, known;
  };
  Change since_start(std::span<const double> unknowns, std::span<const double> known) const;
  void find_change(std::span<const double> unknowns, std::span<const double> known);
  bool find_stress();
  void add_forces(std::span<double> result);
  Vec3 present_area(Index f) { return cofactors_of(change_[f]) * frame().area()[f]; }
  Vec3 force_through(Index f);
  double residual(const EquilibriumLoad& load, std::span<const double> u, std::span<double> r);
  void follow_known(const EquilibriumLoad& load, std::span<double> u);
  bool look(std::span<const double> unknowns, std::span<const double> known);
  std::string where_worst() const;

  const MethodParameters method_;
  double noise_ = 0;
  elastic::FiniteLaw law_;
  linalg::VectorAccelerator accelerator_;
  Place now_, next_;
  std::unique_ptr<UpdatedFrame> frame_;
  std::vector<double> pressure_;  // per boundary face of owned cells; empty if there is none
  // At the last evaluated state, per flux face: f, F, P.
  std::vector<Tensor3> change_, deformation_, stress_;
  std::vector<double> energy_;  // per undeformed volume
  double least_ = 1;            // det F
  Index worst_ = -1;
  Vec3 pressure_force_ = Vec3::Zero();
};

}  // namespace couplet::solid
