// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Symmetric matrix stored by rows of owned cells, all of the same width. A CG iteration then takes one pass
/// over the rows and two over the vectors. A loop over faces needs twice the instructions.
struct ViscousRows {
  Index width = 0;  ///< entries per row besides the diagonal: the largest number of neighbors of a cell
  /// Local cells and the faces between; unused entries hold the row's own cell and -1.
  std::vector<Index> column, face;
  std::vector<double> value;     ///< 0 for unused entries
  std::vector<double> diagonal;  ///< per owned cell

  explicit ViscousRows(const mesh::Mesh& mesh);
  Index size() const { return static_cast<Index>(diagonal.size()); }
};

/// Contribution of an eddy viscosity to the matrix, theta dt nu_t at interior faces (mean of the cells).
struct EddyShare {
  const std::vector<double>* eddy = nullptr;  ///< nu_t per local cell [m^2/s]; nullptr if there is none
  double factor = 0;                          ///< theta dt [s]
  double at(Index p, Index n) const { return eddy ? 0.5 * factor * ((*eddy)[p] + (*eddy)[n]) : 0; }
};

/// Solves A u = V u + beta sum_f g (u_P - u_f) = b for all components at once. Uses CG on D^(-1/2) A
/// D^(-1/2), which is Jacobi-preconditioned CG [hestenes1952]. beta = a nu dt [m^2], plus the eddy
/// viscosity's share at interior faces. The system is well conditioned if convection limits the step.
template <int D>
class ViscousSolver {
 public:
  ViscousSolver(const mesh::Mesh& mesh, const Boundary<D>& boundary) : mesh_(mesh), boundary_(boundary) {}
  /// Sets up the system for the following solves. Collective.
  void prepare(std::shared_ptr<const Placement<D>> at, double beta, const EddyShare& eddies = {});
  /// Inverse of the diagonal D, per owned cell.
  const std::vector<double>& inverse_diagonal() const { return inverse_diagonal_; }
  /// `b`: per local cell (owned ones are read), without boundary parts. `w`: given velocity per boundary
  /// face. `u`: guess on entry, with ghosts current on exit. Returns the iterations; throws SolveFailure.
  /// Collective.
  int solve(const Vectors<D>& w, double tolerance, Vectors<D>& b, Vectors<D>& u);

 private:
  /// Contribution of a boundary face to the row of its cell: beta g [t I + (1 - t) n n], see FaceRow.
  struct BoundaryRow {
    Index cell;
    double both, normal;  // beta g t, beta g (1 - t)
    Vec<D> n;
    Vec<D> times(const Vec<D>& x) const { return both * x + normal * x.dot(n) * n; }
  };
  void set_diagonal(const EddyShare& eddies);
  void set_entries(const EddyShare& eddies);
  double apply(Vectors<D>& x, Vectors<D>& y) const;
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  std::shared_ptr<const Placement<D>> at_;
  double beta_ = 0;
  bool with_eddies_ = false;
  std::unique_ptr<ViscousRows> a_;  // D^(-1/2) A D^(-1/2) without boundary_rows_
  std::vector<BoundaryRow> boundary_rows_;
  std::vector<double> inverse_diagonal_;
  std::vector<double> scale_;      // D^(-1/2), per local cell
  Vectors<D> x_, r_, q_, search_;  // vectors of the scaled system
};

/// Implicit part of modified Crank-Nicolson, V' u^p - a dt nu L' u^p = right-hand side, in passes on
/// non-orthogonal meshes. The stress of an eddy viscosity is explicit and damped.
template <int D>
class ImplicitFriction {
 public:
  ImplicitFriction(const Scene<D>& scene, const Step<D>& step, RateOperator<D>& rates)
      : scene_(scene),
        mesh_(scene.mesh),
        step_(step),
        rate_operator_(rates),
        solver_(scene.mesh, scene.boundary) {}

  /// Computes u^p for the boundary velocities w. `rates`: rates of `from`. `side`: modified. Collective.
  void solve(const State<D>& from, const Rates<D>& rates, const Vectors<D>& w, double a, Vectors<D>& side,
             Vectors<D>& u);
  int iterations() const { return iterations_; }

 private:
  double tolerance() const;
  void guess(const State<D>& from, const Rates<D>& rates, double a, const Vectors<D>& side,
             Vectors<D>& u) const;
  void add_eddies(const State<D>& from, Vectors<D>& side);
  void damp_eddies(const State<D>& from, const EddyShare& eddies, Vectors<D>& side) const;
  void solve_in_passes(const Vectors<D>& w, double a, const Vectors<D>& side, Vectors<D>& u);
  void accelerate(bool start, Vectors<D>& u);

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const Step<D>& step_;
  RateOperator<D>& rate_operator_;
  ViscousSolver<D> solver_;
  int iterations_ = 0;  // total so far
  Vectors<D> oblique_rate_, right_side_, before_, u_boundary_;
  std::vector<double> eddy_;  // of the velocity between the levels, as are the next vectors
  Vectors<D> between_, between_boundary_, eddy_rate_;
  std::unique_ptr<linalg::Accelerator> accelerator_;  // for meshes that need many passes
};

}  // namespace couplet::fluid
