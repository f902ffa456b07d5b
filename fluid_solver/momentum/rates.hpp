// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/fourth_order.hpp"
#include "fluid_solver/state/placement.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Eddy viscosity of the unresolved scales [m^2/s] from the velocity gradient g_ij = du_i/dx_j of one cell
/// and its width D = V^(1/dimension):
///   Smagorinsky  (C D)^2 (2 S:S)^(1/2)                                              [smagorinsky1963]
///   WALE         (C D)^2 (Sd:Sd)^(3/2) / ((S:S)^(5/2) + (Sd:Sd)^(5/4))              [nicoud1999]
/// S the symmetric part of g, Sd the traceless symmetric part of g g. WALE vanishes in pure shear and as y^3
/// at walls.
template <int D>
double eddy_viscosity(const TurbulenceParameters& model, const Tensor<D>& gradient, double volume);

/// Eddy viscosity of all local cells. `gradient` has its ghosts.
template <int D>
void eddy_viscosity(const TurbulenceParameters& model, const Placement<D>& at,
                    const std::vector<Tensor<D>>& gradient, std::vector<double>& eddy);

/// Gauss gradient du_i/dx_j per local cell (ghosts updated): (1/V) sum u_f S, u_f linear between the cells;
/// on skewed meshes made exact for linear fields. Collective.
template <int D>
void velocity_gradient(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                       const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient);

/// u.S of the interior faces [m^3/s], or with `whole` what that has beyond it: the mean of the cells, on skewed meshes carried
/// on to the face's center by the mean gradient (which is filled then, else left alone). Collective.
template <int D>
void mean_flux(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
               const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient, std::span<double> flux,
               std::span<const double> whole = {});

/// nu_t (grad u + grad u^T).S at an interior face between p and n [m^4/s^2], force per density. The normal derivative at the face is
/// the difference of its two cells, in grad u^T too: the mean of their gradients may have the other sign, as beside a wall where
/// a thin cell borders a thick one, and the stress would drive the velocity.
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

/// R = -sum phi u_f + nu sum [g du + (grad u)_f . k], see reference [trias2014] for the skew-symmetric
/// mid-point u_f. All at level n, on mesh n. `split`: the viscous part goes to Rates::viscous.
/// `correct_oblique`: the mesh is not orthogonal. With an eddy viscosity, which vanishes on walls, its stress
/// nu_t (grad u + grad u^T) comes to the rate that is not split; beside an implicit viscous part add it by add_eddies(). Collective.
template <int D>
class RateOperator {
 public:
  /// `compressible`: phi is not free of divergence, and half of u div u is put back, so that convection still gives no
  /// energy.
  RateOperator(const mesh::Mesh& mesh, const Boundary<D>& boundary, double kinematic_viscosity,
               bool compressible = false)
      : mesh_(mesh), boundary_(boundary), nu_(kinematic_viscosity), compressible_(compressible) {}
  /// `gradient`: that of the state's velocity, if it is at hand.
  void apply(const State<D>& state, bool split, bool correct_oblique, Rates<D>& rates,
             const std::vector<Tensor<D>>* gradient = nullptr);
  /// Adds the non-orthogonal viscous part nu sum (grad u)_f . k of any velocity field (ghosts current).
  /// Collective.
  void add_oblique(const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& u_boundary,
                   Vectors<D>& rate);
  /// nullptr if the order is second everywhere.
  void set_fourth(const FourthOrder<D>* fourth) { fourth_ = fourth; }
  /// state.eddy from state.u. Collective.
  void set_eddy_viscosity(const TurbulenceParameters& model, State<D>& state);
  /// The eddy viscosity of any velocity field (ghosts current), and what its stress adds to `rate`. Collective.
  void add_eddies(const TurbulenceParameters& model, const Placement<D>& at, const Vectors<D>& u,
                  const Vectors<D>& u_boundary, std::vector<double>& eddy, Vectors<D>& rate);

 private:
  void add_stress(const Placement<D>& at, const std::vector<double>& eddy, const Vectors<D>& u,
                  const std::vector<Tensor<D>>& gradient, Vectors<D>& rate) const;
  void add_oblique(const Placement<D>& at, const std::vector<Tensor<D>>& gradient, Vectors<D>& rate) const;
  void face_loop(const State<D>& state, bool split, Rates<D>& rates) const;
  void add_dilatation(const State<D>& state, Vectors<D>& rate);
  const mesh::Mesh& mesh_;
  const Boundary<D>& boundary_;
  double nu_;
  bool compressible_;
  const FourthOrder<D>* fourth_ = nullptr;
  std::vector<double> dilatation_;
  std::vector<Tensor<D>> gradient_;
};

/// Viscous flux of momentum out of the fluid through each boundary face [N]: mu g (u_P - u_b), as the equation has it.
template <int D>
void wall_flux(const mesh::Mesh& mesh, const Placement<D>& at, double viscosity, const Vectors<D>& u,
               const Vectors<D>& u_boundary, Vectors<D>& force);

}  // namespace couplet::fluid
