// SPDX-License-Identifier: Apache-2.0
// Generalized Newtonian fluids: the viscosity depends on the shear rate.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fluid_solver/momentum/rates.hpp"

namespace couplet::fluid {

namespace {

// nu (grad u + grad u^T) has at most twice the rate of nu grad u.
constexpr double stress_of_law = 2;

/// Shear rate [1/s] of grad u + grad u^T.
template <int D>
double shear_rate(const Tensor<D>& twice_strain) {
  return twice_strain.norm() / std::numbers::sqrt2;
}

/// Stress nu+ (grad u + grad u^T) of the excess nu+ of a law over its smallest viscosity, whose part is nu grad u in the rate
/// operator: for a constant nu, the rest nu grad u^T adds nothing to the rate of a field free of divergence.
template <int D>
class LawStress final : public MomentumTerm<D> {
 public:
  LawStress(const mesh::Mesh& mesh, const Boundary<D>& boundary, const FluidParameters& parameters)
      : mesh_(mesh),
        rows_(boundary.rows()),
        law_(*parameters.viscosity_law),
        rho_(parameters.density),
        base_(law_.smallest()),
        factor_(law_.factor()),
        constant_factor_(factor_.is_constant() ? factor_(0) : 1),
        reference_(parameters.heat ? parameters.heat->reference_temperature : 0),
        is_wall_(rows_.friction.size(), 0) {
    const std::vector<Index> patch = mesh.patch_of_boundary();
    for (std::size_t b = 0; b < is_wall_.size(); ++b)
      is_wall_[b] = is_wall(parameters.boundaries.at(mesh.patches[patch[b]].name));
  }

  void start(State<D>& s) override {
    const Flow flow = flow_of(s);
    if (!s.excess.empty()) s.excess_old.swap(s.excess);
    s.excess.resize(mesh_.n_flux_faces());
    set_factors(s.heat.temperature, s.heat.boundary);
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) s.excess[f] = excess(pull(flow, f).shear, f);
  }

  void add_rate(const State<D>& s, bool split, const typename MomentumTerm<D>::Gradient& gradient,
                Vectors<D>& rate) override {
    flux_.assign(rows_.friction.size(), Vec<D>::Zero());
    if (split) return;
    const Flow flow{*s.placement, s.u, s.u_boundary, s.turn, gradient()};
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) add(f, s.excess[f] * pull(flow, f).traction, rate);
  }

