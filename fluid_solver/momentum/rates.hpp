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

/// R = -sum phi u_f + nu sum [g du + (grad u)_f . k] at level n on mesh n, with skew-symmetric mid-point u_f
/// [trias2014]. `split`: the viscous part goes to Rates::viscous. `correct_oblique`: the mesh is not
/// orthogonal. The eddy stress nu_t (grad u + grad u^T), zero on walls, is added to the rate unless `split`
/// is set; add it by add_eddies() then. Collective.
template <int D>
class RateOperator {
 public:
  /// `compressible`: phi is not divergence-free. Half of u div u is added back so that convection conserves
  /// energy.
  RateOperator(const mesh::Mesh& mesh, const Boundary<D>& boundary, double kinematic_viscosity,
               bool compressible = false)
      : mesh_(mesh), boundary_(boundary), nu_(kinematic_viscosity), compressible_(compressible) {}
  /// `gradient`: gradient of the state's velocity, if known.
  void apply(const State<D>& state, bool split, bool correct_oblique, Rates<D>& rates,
             const std::vector<Tensor<D>>* gradient = nullptr);
  /// Adds the non-orthogonal viscous part nu sum (grad u)_f . k of any velocity field (ghosts current).
  /// Collective.
  void add_oblique(const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& u_boundary,
                   Vectors<D>& rate);
  /// nullptr if the order is second everywhere.
  void set_fourth(const FourthOrder<D>* fourth) { fourth_ = fourth; }
  /// Sets state.eddy from state.u. Collective.
  void set_eddy_viscosity(const TurbulenceParameters& model, State<D>& state);
  /// Computes the eddy viscosity of a velocity field (ghosts current), adds its stress to `rate`. Collective.
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

/// Viscous momentum flux out of the fluid through each boundary face [N]: mu g (u_P - u_b).
template <int D>
void wall_flux(const mesh::Mesh& mesh, const Placement<D>& at, double viscosity, const Vectors<D>& u,
               const Vectors<D>& u_boundary, Vectors<D>& force);

}  // namespace couplet::fluid
