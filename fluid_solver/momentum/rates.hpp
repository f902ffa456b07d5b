// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/linalg/acceleration.hpp"
#include "common/linalg/krylov.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Eddy viscosity of the unresolved scales [m^2/s] from the velocity gradient g_ij = du_i/dx_j of one cell
/// and its width D = V^(1/dimension):
///   Smagorinsky  (C D)^2 (2 S:S)^(1/2)                                              [smagorinsky1963]
///   WALE         (C D)^2 (Sd:Sd)^(3/2) / ((S:S)^(5/2) + (Sd:Sd)^(5/4))              [nicoud1999]
/// S is the symmetric part of g, Sd the traceless symmetric part of g g. WALE vanishes in pure shear and as
/// y^3 at walls.
template <int D>
double eddy_viscosity(const TurbulenceParameters& model, const Tensor<D>& gradient, double volume);

/// Eddy viscosity of all local cells. The ghosts of `gradient` must be current.
template <int D>
void eddy_viscosity(const TurbulenceParameters& model, const Placement<D>& at,
                    const std::vector<Tensor<D>>& gradient, std::vector<double>& eddy);

/// Gauss gradient du_i/dx_j per local cell (ghosts updated): (1/V) sum u_f S with u_f linear between the
/// cells. On skewed meshes it is made exact for linear fields. Collective.
template <int D>
void velocity_gradient(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                       const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient);

/// u.S of the interior faces [m^3/s], or its difference from `whole` if that is given. u is the mean of the
/// cells, on skewed meshes extrapolated to the face center by the mean gradient. Collective.
template <int D>
void mean_flux(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
               const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient, std::span<double> flux,
               std::span<const double> whole = {});

/// nu_t (grad u + grad u^T).S at an interior face between p and n [m^4/s^2], force per density. The normal
/// derivative is the difference of the two cells, also in grad u^T. The mean of their gradients may have the
/// other sign, for example where thin and thick cells meet at a wall, and the stress would drive the flow.
template <int D>
Vec<D> eddy_stress(const Placement<D>& at, const std::vector<double>& eddy, const Vectors<D>& u,
                   const std::vector<Tensor<D>>& gradient, Index f, Index p, Index n) {
  const double w = at.weight[f];
  const Tensor<D> mean = w * gradient[p] + (1 - w) * gradient[n];
  const Vec<D>& area = at.area[f];
  const Vec<D> straight = area - at.oblique_of(f), change = u[n] - u[p];  // g d, u_N - u_P
  const double normal = (at.conductance[f] * change - mean * straight).dot(area) / area.squaredNorm();
  return 0.5 * (eddy[p] + eddy[n]) *
         (at.conductance[f] * change + mean * at.oblique_of(f) + mean.transpose() * area + normal * area);
}

/// The same at a face of a symmetry plane or a slip wall with the velocity `outside`, beyond which the flow is mirrored.
template <int D>
Vec<D> mirrored_eddy_stress(const Placement<D>& at, double eddy, const Vec<D>& inside, const Vec<D>& outside,
                            Index f) {
  const Vec<D> normal = at.area[f].normalized();
  return 2 * eddy * at.conductance[f] * (outside - inside).dot(normal) * normal;
}

/// Velocity gradient at an interior face: the mean of the cells' gradients, with the difference of the two cells as
/// derivative along the normal.
template <int D>
Tensor<D> face_gradient(const Placement<D>& at, const Vectors<D>& u, const std::vector<Tensor<D>>& gradient,
                        Index f, Index p, Index n) {
  const double w = at.weight[f];
  const Tensor<D> mean = w * gradient[p] + (1 - w) * gradient[n];
  const Vec<D>& area = at.area[f];
  const Vec<D> straight = area - at.oblique_of(f);  // g d
  const Vec<D> miss = at.conductance[f] * (u[n] - u[p]) - mean * straight;
  return mean + miss * area.transpose() / area.squaredNorm();
}

/// Viscosity of a law in all local cells [Pa s]. The ghosts of `gradient` must be current.
template <int D>
std::vector<double> viscosity_in_cells(const FluidParameters& parameters, const State<D>& state,
                                       const std::vector<Tensor<D>>& gradient);