  void add_limits(const State<D>& s, Vectors<2>& rates) const override {
    const double factor = 2 * stress_of_law * law_.stiffening();
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      const double rate = factor * s.excess[f] * s.placement->conductance[f];
      if (f >= mesh_.n_interior && is_free(f)) continue;
      rates[mesh_.owner[f]][1] += rate;
      if (f < mesh_.n_interior) rates[mesh_.neighbour[f]][1] += rate;
    }
  }

  /// The stress of u~ = (1 + r/2) u^n - r/2 u^{n-1} with its own viscosity, as that of eddies, at the temperature extrapolated likewise. On a moving mesh it is the mean of
  /// those on the meshes of both levels, which is second order in time.
  void add_implicit(const State<D>& from, const FluidStep<D>& step, double a, Vectors<D>& rate,
                    std::vector<double>& added) override {
    const double ratio = step.ratio(), e0 = 1 + ratio / 2, e1 = -ratio / 2;
    Vectors<D> u = from.u, u_boundary = from.u_boundary, turn = from.turn;
    if (ratio > 0) {
      for (std::size_t c = 0; c < u.size(); ++c) u[c] = e0 * from.u[c] + e1 * from.u_old[c];
      for (std::size_t b = 0; b < u_boundary.size(); ++b)
        u_boundary[b] = e0 * from.u_boundary[b] + e1 * from.u_boundary_old[b];
      for (std::size_t b = 0; b < from.turn_old.size(); ++b)
        turn[b] = e0 * from.turn[b] + e1 * from.turn_old[b];
    }
    if (!factor_.is_constant()) {
      const HeatLevel& heat = from.heat;
      std::vector<double> cells = heat.temperature, at_boundary = heat.boundary;
      for (std::size_t c = 0; ratio > 0 && c < cells.size(); ++c)
        cells[c] = e0 * cells[c] + e1 * heat.temperature_old[c];
      for (std::size_t b = 0; ratio > 0 && b < at_boundary.size(); ++b)
        at_boundary[b] = e0 * at_boundary[b] + e1 * heat.boundary_old[b];
      set_factors(cells, at_boundary);
    }
    added.resize(mesh_.n_flux_faces(), 0);
    flux_.assign(rows_.friction.size(), Vec<D>::Zero());
    const double share = step.moving() ? 0.5 : 1, implicit = stress_of_law * law_.stiffening() * a * step.dt;
    velocity_gradient<D>(mesh_, *from.placement, u, u_boundary, gradient_);
    add_stress({*from.placement, u, u_boundary, turn, gradient_}, from.excess, share, implicit, rate, added);
    if (step.moving()) {
      velocity_gradient<D>(mesh_, *step.to, u, u_boundary, gradient_);
      add_stress({*step.to, u, u_boundary, turn, gradient_}, from.excess, share, implicit, rate, added);
    }
    if (ratio > 0 && !from.excess_old.empty()) keep_less(from, step, implicit, added, rate);
  }

  std::span<const Vec<D>> boundary_flux() const override { return flux_; }

  /// Power that the stress takes from the fluid over the density, on this rank [m^5/s^3].
  double dissipation(const State<D>& s) {
    const Flow flow = flow_of(s);
    double sum = 0;
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      const Index p = mesh_.owner[f];
      const bool inside = f < mesh_.n_interior;
      const int owned = (p < mesh_.cells.n_owned()) + (inside && mesh_.neighbour[f] < mesh_.cells.n_owned());
      const Vec<D> change = (inside ? s.u[mesh_.neighbour[f]] : s.u_boundary[f - mesh_.n_interior]) - s.u[p];
      sum += (inside ? 0.5 * owned : 1) * s.excess[f] * pull(flow, f).traction.dot(change);
    }
    return sum;
  }

 private:
  struct Flow {
    const Placement<D>& at;
    const Vectors<D>&u, &u_boundary, &turn;
    const std::vector<Tensor<D>>& gradient;
  };
  struct Pull {
    double shear;     // [1/s]
    Vec<D> traction;  // (grad u + grad u^T).S [m^2/s]
  };

  /// Viscosity of a face beyond the constant one [m^2/s].
  double excess(double shear, Index f) const {
    return ((factors_.empty() ? constant_factor_ : factors_[f]) * law_(shear) - base_) / rho_;
  }
  /// Factors of the faces at temperatures of cells and boundary faces, less the reference [K].
  void set_factors(const std::vector<double>& cells, const std::vector<double>& boundary) {
    if (factor_.is_constant()) return;
    factors_.resize(mesh_.n_flux_faces());
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
      factors_[f] = factor_(reference_ + (f < mesh_.n_interior
                                              ? 0.5 * (cells[mesh_.owner[f]] + cells[mesh_.neighbour[f]])
                                              : boundary[f - mesh_.n_interior]));
  }
  /// True at boundary faces whose velocity follows the fluid without friction.
  bool is_free(Index f) const { return rows_.pressure[f - mesh_.n_interior] > 0; }

  Flow flow_of(const State<D>& s) {
    velocity_gradient<D>(mesh_, *s.placement, s.u, s.u_boundary, gradient_);
    return {*s.placement, s.u, s.u_boundary, s.turn, gradient_};
  }

  Pull pull(const Flow& flow, Index f) const {
    if (f >= mesh_.n_interior) return pull_at_boundary(flow, f);
    const Tensor<D> g =
        face_gradient<D>(flow.at, flow.u, flow.gradient, f, mesh_.owner[f], mesh_.neighbour[f]);
    const Tensor<D> twice_strain = g + g.transpose();
    return {shear_rate<D>(twice_strain), twice_strain * flow.at.area[f]};
  }

  /// At a wall, where div u = 0, only its rotation adds to the one-sided normal derivative. Elsewhere the other derivatives are those
  /// of the cell.
  Pull pull_at_boundary(const Flow& flow, Index f) const {
    const Index b = f - mesh_.n_interior, p = mesh_.owner[f];
    const Vec<D>& area = flow.at.area[f];
    const double square = area.squaredNorm();
    const Vec<D> change = flow.at.conductance[f] * (flow.u_boundary[b] - flow.u[p]);
    if (is_wall_[b]) {
      const Vec<D> whole = flow.turn.empty() ? change : Vec<D>(change + flow.turn[b]);
      return {(whole - whole.dot(area) / square * area).norm() / std::sqrt(square), whole};
    }
    const Vec<D> straight = area - flow.at.oblique_of(f);
    const Tensor<D> g = flow.gradient[p] + (change - flow.gradient[p] * straight) * area.transpose() / square;
    const Tensor<D> twice_strain = g + g.transpose();
    const double shear = shear_rate<D>(twice_strain);
    if (is_free(f)) return {shear, g.transpose() * area};
    if (rows_.friction[b] > 0) return {shear, twice_strain * area};
    return {shear, 2 * change.dot(area) / square * area};  // mirrored
  }

  void add(Index f, const Vec<D>& flux, Vectors<D>& rate) {
    rate[mesh_.owner[f]] += flux;
    if (f < mesh_.n_interior)
      rate[mesh_.neighbour[f]] -= flux;
    else
      flux_[f - mesh_.n_interior] += flux;
  }

  void add_stress(const Flow& flow, const std::vector<double>& before, double share, double implicit,
                  Vectors<D>& rate, std::vector<double>& added) {
    const double factor = share * implicit;
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      const Pull here = pull(flow, f);
      const double nu = excess(here.shear, f);
      add(f, share * nu * here.traction, rate);
      if (f < mesh_.n_interior || !is_free(f)) added[f] += factor * std::max(nu, before[f]);
    }
  }

  /// The second difference in time that ImplicitFriction adds is K (du^{n+1} - r du^n) with the changes du of the last steps and
  /// K = `added`. Where K grows from step to step, as in a plug that forms, it would gain du K du/2. Less of the old change,
  /// K du^{n+1} - min(K, K_old) r du^n, gains nothing for any K, and differs by the square of the step.
  void keep_less(const State<D>& from, const FluidStep<D>& step, double implicit,
                 const std::vector<double>& added, Vectors<D>& rate) {
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
      const double less = added[f] - implicit * from.excess_old[f];
      if (!(less > 0)) continue;
      const Index p = mesh_.owner[f], b = f - mesh_.n_interior;
      Vec<D> change = from.u_old[p] - from.u[p];
      if (f < mesh_.n_interior)
        change += from.u[mesh_.neighbour[f]] - from.u_old[mesh_.neighbour[f]];
      else
        change += from.u_boundary[b] - from.u_boundary_old[b];
      add(f, less / step.dt * step.ratio() * step.to->conductance[f] * change, rate);
    }
  }

  const mesh::Mesh& mesh_;
  const BoundaryRows& rows_;
  ViscosityLaw law_;
  double rho_, base_;  // [kg/m^3], [Pa s]
  fv::Property factor_;
  double constant_factor_;
  double reference_;             // [K]
  std::vector<double> factors_;  // per flux face; empty if the viscosity does not depend on the temperature
  std::vector<char> is_wall_;
  std::vector<Tensor<D>> gradient_;
  Vectors<D> flux_;
};

}  // namespace

