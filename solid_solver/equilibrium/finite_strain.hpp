// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/finite/finite_kernel.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/equilibrium/large_strain.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "solid_solver/equilibrium/tangent_solver.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// One iterate of Newton's method.
struct NewtonIterate {
  double residual = 0;  ///< norm relative to the load
  double length = 1;    ///< of the step that led here
  double ratio = 1;     ///< smallest det F of any face
  int linear = 0;       ///< iterations of the linear solver
};

/// Equilibrium of a body at large strain, including inertia: M m u + dE/du(u) = b. Uses Newton's method with the consistent tangent and a
/// line search that keeps det F positive. The linear tolerance follows [eisenstat1996] (formula 2.6: eta = 0.9 (r/r_before)^2, between 1e-4
/// and 0.05). The residual may grow temporarily: a bending beam passes states with far larger membrane forces than at either end.
class FiniteStrain final : public LargeStrain {
 public:
  /// Throws Error for unsupported cases. Keeps references to mesh and rows. Collective.
  FiniteStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
               const SolidParameters& parameters);

  std::string name() const override;
  /// Sets the density of local cells [kg/m^3] in dynamic analyses.
  void set_density(std::span<const double> of_cells) { kernel_->set_density(of_cells); }
  using Load = EquilibriumLoad;
  linalg::SolveStatistics find(const Load& load, SolidSystem& system, std::span<double> u) override;
  void set_pressure(std::vector<double> of_faces) override;
  /// Sets thermal strains not included in the stress, one per local flux face (empty means unchanged).
  void set_expansion(std::vector<double> of_faces);
  std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) override;
  double energy(std::span<const double> unknowns, std::span<const double> known) override;
  void visit(std::span<const double> unknowns, std::span<const double> known, const Take& take) override;
  /// Sensitivity of a static equilibrium: relative change of the displacement if the whole body became softer, over the relative softening.
  /// 1 for a linear body under loads, large near buckling. Prescribed displacements do not respond and count as 1. Throws SolveFailure.
  double softness(std::span<const double> unknowns, std::span<const double> known);
  /// Smallest x . K x of the tangent K at an equilibrium, over that of `elastic`. 1 without load, negative if
  /// unstable (an upper bound, and so a proof). 1 also for follower pressures on a surface with a free rim,
  /// which have no energy. `start`: forces without the symmetry of the body.
  double lowest_stiffness(std::span<const double> unknowns, std::span<const double> known,
                          const linalg::LinearMap& elastic, std::vector<double> start);
  Vec3 pressure_force() const override { return kernel_->pressure_force(); }
  std::vector<elastic::Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                              const elastic::ElasticLoads& loads) override {
    return kernel_->holding_forces(unknowns, known, loads);
  }
  /// Path whose load factor multiplies all loads and is an unknown of find(); nullptr for fixed loads.
  LoadPath* load_path() { return path_ ? &*path_ : nullptr; }
  void visit(io::Archive& archive, std::span<const double>, std::span<const double>) override;
  /// Newton iterates of the last solve.
  const std::vector<NewtonIterate>& iterates() const { return iterates_; }
  /// Summary of the last solve, for example "3 iterations of Newton's method, ...".
  std::string text() const;

 private:
  double residual(const Load& load, std::span<const double> u, double& ratio);
  linalg::SolveStatistics press(const Load& load, std::span<double> u);
  void start_pressures(const Load& load, std::span<const double> u);
  void predict_pressures(std::span<const double> change, std::span<const double> known_change);
  bool search(const Load& load, std::span<double> u, NewtonIterate& now, double most);
  void follow_known(const Load& load, TangentSolver& solver, std::span<double> u);
  double scale_of(const Load& load, std::span<const double> u, double residual);
  linalg::SolveStatistics iterate(const Load& load, std::span<double> u);
  std::vector<double> backward_motion(const Load& load, std::span<const double> before,
                                      std::span<const double> u);
  struct PathSearch;
  linalg::SolveStatistics follow_path(const Load& load, std::span<double> u);
  void scale_loads(PathSearch& path, double factor);
  void find_push(PathSearch& path, std::span<const double> u);
  void search_path(PathSearch& path, std::span<double> u, double change, double most);
  void leave(PathSearch& path, TangentSolver& solver, std::span<double> u);
  void correct(PathSearch& path, TangentSolver& solver, std::span<double> u);
  /// Residual over the load at which round-off ended the iteration. Reports a large one once; 0 without load. Collective.
  double judge_rounding(const Load& load, double scale, double left);
  TangentSolver& solver_for(double mass_factor, std::span<const double> node_inertia,
                            const Pressing* pressing = nullptr);
  std::string where_worst() const;
  bool is_symmetric(std::span<const double> x, std::span<const double> y);
  double stiffest_over(std::span<const double> x, const linalg::LinearMap& elastic) const;

  TangentSolver::By by_ = TangentSolver::By::frames;
  bool mixed_ = false;       // pressures are separate unknowns during the iteration
  bool is_carried_ = false;  // in the current solve
  bool presses_ = false, is_drowned_told_ = false;
  double tolerance_, noise_, noise_of_motion_;
  double whole_ = 0;  // norm of the last residual with U'(J) instead of those pressures
  int most_linear_;
  std::unique_ptr<elastic::FiniteKernel> kernel_;
  std::vector<std::unique_ptr<TangentSolver>> solvers_;  // by size of the inertia, latest first
  std::vector<double> r_, trial_, du_;
  StepJump jump_;
  bool is_restored_ = false;            // the next expansion is that of the restored equilibrium
  std::optional<LoadPath> path_;        // empty if the loads follow the time
  std::vector<double> whole_pressure_;  // at load factor 1
  std::vector<NewtonIterate> iterates_;
};

}  // namespace couplet::solid
