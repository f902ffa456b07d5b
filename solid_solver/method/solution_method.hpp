// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/residual_projection.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// Linear system (diag(inertia) + A) u = b with the rows and unknowns of ElasticOperator. All references must outlive the method.
struct SolidProblem {
  const mesh::Mesh& mesh;
  const elastic::ElasticOperator& elastic;
  std::span<const double> inertia;       ///< per owned cell [N/m]; empty if static
  const elastic::ElasticKernel& kernel;  ///< A, with the selected face gradient
  double mass_factor = 0;                ///< of the kernel's own mass [1/s^2], if it has one
  /// Projects displacements or forces, on the unknowns, to those of patches that move as rigid bodies; empty if none does.
  std::function<void(std::span<double>)> project{};
  /// Configuration of the body.
  const mesh::Geometry& geometry() const { return elastic.geometry(); }
  bool is_static() const { return inertia.empty(); }
  bool is_symmetric() const { return kernel.is_symmetric(); }
  /// y = (diag(inertia) + A) x. Collective.
  void apply(std::span<const double> x, std::span<double> y) const;
  /// r = b - (diag(inertia) + A) u. Collective.
  void residual(std::span<const double> b, std::span<const double> u, std::span<double> r) const;
};

/// Solves one problem repeatedly; data that do not depend on b are created once. Collective.
class SolutionMethod {
 public:
  virtual ~SolutionMethod() = default;
  /// `b`, `u`: packed rows of this rank (owned cells, then unknown faces); `u` holds the guess. Where an iteration that the
  /// program chose does not converge, factors take over from then on if they fit into memory, and the log says so. Throws
  /// SolveFailure if the tolerance was not reached.
  linalg::SolveStatistics solve(std::span<const double> b, std::span<double> u);
  /// z near A^-1 r, symmetric and positive, by what the iteration has at hand; false: there is nothing. Collective.
  bool approximate_inverse(std::span<const double> r, std::span<double> z) {
    return instead_ ? instead_->invert(r, z) : invert(r, z);
  }
  /// Projection that improves first guesses from accepted steps; nullptr if there is none.
  linalg::ResidualProjection* projection() const { return projection_.get(); }
  /// True once factors have taken the place of the iteration.
  bool is_cured() const { return bool(instead_); }
  /// Puts factors in the place of the iteration, which failed for `b` or, if that is empty, in the run that this one resumes.
  /// Returns false if it cannot. Collective.
  bool cure(std::span<const double> b = {});
  /// For the log, such as "block-coupled (direct), thesis's face gradient", with the reason of `automatic`.
  const std::string& name() const { return name_; }

 protected:
  std::string name_;
  std::unique_ptr<linalg::ResidualProjection> projection_;

 private:
  virtual linalg::SolveStatistics find(std::span<const double> b, std::span<double> u) = 0;
  virtual bool invert(std::span<const double> /*r*/, std::span<double> /*z*/) { return false; }

  /// Creates factors of the same problem for a right-hand side on which the iteration failed, or gives nullptr. Empty if the
  /// case names the method.
  std::function<std::unique_ptr<SolutionMethod>(std::span<const double> b)> cure_;
  std::unique_ptr<SolutionMethod> instead_;  // the cure, once it was needed
  friend std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem&, const MethodParameters&);
};

/// Euclidean norm over all ranks.
double norm(MPI_Comm comm, std::span<const double> values);

/// Cost of factors of the symmetric gradient's matrix compared with multigrid. CPU seconds of one core of the
/// machine used for benchmarks/linalg/factors.csv; only ratios matter.
struct FactorCost {
  double entries;   ///< non-zeros of the factors
  double set_up;    ///< [s]
  double solve;     ///< with the factors [s]
  double by_cycle;  ///< one solve by CG with multigrid [s]
  /// Number of solves with one matrix at which factors become cheaper than multigrid; may be infinite.
  double pays_after() const;
  /// True if the factors fit into the memory allowed for a body of this size.
  bool fits() const { return entries <= most_entries; }

  static constexpr double most_entries = 1e8;  // 1 GB
};

/// Estimates the cost from the mesh. Nested dissection gives N log2 N entries in 2-D [george1973], and
/// N (N/l)^(1/3) for a body of aspect ratio l; N: row blocks. `heaviness`: see conjugate_gradients.hpp. Collective.
FactorCost factor_cost(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double heaviness);

}  // namespace couplet::solid