template <int D>
std::unique_ptr<MomentumTerm<D>> make_law_stress(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                                                 const FluidParameters& parameters) {
  return std::make_unique<LawStress<D>>(mesh, boundary, parameters);
}

template <int D>
double excess_dissipation(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                          const FluidParameters& parameters, const State<D>& state) {
  return LawStress<D>(mesh, boundary, parameters).dissipation(state);
}

template <int D>
std::vector<double> viscosity_in_cells(const FluidParameters& parameters, const State<D>& s,
                                       const std::vector<Tensor<D>>& gradient) {
  const ViscosityLaw& law = *parameters.viscosity_law;
  std::vector<double> viscosity;
  for (const Tensor<D>& g : gradient) viscosity.push_back(law(shear_rate<D>(g + g.transpose())));
  if (!law.by_temperature) return viscosity;
  const fv::Property factor = law.factor();
  for (std::size_t c = 0; c < viscosity.size(); ++c)
    viscosity[c] *= factor(parameters.heat->reference_temperature + s.heat.temperature[c]);
  return viscosity;
}

template decltype(make_law_stress<2>) make_law_stress<2>;
template decltype(make_law_stress<3>) make_law_stress<3>;
template decltype(excess_dissipation<2>) excess_dissipation<2>;
template decltype(excess_dissipation<3>) excess_dissipation<3>;
template decltype(viscosity_in_cells<2>) viscosity_in_cells<2>;
template decltype(viscosity_in_cells<3>) viscosity_in_cells<3>;

}  // namespace couplet::fluid
