// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
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
class Archive;
}

namespace couplet::solid {

class LoadPath;

/// Factors and preconditioners for one size of the inertia term, created once.
struct SolidSystem {
  double mass_factor;                      ///< (d + alpha c)/s, see SolidStepper [1/s^2]; 0 if static
  std::vector<double> inertia;             ///< per owned cell: mass factor times mass [N/m]; empty if static
  std::unique_ptr<SolutionMethod> method;  ///< nullptr if the equilibrium has its own
  std::vector<double> node_inertia;        ///< of the unknown nodes, for Newton's method; empty if static
  /// nullptr if there is none.
  linalg::ResidualProjection* projection() const { return method ? method->projection() : nullptr; }
};

/// Right-hand side of M m u + A(u) = b, and the start of its solution.
struct EquilibriumLoad {
  std::span<const double> rows;   ///< b
  std::span<const double> known;  ///< columns of the operator; empty if zero
  /// Known columns of the first guess, from which a linear first step leads to `known`; empty if the
  /// guess already has them.
  std::span<const double> before;
  double mass_factor = 0;  ///< m
  /// Use the stress that conserves energy and momenta from the accepted state on.
  bool is_conserving = false;
  std::span<const double> accepted{}, accepted_known{};  ///< the accepted state
  std::span<const double> inertia{};                     ///< per owned cell, m times mass; empty if static
  std::span<const double> node_inertia{};                ///< of the unknown nodes, for kernels with mass
  double dt = 0;                                         ///< of the step [s]
  Pressing* pressing = nullptr;                          ///< by a seat; nullptr if there is none
};

/// Displacement and quantities computed from it. Calls are collective.
struct Displaced {
  std::function<std::vector<double>()> unknowns;  ///< of ElasticOperator
  std::span<const double> known;                  ///< its columns
  /// Gradients of the local faces first, first + 1, ... (`count` of them), and of the owned cells.
  std::function<std::vector<Tensor3>(Index first, Index count)> face_gradients;
  std::function<std::vector<Tensor3>()> cell_gradients;
};

/// Softest motion of a body about an equilibrium, see Equilibrium::lowest_stiffness().
struct SoftMotion {
  double stiffness = 1;
  std::vector<double> shape{};  ///< by the rows of ElasticOperator; empty if unknown
};

/// Optional capabilities of an equilibrium.
struct EquilibriumMeans {
  bool recovers_stress = false;  ///< recovers stress at points from patches of cells
  bool has_products = false;     ///< products of ElasticPart give the work of a stage
  /// Two gradients of a displacement judge mesh and energy; otherwise the energy of the law does.
  bool compares_gradients = false;
  bool has_tangent = false;  ///< lowest_stiffness() is available
  /// Pressures remain normal to the moving surface and so are part of A: set_pressure().
  bool takes_pressure = true;
};

/// Resistance of a body at small or large strain, and the solution of M m u + A(u) = b. A state consists of
/// the unknowns of ElasticOperator and its known columns. All functions but the first ones are collective.
class Equilibrium {
 public:
  virtual ~Equilibrium() = default;
  virtual EquilibriumMeans means() const { return {}; }
  /// Name for the log.
  virtual std::string name(const SolidSystem& system) const = 0;

  /// Sets the density of local cells [kg/m^3] in dynamic analyses.
  virtual void set_density(std::span<const double> /*of_cells*/) {}
  /// Prepares the system for a size of the inertia term.
  virtual void prepare(const SolidProblem& /*problem*/, SolidSystem& /*system*/) const {}
  /// Sets a follower pressure [Pa], one value per boundary face of owned cells.
  virtual void set_pressure(std::vector<double> of_faces) = 0;
  /// Contribution of the known columns to b; empty if find() computes it.
  virtual std::vector<double> force_of_known(std::span<const double> /*known*/) const { return {}; }
  /// `u`: first guess on entry. Throws SolveFailure; `u` is then undefined.
  virtual linalg::SolveStatistics find(const EquilibriumLoad& load, SolidSystem& system,
                                       std::span<double> u) = 0;
  /// Handles a failed static step: throws SchemeFailure if a shorter step would meet the same equations.
  virtual void explain_failure(const SolveFailure&) const {}
  /// Ends the current step; accept() makes it the start of the next one. Throws SolveFailure.
  virtual void end_step(std::span<const double> /*unknowns*/, std::span<const double> /*known*/) {}
  virtual void accept() {}
  /// Saves or loads what the accepted state adds to these unknowns and known columns.
  virtual void visit(io::Archive&, std::span<const double> /*unknowns*/, std::span<const double> /*known*/) {}

  /// Path whose load factor multiplies all loads and is an unknown of find(); nullptr for fixed loads.
  virtual LoadPath* load_path() { return nullptr; }

  /// Internal forces A(u); those of the pressure have the opposite sign.
  virtual std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Strain energy over all ranks [J].
  virtual double energy(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Resultant of the pressure at the last evaluated state on this rank [N].
  virtual Vec3 pressure_force() { return Vec3::Zero(); }
  /// Force on the body at each patch under these loads, and its moment about the origin in the configuration
  /// of the equilibrium; this rank's part. Empty if the gradient has no trial functions.
  virtual std::vector<elastic::Wrench> holding_forces(std::span<const double> unknowns,
                                                      std::span<const double> known,
                                                      const elastic::ElasticLoads& loads) = 0;
  /// Relative size of the `residual` of find() with respect to the rows.
  virtual double share_left(double residual, double rows) const = 0;

  /// Converts displacement gradients, entry (i, j) = d u_j/d x_i, to strains.
  virtual void to_strain(std::span<Tensor3> gradients) const = 0;
  /// Cauchy stress [Pa] of local faces and owned cells.
  virtual std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) = 0;
  virtual std::vector<Tensor3> cell_stress(const Displaced& state) = 0;

  /// Smallest x . K x of the tangent K at an equilibrium, over that of `elastic`. 1 without load, negative if
  /// unstable (an upper bound, and so a proof). 1 also for follower pressures on a surface with a free rim,
  /// which have no energy. `start`: forces without the symmetry of the body.
  virtual SoftMotion lowest_stiffness(std::span<const double> /*unknowns*/, std::span<const double> /*known*/,
                                      const linalg::LinearMap& /*elastic*/, std::vector<double> /*start*/) {
    return {};
  }
  /// Sets thermal strains not included in the stress, one per local flux face (empty means unchanged).
  virtual void set_expansion(const std::function<std::vector<double>()>& /*of_faces*/) {}
  /// Position of the loaded surface, given its moved points; empty if undeformed, where tractions are known.
  virtual std::span<const Vec3> surface(std::span<const Vec3> /*moved*/) const { return {}; }
};

}  // namespace couplet::solid
