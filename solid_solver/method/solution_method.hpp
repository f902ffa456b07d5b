// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/linalg/linear_solver.hpp"
#include "common/linalg/residual_projection.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/boundary/rigid_patches.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {

/// What a method solves: (diag(inertia) + A) u = b with the rows and unknowns of ElasticOperator. All that is
/// referred to must outlive the method.
struct SolidProblem {
  const mesh::Mesh& mesh;
  const elastic::ElasticOperator& elastic;
  std::span<const double> inertia;       ///< per owned cell [N/m]; empty: static
  const elastic::ElasticKernel& kernel;  ///< A, with the face gradient that was chosen
  double mass_factor = 0;                ///< of the kernel's own mass [1/s^2], where it has one
  const RigidPatches* rigid = nullptr;   ///< null: no patch moves as a rigid body
  /// Where the body stands.
  const mesh::Geometry& geometry() const { return elastic.geometry(); }
  bool is_static() const { return inertia.empty(); }
  bool is_symmetric() const { return kernel.is_symmetric(); }
  bool is_corrected() const { return kernel.scheme() == elastic::FaceGradientScheme::corrected; }
  /// y = (diag(inertia) + A) x. Collective.
  void apply(std::span<const double> x, std::span<double> y) const;
  /// r = b - (diag(inertia) + A) u. Collective.
  void residual(std::span<const double> b, std::span<const double> u, std::span<double> r) const;
};

/// Solves one problem again and again: what does not change with b is made once. Collective.
class SolutionMethod {
 public:
  virtual ~SolutionMethod() = default;
  /// `b`, `u`: packed rows of this rank (owned cells, then unknown faces); `u` holds the guess. Throws
  /// SolveFailure if the tolerance was not reached.
  virtual linalg::SolveStatistics solve(std::span<const double> b, std::span<double> u) = 0;
  /// z near A^-1 r, symmetric and positive, by what the iteration has at hand; false: there is nothing. Collective.
  virtual bool approximate_inverse(std::span<const double> /*r*/, std::span<double> /*z*/) { return false; }
  /// What the next first guess learns from accepted steps; none: nothing.
  linalg::ResidualProjection* projection() const { return projection_.get(); }
  /// "block-coupled (direct), thesis's face gradient": for the log, with the reason if the program chose.
  const std::string& name() const { return name_; }

 protected:
  std::string name_;
  std::unique_ptr<linalg::ResidualProjection> projection_;

 private:
  friend std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem&, const MethodParameters&);
};

/// The method that the parameters ask for; `automatic` picks by size and scene, the name says what and why.
std::unique_ptr<SolutionMethod> make_solution_method(const SolidProblem& problem,
                                                     const MethodParameters& parameters);

/// The face gradient that the parameters ask for; `automatic`: the symmetric one, which neither locks nor lets motion grow,
/// or the thesis's where the symmetric one cannot be (symmetric_suits()).
elastic::FaceGradientScheme face_gradient_scheme(const SolidParameters& parameters);

/// Euclidean norm over all ranks.
double norm(MPI_Comm comm, std::span<const double> values);

}  // namespace couplet::solid
