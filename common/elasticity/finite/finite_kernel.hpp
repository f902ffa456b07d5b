// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/finite/finite_law.hpp"
#include "common/linalg/matrix.hpp"

namespace couplet::elastic {

/// The symmetric face gradient at large strain, total Lagrangian: with F_f = I + G_f(u),
///   E(u) = sum_f V_f W(F_f),   inner forces dE/du,   tangent d2E/du2 = sum_f V_f B_f^T (dP/dF) B_f,
/// P = dW/dF. The tangent is symmetric on any mesh and for any law. One volume ratio a cell (near
/// incompressibility, ElasticOperator::volume_by_cells): the bulk part of the law sees the mean
///   J_P = sum_f V_fP det F_f / V_P,   E = sum_f V_f [W - U](F_f) + sum_P V_P U(J_P).
/// Three-cornered faces share 0.9 of their energy with their edges, which see the mean of the faces' F round
/// them (SharedEdges). Rows, known columns, springs and mass: as SymmetricKernel has them.
class FiniteKernel {
 public:
  virtual ~FiniteKernel() = default;
  /// Of the local cells [kg/m^3]; without it there is no mass.
  virtual void set_density(std::span<const double> of_cells) = 0;
  /// A step begins at this state: the forces of linearise(), whose u is then taken to be the middle of the step, are
  /// those that keep energy and momenta over it (conserving_stress()), until forget_start(). Collective.
  virtual void set_start(std::span<const double> unknowns, std::span<const double> known) = 0;
  void forget_start() { has_start_ = false; }
  /// A pressure [Pa] on boundary faces of owned cells, one each, that follows the surface (FollowerPressure): its
  /// forces count as inner ones with the opposite sign, until other values are given.
  virtual void set_pressure(std::span<const double> of_faces) = 0;
  virtual bool has_pressure() const = 0;
  /// Resultant of that pressure at the last linearise(), this rank's [N].
  Vec3 pressure_force() const { return pressure_force_; }
  /// Pressures of their own (one volume ratio a cell): from here on the forces of linearise() are those of pressures p
  /// that need not be U'(J), which Newton's method carries along as unknowns of the mixed form,
  ///   dP/du du + H dp = ..., dp = U'' dJ + U' - p,
  /// p eliminated from its linear system. Near incompressibility U' of a state on the way is nonsense, p is not. They
  /// start as U'(J) of the last linearise(); `false`: forces by U' again.
  void set_own_pressures(bool on);
  /// The change of p that goes with a change of the displacement from the last linearise() on. Collective.
  virtual void predict_pressures(std::span<const double> change, std::span<const double> known_change) = 0;
  /// The next linearise() takes p and so much of that change; accept_pressures() keeps them.
  void set_pressure_fraction(double fraction) { fraction_ = fraction; }
  void accept_pressures();
  /// result += what the forces of the last linearise() would be more with U'(J) in place of p. Collective.
  virtual void add_pressure_defect(std::span<double> result) = 0;
  /// result = dE/du (u) + springs + mass_factor M u; keeps what the tangent there needs. Collective.
  virtual void linearise(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                         std::span<double> result) = 0;
  /// result = [d2E/du2 + springs + mass_factor M] v at the u of the last linearise(); `known`: changes of the known
  /// columns, empty: zeros. Collective.
  virtual void apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                             std::span<double> result) = 0;
  /// E of the last linearise(), this rank's part [J]; springs are not counted.
  double energy() const { return energy_; }

  /// The smallest det F of the last linearise() on this rank, and the face where it is.
  struct Worst {
    double ratio = 1;
    Index face = -1;
  };
  Worst worst() const { return worst_; }
  /// Takes (flux face, F, P) of the last linearise(), those of this rank (its owner's cell is); F(i, j) =
  /// d x_i / d X_j, and with edges what the face's share of them makes of it.
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  virtual void visit(const Take& take) = 0;
  /// dP/dF of a face of this rank and the cofactors of F at the last linearise(); entry i * 3 + j of P_ij. Three-cornered
  /// faces as if they shared nothing with their edges. One volume ratio a cell: the cofactors alone also of the faces
  /// between an owned cell and its owner on another rank.
  struct FaceTangent {
    Index face;
    Eigen::Matrix<double, 9, 9> stiffness;
    Tensor3 cofactors;
  };
  virtual void visit_tangents(const std::function<void(const FaceTangent&)>& take) = 0;
  /// U'' / V of an owned cell at the last linearise() [Pa/m^3]; one volume ratio a cell.
  double modulus(Index cell) const { return modulus_[std::size_t(cell)]; }
  /// Of a local node (cells, then boundary faces) at the last linearise(), or what was applied since.
  virtual Vec3 displacement(Index node) const = 0;
  /// As ElasticKernel::holding_forces(), of displacements `unknowns`. Collective.
  virtual std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                             const ElasticLoads& loads) = 0;
  /// Thermal stretches theta of the local flux faces, until other ones are given: F = F_e theta, the energy is that of F_e
  /// (finite_law.hpp), one volume ratio a cell sees the mean of theta^3. Empty: none. Collective.
  virtual void set_stretch(std::span<const double> of_faces) = 0;

 protected:
  bool has_start_ = false;
  double energy_ = 0;
  Worst worst_;
  Vec3 pressure_force_ = Vec3::Zero();
  // One volume ratio a cell; of owned cells. Empty: none.
  std::vector<double> modulus_;                         // U'' / V at the last linearise()
  std::vector<double> bulk_pressure_;                   // U'(J) there
  std::vector<double> own_pressure_, pressure_change_;  // of pressures of their own p and its change
  double fraction_ = 0;
};

/// `of_materials`: one law a material of the mesh (one: of all); kept by reference like mesh and rows. `plane_stress`: of a
/// sheet in two dimensions, whose stretch across it each face finds by itself (finite_sheet.hpp): without one volume ratio a
/// cell, pressures that follow and set_start(). Collective.
std::unique_ptr<FiniteKernel> make_finite_kernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                                 std::vector<const FiniteLaw*> of_materials,
                                                 bool plane_stress = false);

/// The tangent of a deformed body at the last linearise() of its kernel, assembled: for factors of small bodies. As
/// symmetric_matrix(): three-cornered faces as if they shared nothing with their edges, and without the tangent of a
/// pressure that follows the surface. `of_nodes`: on the diagonals of the unknown nodes; empty: none. Collective.
linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes);

}  // namespace couplet::elastic
