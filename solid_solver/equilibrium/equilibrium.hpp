// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/elasticity/elastic_kernel.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/matrix.hpp"
#include "solid_solver/boundary/seat.hpp"
#include "solid_solver/method/solution_method.hpp"

namespace couplet::solid {

/// Factors and preconditioners for one size of the inertia term, created once.
struct SolidSystem {
  double mass_factor;                      ///< (d + alpha c)/s, see SolidStepper [1/s^2]; 0 if static
  std::vector<double> inertia;             ///< per owned cell: mass factor times mass [N/m]; empty if static
  std::unique_ptr<SolutionMethod> method;  ///< nullptr at large strain
  std::vector<double> node_inertia;        ///< of the unknown nodes, for Newton's method; empty if static
  /// nullptr if there is none.
  linalg::ResidualProjection* projection() const { return method ? method->projection() : nullptr; }
};

/// Right-hand side of M m u + A(u) = b, and the start of its solution.
struct EquilibriumLoad {
  std::span<const double> rows;   ///< b
  std::span<const double> known;  ///< columns of the operator; empty if zero
  /// Known columns of the first guess, from which a linear first step leads to `known`; empty if the guess already has them.
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

/// Resistance A(u) of a body, and the solution of M m u + A(u) = b. A state consists of the unknowns of
/// ElasticOperator and its known columns. Collective.
class Equilibrium {
 public:
  virtual ~Equilibrium() = default;
  /// `u`: first guess on entry. The residual of the statistics is relative at large strain. Throws SolveFailure; `u` is then undefined.
  virtual linalg::SolveStatistics find(const EquilibriumLoad& load, SolidSystem& system,
                                       std::span<double> u) = 0;
  /// Internal forces A(u); those of a follower pressure have the opposite sign.
  virtual std::vector<double> forces(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Strain energy over all ranks [J].
  virtual double energy(std::span<const double> unknowns, std::span<const double> known) = 0;
  /// Force on the body at each patch under these loads, and its moment about the origin in the configuration
  /// of the equilibrium; this rank's part. Empty if the gradient has no trial functions.
  virtual std::vector<elastic::Wrench> holding_forces(std::span<const double> unknowns,
                                                      std::span<const double> known,
                                                      const elastic::ElasticLoads& loads) = 0;
  /// Cauchy stress [Pa] of local faces and owned cells.
  virtual std::vector<Tensor3> face_stress(const Displaced& state, Index first, Index count) = 0;
  virtual std::vector<Tensor3> cell_stress(const Displaced& state) = 0;
};

}  // namespace couplet::solid