/// Optional part of the momentum equation. Every function itself loops over faces or cells, and is collective.
template <int D>
class MomentumTerm {
 public:
  /// Computes the gradient of a state's velocity on first use.
  using Gradient = std::function<const std::vector<Tensor<D>>&()>;
  virtual ~MomentumTerm() = default;
  /// Adds to the rate of a state. `split`: the viscous part is left to add_implicit().
  virtual void add_rate(const State<D>& state, bool split, const Gradient& gradient, Vectors<D>& rate) = 0;
  /// Sets the data of the term in a new state.
  virtual void start(State<D>&) {}
  /// Adds to the rates of convection and friction that limit the step, per local cell [m^3/s].
  virtual void add_limits(const State<D>&, Vectors<2>&) const {}
  /// Adds the viscous part of a step whose viscous term has the weight `a` at t^{n+1}: the known one to `rate`, and the
  /// viscosity times a dt that acts at t^{n+1} to `added`, per flux face [m^2].
  virtual void add_implicit(const State<D>&, const FluidStep<D>&, double /*a*/, Vectors<D>& /*rate*/,
                            std::vector<double>& /*added*/) {}
  /// Momentum per density that entered the fluid through the boundary faces in the last add_rate() without `split` or
  /// add_implicit() [m^4/s^2]; empty if the term does not act there.
  virtual std::span<const Vec<D>> boundary_flux() const { return {}; }
};
template <int D>
using MomentumTerms = std::vector<std::unique_ptr<MomentumTerm<D>>>;
/// Terms of a case: the dilatation of a compressible fluid, the stress of a turbulence model or a viscosity law.
template <int D>
MomentumTerms<D> make_momentum_terms(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                                     const FluidParameters& parameters);

/// Stress of a viscosity law beyond that of its smallest viscosity.
template <int D>
std::unique_ptr<MomentumTerm<D>> make_law_stress(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                                                 const FluidParameters& parameters);

/// Power over density that this stress takes from the fluid on this rank [m^5/s^3]. Collective.
template <int D>
double excess_dissipation(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                          const FluidParameters& parameters, const State<D>& state);

/// R = -sum phi u_f + nu sum [g du + (grad u)_f . k] at level n on mesh n, with skew-symmetric mid-point u_f
/// [trias2014]. `split`: the viscous part goes to Rates::viscous. `correct_oblique`: the mesh is not
/// orthogonal. Collective.
template <int D>
class RateOperator {
 public:
  RateOperator(const mesh::Mesh& mesh, const Boundary<D>& boundary, double kinematic_viscosity,
               MomentumTerms<D> terms = {})
      : mesh_(mesh), boundary_(boundary), nu_(kinematic_viscosity), terms_(std::move(terms)) {}
  const MomentumTerms<D>& terms() const { return terms_; }
  /// `gradient`: gradient of the state's velocity, if known.
  void apply(const State<D>& state, bool split, bool correct_oblique, Rates<D>& rates,
             const std::vector<Tensor<D>>* gradient = nullptr);
  /// Adds the non-orthogonal viscous part nu sum (grad u)_f . k of any velocity field (ghosts current).
  /// Collective.
  void add_oblique(const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& u_boundary,
                   Vectors<D>& rate);
  /// nullptr if the order is second everywhere.
  void set_fourth(const FourthOrder<D>* fourth) { fourth_ = fourth; }

 private:
  void add_oblique(const Placement<D>& at, const std::vector<Tensor<D>>& gradient, Vectors<D>& rate) const;
  void face_loop(const State<D>& state, bool split, Rates<D>& rates) const;
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  double nu_;
  MomentumTerms<D> terms_;
  const FourthOrder<D>* fourth_ = nullptr;
  std::vector<Tensor<D>> gradient_;
};

/// Viscous momentum flux out of the fluid through each boundary face [N]: mu g (u_P - u_b).
template <int D>
void wall_flux(const mesh::Mesh& mesh, const Placement<D>& at, double viscosity, const Vectors<D>& u,
               const Vectors<D>& u_boundary, Vectors<D>& force);

/// Matrix stored by rows of owned cells, all of the same width. A CG iteration then takes one pass
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

/// Contribution of a boundary face to the row of its cell: beta g [t I + (1 - t) n n], see FaceRow.
template <int D>
struct ViscousBoundaryRow {
  Index cell;
  double both, normal;  // beta g t, beta g (1 - t)
  Vec<D> n;
  Vec<D> times(const Vec<D>& x) const { return both * x + normal * x.dot(n) * n; }
};

