// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/boundary/seat.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::io {
class CheckpointReader;
class CheckpointWriter;
}  // namespace couplet::io

namespace couplet::solid {

class LoadPath;

/// What belongs to one size of the inertia term: factors and preconditioners are made once for it.
struct SolidSystem {
  double mass_factor;                      ///< (d + alpha c) / s, see SolidStepper [1/s^2]; 0: static
  std::vector<double> inertia;             ///< per owned cell: mass factor times mass [N/m]; empty: static
  std::unique_ptr<SolutionMethod> method;  ///< null: the equilibrium has its own
  std::vector<double> node_inertia;        ///< of Newton's method: of the unknown nodes; empty: static
  linalg::ResidualProjection* projection() const {
    return method ? method->projection() : nullptr;
  }  ///< null: none
};

/// What must be reached: M m u + A(u) = b, and where it comes from.
struct EquilibriumLoad {
  std::span<const double> rows;   ///< b
  std::span<const double> known;  ///< columns of the operator; empty: zeros
  std::span<const double>
      before;                  ///< the known columns of the first guess, from which a first linear step leads
                               ///< to `known`; empty: the guess has them already
  double mass_factor = 0;      ///< m
  bool is_conserving = false;  ///< stress that keeps energy and momenta from the accepted state on
  std::span<const double> accepted{}, accepted_known{};  ///< the accepted state
  std::span<const double> inertia{};                     ///< per owned cell, m times mass; empty: static
  std::span<const double> node_inertia{};                ///< of the unknown nodes, of kernels with mass
  double dt = 0;                                         ///< of the step [s]
  Pressing* pressing = nullptr;                          ///< of a seat; none: the body meets none
};

/// A displacement, with what can be made of it. Calls are collective.
struct Displaced {
  std::function<std::vector<double>()> unknowns;  ///< of ElasticOperator
  std::span<const double> known;                  ///< its columns
  /// Gradients of the local faces first, first + 1, ... (`count` of them), and of the owned cells.
  std::function<std::vector<Tensor3>(Index first, Index count)> face_gradients;
  std::function<std::vector<Tensor3>()> cell_gradients;
};

/// The softest motion of a body about an equilibrium, see Equilibrium::lowest_stiffness().
struct SoftMotion {
  double stiffness = 1;
  std::vector<double> shape{};  ///< by the rows of ElasticOperator; empty: not known
};

/// Means of judging a state, which not every equilibrium has.
struct EquilibriumMeans {
  bool recovers_stress = false;  ///< stress at points by patches of cells
  bool has_products = false;     ///< those of ElasticPart are the work of a stage
  /// Two gradients of one displacement judge mesh and energy; else the energy of the law does.
  bool compares_gradients = false;
  bool has_tangent = false;  ///< softness() and lowest_stiffness() are known
  /// Pressures stay normal to the surface that moves, so that they are a part of A: set_pressure().
  bool takes_pressure = true;
};

/// How a body resists, at small strain or at large, and how M m u + A(u) = b is solved for it. A state is the unknowns of
/// ElasticOperator with its known columns. All but the first functions are collective.
class Equilibrium {
 public:
  virtual ~Equilibrium() = default;
  virtual EquilibriumMeans means() const { return {}; }
  /// For the log.
  virtual std::string name(const SolidSystem& system) const = 0;

  /// Of the local cells [kg/m^3]; dynamic analyses.
  virtual void set_density(std::span<const double> /*of_cells*/) {}
  /// What a size of the inertia term needs is made.
  virtual void prepare(const SolidProblem& /*problem*/, SolidSystem& /*system*/) const {}
  /// A pressure [Pa] on boundary faces of owned cells, one each, that follows the surface.
  virtual void set_pressure(std::vector<double> of_faces) = 0;
  /// What the known columns take from b; empty: find() does it.
  virtual std::vector<double> force_of_known(std::span<const double> /*known*/) const { return {}; }
  /// `u`: the first guess on entry. Throws SolveFailure, `u` being of no use then.
  virtual linalg::SolveStatistics find(const EquilibriumLoad& load, SolidSystem& system,
                                       std::span<double> u) = 0;
  /// A static step has failed: throws SchemeFailure if a shorter step would meet the same equations.
  virtual void explain_failure(const SolveFailure&) const {}
  /// The end of the step under way, which accept() makes the state that the next one begins at. Throws SolveFailure.
  virtual void end_step(std::span<const double> /*unknowns*/, std::span<const double> /*known*/) {}
  virtual void accept() {}
  virtual void save(io::CheckpointWriter&) const {}
  virtual void load(io::CheckpointReader&, std::span<const double>, std::span<const double>) {}

  /// All loads are multiplied by its load factor, an unknown of find(); null: they are as they stand.
  virtual LoadPath* load_path() { return nullptr; }

  /// Inner forces A(u), those of the pressure counted with the opposite sign.
  virtual std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Strain energy over all ranks [J].
  virtual double energy(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Resultant of the pressure at the state that was looked at last, this rank's [N].
  virtual Vec3 pressure_force() { return Vec3::Zero(); }
  /// Force on the body at each patch at a state under these loads, with its moment about the origin where the body is taken to
  /// stand; this rank's part. Empty: the gradient has no trial functions, by which that could be told.
  virtual std::vector<elastic::Wrench> holding_forces(std::span<const double> unknowns,
                                                      std::span<const double> known,
                                                      const elastic::ElasticLoads& loads) = 0;
  /// What find() has left, its `residual`, over the size of the rows.
  virtual double share_left(double residual, double rows) const = 0;

  /// Displacement gradients, entry (i, j) = d u_j / d x_i, become strains.
  virtual void to_strain(std::span<Tensor3> gradients) const = 0;
  /// Cauchy's stress [Pa] of local faces and of owned cells.
  virtual std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) = 0;
  virtual std::vector<Tensor3> cell_stress(const Displaced& state) = 0;

  /// Of a state at rest in equilibrium: by how much it would give way, over itself, were the whole body softer by a (small)
  /// share, over that share; of a linear body under loads 1, near a buckling load large. What is moved by prescribed
  /// displacements gives way to nothing and counts as 1. Throws SolveFailure.
  virtual double softness(std::span<const double> /*unknowns*/, std::span<const double> /*known*/) {
    return 1;
  }
  /// The least x . K x over that of `elastic`, K being the tangent at a state of equilibrium: 1 of a body without load, negative where the
  /// equilibrium does not hold (an upper bound, hence a proof). Of pressures that follow a surface with a free rim, which
  /// have no energy, nothing can be said so: 1. `start`: forces without the symmetry of the body.
  virtual SoftMotion lowest_stiffness(std::span<const double> /*unknowns*/, std::span<const double> /*known*/,
                                      const linalg::LinearMap& /*elastic*/, std::vector<double> /*start*/) {
    return {};
  }
  /// Gives the thermal strains that the stress does not see, one a local flux face (empty: as before), to those that take them.
  virtual void set_expansion(const std::function<std::vector<double>()>& /*of_faces*/) {}
  /// Where the surface stands on which tractions act, of its points moved; empty: undeformed, and given tractions are known there.
  virtual std::span<const Vec3> surface(std::span<const Vec3> /*moved*/) const { return {}; }
};

}  // namespace couplet::solid
