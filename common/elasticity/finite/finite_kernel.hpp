// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/finite/finite_loops.hpp"
#include "common/elasticity/symmetric/surface_pressure.hpp"
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
  /// `of_materials`: one law a material of the mesh (one: of all); kept by reference like mesh and rows. `plane_stress`: of a
  /// sheet in two dimensions, whose stretch across it each face finds by itself (finite_places.hpp): without one volume ratio
  /// a cell, pressures that follow and set_start(). Collective.
  FiniteKernel(const mesh::Mesh& mesh, const ElasticOperator& rows,
               std::vector<const FiniteLaw*> of_materials, bool plane_stress = false);
  ~FiniteKernel();
  /// Of the local cells [kg/m^3]; without it there is no mass.
  void set_density(std::span<const double> of_cells) { space_.set_density(of_cells); }
  /// A step begins at this state: the forces of linearise(), whose u is then taken to be the middle of the step, are
  /// those that keep energy and momenta over it (conserving_stress()), until forget_start(). Collective.
  void set_start(std::span<const double> unknowns, std::span<const double> known);
  void forget_start() { has_start_ = false; }
  /// A pressure [Pa] on boundary faces of owned cells, one each, that follows the surface (FollowerPressure): its
  /// forces count as inner ones with the opposite sign, until other values are given.
  void set_pressure(std::span<const double> of_faces) { pressure_.set(mesh_, rows_.geometry(), of_faces); }
  bool has_pressure() const { return !pressure_.empty(); }
  /// Resultant of that pressure at the last linearise(), this rank's [N].
  Vec3 pressure_force() const { return pressure_force_; }
  /// Pressures of their own (one volume ratio a cell): from here on the forces of linearise() are those of pressures p
  /// that need not be U'(J), which Newton's method carries along as unknowns of the mixed form,
  ///   dP/du du + H dp = ..., dp = U'' dJ + U' - p,
  /// p eliminated from its linear system. Near incompressibility U' of a state on the way is nonsense, p is not. They
  /// start as U'(J) of the last linearise(); `false`: forces by U' again.
  void set_own_pressures(bool on);
  /// The change of p that goes with a change of the displacement from the last linearise() on. Collective.
  void predict_pressures(std::span<const double> change, std::span<const double> known_change);
  /// The next linearise() takes p and so much of that change; accept_pressures() keeps them.
  void set_pressure_fraction(double fraction) { cells_.fraction = fraction; }
  void accept_pressures();
  /// result += what the forces of the last linearise() would be more with U'(J) in place of p. Collective.
  void add_pressure_defect(std::span<double> result);
  /// result = dE/du (u) + springs + mass_factor M u; keeps what the tangent there needs. Collective.
  void linearise(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                 std::span<double> result);
  /// result = [d2E/du2 + springs + mass_factor M] v at the u of the last linearise(); `known`: changes of the known
  /// columns, empty: zeros. Collective.
  void apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                     std::span<double> result);
  /// E of the last linearise(), this rank's part [J]; springs are not counted.
  double energy() const { return energy_; }

  /// The smallest det F of the last linearise() on this rank, and the face where it is.
  struct Worst {
    double ratio = 1;
    Index face = -1;
    void take(double other, Index at) {
      if (!(other >= ratio)) ratio = other, face = at;
    }
  };
  Worst worst() const { return worst_; }
  /// Takes (flux face, F, P) of the last linearise(), those of this rank (its owner's cell is); F(i, j) =
  /// d x_i / d X_j, and with edges what the face's share of them makes of it.
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  void visit(const Take& take);
  /// dP/dF of a face of this rank and the cofactors of F at the last linearise(); entry i * 3 + j of P_ij. Three-cornered
  /// faces as if they shared nothing with their edges. One volume ratio a cell: the cofactors alone also of the faces
  /// between an owned cell and its owner on another rank.
  struct FaceTangent {
    Index face;
    Eigen::Matrix<double, 9, 9> stiffness;
    Tensor3 cofactors;
  };
  void visit_tangents(const std::function<void(const FaceTangent&)>& take);
  /// U'' / V of an owned cell at the last linearise() [Pa/m^3]; one volume ratio a cell.
  double modulus(Index cell) const { return cells_.modulus[std::size_t(cell)]; }
  /// Of a local node (cells, then boundary faces) at the last linearise(), or what was applied since.
  Vec3 displacement(Index node) const { return space_.value(node); }
  /// As ElasticKernel::holding_forces(), of displacements `unknowns`. Collective.
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads);
  /// Thermal stretches theta of the local flux faces, until other ones are given: F = F_e theta, the energy is that of F_e
  /// (finite_law.hpp), one volume ratio a cell sees the mean of theta^3. Empty: none. Collective.
  void set_stretch(std::span<const double> of_faces);

 private:
  /// One volume ratio a cell; of owned cells unless said otherwise. Empty: the faces' ratio.
  struct Cells {
    std::vector<double> of_nodes;  // sums, then pressures, of local nodes
    std::vector<double> volume;
    std::vector<double> swelling;           // mean theta^3; empty: 1
    std::vector<double> modulus, pressure;  // U'' / V and U'(J) at the last linearise()
    std::vector<double> own, change;        // pressures of their own p and its change
    std::vector<double> there;  // pressures of nodes at the last linearise(), with edges that share
    double fraction = 0;
  };
  void stretch_edges();
  void internal_forces();
  void deform(finite::Group& group);
  void find_pressures();
  std::span<double> sum_over_ranks(std::vector<double>& of_nodes) const;
  void sum_volume_changes();
  void conserving_forces();
  void conserving_pressures();
  void finish(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
              std::span<double> result);
  finite::Values values();
  const FiniteLaw& law_of(Index cell) const {
    return *laws_[laws_.size() == 1 ? 0 : std::size_t(mesh_.material_of(cell))];
  }

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  SymmetricSpace space_;
  std::vector<const FiniteLaw*> laws_;
  std::vector<finite::Group> groups_;
  finite::Group elsewhere_;  // faces of owned cells that other ranks own: F alone; one volume ratio a cell
  std::unique_ptr<FiniteEdges> edges_;  // none: no three-cornered faces in space
  Cells cells_;
  FollowerPressure pressure_;
  Vec3 pressure_force_ = Vec3::Zero();
  bool has_start_ = false;
  double energy_ = 0;
  Worst worst_;
};

/// The tangent of a deformed body at the last linearise() of its kernel, assembled: for factors of small bodies. As
/// symmetric_matrix(): three-cornered faces as if they shared nothing with their edges, and without the tangent of a
/// pressure that follows the surface. `of_nodes`: on the diagonals of the unknown nodes; empty: none. Collective.
linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes);

}  // namespace couplet::elastic