/// Solves A u = V u + beta sum_f g (u_P - u_f) = b for all components at once. Uses CG on D^(-1/2) A
/// D^(-1/2), which is Jacobi-preconditioned CG [hestenes1952]. beta = a nu dt [m^2], plus `added` at
/// interior faces. The system is well conditioned if convection limits the step. With implicit convection, A u
/// also has sum_f F u_f with F = `carried`, the volume through a face, and GMRES solves it.
template <int D>
class ViscousSolver {
 public:
  ViscousSolver(const mesh::Mesh& mesh, const Boundary<D>& boundary) : mesh_(mesh), boundary_(boundary) {}
  /// Sets up the system for the following solves. Collective.
  void prepare(std::shared_ptr<const Placement<D>> at, double beta, std::span<const double> added = {},
               std::span<const double> carried = {});
  /// Inverse of the diagonal D, per owned cell.
  const std::vector<double>& inverse_diagonal() const { return inverse_diagonal_; }
  /// `b`: per local cell (owned ones are read), without boundary parts. `w`: given velocity per boundary
  /// face. `u`: guess on entry, with ghosts current on exit. Returns the iterations; throws SolveFailure.
  /// Collective.
  int solve(const Vectors<D>& w, double tolerance, Vectors<D>& b, Vectors<D>& u);

 private:
  void set_diagonal(std::span<const double> added);
  void set_entries(std::span<const double> added, std::span<const double> carried);
  void add_carried(std::span<const double> carried);
  double apply(Vectors<D>& x, Vectors<D>& y) const;
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  std::shared_ptr<const Placement<D>> at_;
  double beta_ = 0;
  bool has_more_ = false;           // than beta_ at faces
  bool carries_ = false;            // has implicit convection: A is not symmetric
  std::unique_ptr<ViscousRows> a_;  // D^(-1/2) A D^(-1/2) without boundary_rows_
  std::vector<ViscousBoundaryRow<D>> boundary_rows_;
  std::vector<double> inverse_diagonal_;
  std::vector<double> scale_;                     // D^(-1/2), per local cell
  Vectors<D> x_, r_, q_, search_;                 // vectors of the scaled system
  std::unique_ptr<linalg::KrylovSolver> krylov_;  // with implicit convection
};

/// Implicit part of modified Crank-Nicolson, V' u^p - a dt nu L' u^p = right-hand side, in passes on
/// non-orthogonal meshes. The viscous parts of terms are explicit and damped.
template <int D>
class ImplicitFriction {
 public:
  ImplicitFriction(const Scene<D>& scene, const FluidStep<D>& step, RateOperator<D>& rates)
      : scene_(scene),
        mesh_(scene.mesh),
        step_(step),
        rate_operator_(rates),
        solver_(scene.mesh, scene.boundary) {}

  /// Computes u^p for the boundary velocities w. `rates`: rates of `from`. `side`: modified. Collective.
  void solve(const State<D>& from, const Rates<D>& rates, const Vectors<D>& w, double a, Vectors<D>& side,
             Vectors<D>& u);
  int iterations() const { return iterations_; }
  const std::vector<double>& inverse_diagonal() const { return solver_.inverse_diagonal(); }
  /// Momentum per density that the terms let into the fluid through the boundary faces in this step [m^4/s^2], and their
  /// viscosity times a dt that acted there at t^{n+1}, per flux face [m^2]. Empty if no term acts there.
  const Vectors<D>& boundary_flux() const { return boundary_flux_; }
  std::span<const double> added() const { return added_; }

 private:
  double tolerance() const;
  void guess(const State<D>& from, const Rates<D>& rates, double a, const Vectors<D>& side,
             Vectors<D>& u) const;
  void damp(const State<D>& from, const Vectors<D>& w, Vectors<D>& side) const;
  Vec<D> cell_ahead(const State<D>& from, Index c) const;
  Vec<D> jump_ahead(const State<D>& from, Index b) const;
  void set_boundary_flux(const State<D>& from, const Vectors<D>& w, const Vectors<D>& u);
  void set_carried(const State<D>& from, double a);
  void carry(const State<D>& from, Vectors<D>& side) const;
  void solve_in_passes(const Vectors<D>& w, double a, const Vectors<D>& side, Vectors<D>& u);
  void accelerate(bool start, Vectors<D>& u);

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const FluidStep<D>& step_;
  RateOperator<D>& rate_operator_;
  ViscousSolver<D> solver_;
  int iterations_ = 0;  // total so far
  Vectors<D> oblique_rate_, right_side_, before_, u_boundary_;
  std::vector<double> added_;  // by terms: viscosity times a dt per flux face [m^2]; empty if there is none
  Vectors<D> added_rate_, boundary_flux_;
  std::vector<double>
      carried_;  // a (dt phi - dV) per flux face with implicit convection; empty if none has [m^3]
  std::unique_ptr<linalg::VectorAccelerator> accelerator_;  // for meshes that need many passes
};

}  // namespace couplet::fluid
