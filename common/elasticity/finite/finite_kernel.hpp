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

/// Symmetric face gradient at large strain, total Lagrangian. With F_f = I + G_f(u) and P = dW/dF:
///   E(u) = sum_f V_f W(F_f),   inner forces dE/du,   tangent d2E/du2 = sum_f V_f B_f^T (dP/dF) B_f
/// The tangent is symmetric on any mesh and for any law. With one volume ratio per cell (near
/// incompressibility, ElasticOperator::volume_by_cells) the bulk part of the law uses the mean
///   J_P = sum_f V_fP det F_f / V_P,   E = sum_f V_f [W - U](F_f) + sum_P V_P U(J_P)
/// Triangles share most of their energy with their edges (SharedEdges). The rest is as in SymmetricKernel.
class FiniteKernel {
 public:
  /// `of_materials` has one law per material or one in total. Keeps references to mesh and rows.
  /// `plane_stress` selects a sheet in 2-D (finite_places.hpp). It excludes a volume ratio per cell, follower
  /// pressures and set_start(). Collective.
  FiniteKernel(const mesh::Mesh& mesh, const ElasticOperator& rows, std::vector<FiniteLaw> of_materials,
               bool plane_stress = false);
  ~FiniteKernel();
  /// Sets the density of the local cells [kg/m^3]. Without it there is no mass.
  void set_density(std::span<const double> of_cells) { space_.set_density(of_cells); }
  /// Starts an energy-conserving step at this state. Until forget_start(), linearise() takes u as the
  /// midpoint of the step and uses forces that conserve energy and momenta (conserving_stress()). Collective.
  void set_start(std::span<const double> unknowns, std::span<const double> known);
  void forget_start() { has_start_ = false; }
  /// Sets a follower pressure [Pa], one per boundary face of owned cells (FollowerPressure), until it is
  /// replaced. Its forces count as inner ones with opposite sign.
  void set_pressure(std::span<const double> of_faces) { pressure_.set(mesh_, rows_.geometry(), of_faces); }
  bool has_pressure() const { return !pressure_.empty(); }
  /// Resultant of that pressure at the last linearise() on this rank [N].
  Vec3 pressure_force() const { return pressure_force_; }
  /// Treats the pressures p as unknowns of the mixed form (one volume ratio per cell), so that they need not
  /// be U'(J):
  ///   dP/du du + H dp = ..., dp = U'' dJ + U' - p
  /// Newton's method eliminates p from its linear system. Near incompressibility U' of an intermediate state
  /// is useless, but p is not. The pressures start as U'(J) of the last linearise(). `false` returns to U'.
  void set_own_pressures(bool on);
  /// Predicts the change of p for a change of displacement from the last linearise(). Collective.
  void predict_pressures(std::span<const double> change, std::span<const double> known_change);
  /// Sets the fraction of that change for the next linearise(). accept_pressures() keeps the changed p.
  void set_pressure_fraction(double fraction) { cells_.fraction = fraction; }
  void accept_pressures();
  /// Adds the difference of the forces of the last linearise() with U'(J) and with p. Collective.
  void add_pressure_defect(std::span<double> result);
  /// Computes dE/du (u) + springs + mass_factor M u and stores the data for the tangent. Collective.
  void linearise(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                 std::span<double> result);
  /// Computes [d2E/du2 + springs + mass_factor M] v at the u of the last linearise(). `known` are changes of
  /// the known columns, zero if empty. Collective.
  void apply_tangent(std::span<const double> v, std::span<const double> known, double mass_factor,
                     std::span<double> result);
  /// E of the last linearise() without springs, this rank's contribution [J].
  double energy() const { return energy_; }

  /// Smallest det F of the last linearise() on this rank, and its face.
  struct WorstFace {
    double ratio = 1;
    Index face = -1;
    void take(double other, Index at) {
      if (!(other >= ratio)) ratio = other, face = at;
    }
  };
  WorstFace worst() const { return worst_; }
  /// Receives (flux face, F, P) of the last linearise() for the faces whose owner cell is on this rank. F(i,
  /// j) = d x_i / d X_j. P includes the share of the edges.
  using Take = std::function<void(Index, const Tensor3&, const Tensor3&)>;
  void visit(const Take& take);
  /// dP/dF (entry i * 3 + j for P_ij) of a face of this rank and the cofactors of F at the last linearise().
  /// Shared edges are ignored. With one volume ratio per cell, other ranks' faces at owned cells are visited
  /// too, only for the cofactors.
  struct FaceTangent {
    Index face;
    Eigen::Matrix<double, 9, 9> stiffness;
    Tensor3 cofactors;
  };
  void visit_tangents(const std::function<void(const FaceTangent&)>& take);
  /// U'' / V of an owned cell at the last linearise() [Pa/m^3], with one volume ratio per cell.
  double modulus(Index cell) const { return cells_.modulus[std::size_t(cell)]; }
  /// Displacement of a local node (cells, then boundary faces) in the last evaluation.
  Vec3 displacement(Index node) const { return space_.value(node); }
  /// Reaction forces as ElasticKernel::holding_forces(), for displacements `unknowns`. Collective.
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads);
  /// Sets thermal stretches theta of the local flux faces, or removes them if empty. F = F_e theta, and the
  /// energy is that of F_e (finite_law.hpp). A volume ratio per cell uses the mean of theta^3. Collective.
  void set_stretch(std::span<const double> of_faces);

 private:
  /// Volume ratios per owned cell (unless stated otherwise). Empty if each face has its own.
  struct Cells {
    std::vector<double> of_nodes;  // sums, then pressures, of local nodes
    std::vector<double> volume;
    std::vector<double> swelling;           // mean theta^3; empty stands for 1
    std::vector<double> modulus, pressure;  // U'' / V and U'(J) at the last linearise()
    std::vector<double> own, change;        // independent pressures p and their change
    std::vector<double> there;              // node pressures at the last linearise(), with shared edges
    double fraction = 0;
  };
  void stretch_edges();
  void internal_forces();
  void deform(finite::FaceSet& group);
  void find_pressures();
  std::span<double> sum_over_ranks(std::vector<double>& of_nodes) const;
  void sum_volume_changes();
  void conserving_forces();
  void conserving_pressures();
  void finish(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
              std::span<double> result);
  finite::Values values();
  const FiniteLaw& law_of(Index cell) const {
    return laws_[laws_.size() == 1 ? 0 : std::size_t(mesh_.material_of(cell))];
  }

  const mesh::Mesh& mesh_;
  const ElasticOperator& rows_;
  SymmetricSpace space_;
  const std::vector<FiniteLaw> laws_;
  std::vector<finite::FaceSet> groups_;
  finite::FaceSet elsewhere_;  // other ranks' faces at owned cells: only F, for one volume ratio per cell
  std::unique_ptr<FiniteEdges> edges_;  // nullptr without triangular faces in 3-D
  Cells cells_;
  FollowerPressure pressure_;
  Vec3 pressure_force_ = Vec3::Zero();
  bool has_start_ = false;
  double energy_ = 0;
  WorstFace worst_;
};

/// Assembled tangent at the last linearise(), for factorizations of small bodies. As in symmetric_matrix(),
/// it ignores shared edges and the tangent of a follower pressure. `of_nodes` is added on the diagonals of
/// unknown nodes, unless it is empty. Collective.
linalg::SparseMatrix finite_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, FiniteKernel& kernel,
                                   std::span<const double> of_nodes);

}  // namespace couplet::elastic
