// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/momentum/rates.hpp"

#include <cmath>

#include "common/base/processor_clones.hpp"

namespace couplet::fluid {

template <int D>
void velocity_gradient(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
                       const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient) {
  gradient.assign(mesh.cells.n_local(), Tensor<D>::Zero());
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Index p = mesh.owner[f], n = mesh.neighbour[f];
    const Vec<D> value = at.weight[f] * u[p] + (1 - at.weight[f]) * u[n];
    const Tensor<D> part = value * at.area[f].transpose();
    gradient[p] += part;
    gradient[n] -= part;
  }
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    gradient[mesh.owner[f]] += u_boundary[f - mesh.n_interior] * at.area[f].transpose();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) gradient[c] /= at.volume[c];
  if (at.skewed())
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) gradient[c] = (gradient[c] * at.gradient_cure[c]).eval();
  mesh.cells.update_ghosts({gradient.empty() ? nullptr : gradient.front().data(), gradient.size() * D * D},
                           D * D);
}

namespace {

/// Rates of the interior faces, which are sorted by owner so that owner data are accessed once.
template <bool Split, int D>
[[gnu::always_inline]] inline void face_rates(const mesh::Mesh& mesh, double nu, const State<D>& s,
                                              Rates<D>& rates) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const double *phi = s.phi.data(), *conductance = s.placement->conductance.data();
  const Vec<D>* u = s.u.data();
  Vec<D>*rate = rates.rate.data(), *viscous = rates.viscous.data();
  for (Index f = 0; f < mesh.n_interior;) {
    const Index p = owner[f];
    const Vec<D> own = u[p];
    Vec<D> sum = Vec<D>::Zero(), sum_viscous = Vec<D>::Zero();
    do {
      const Index n = neighbour[f];
      const double half = -0.5 * phi[f], g = nu * conductance[f];
      if constexpr (Split) {
        const Vec<D> by_flow = half * (own + u[n]), by_friction = g * (u[n] - own);
        sum += by_flow;
        rate[n] -= by_flow;
        sum_viscous += by_friction;
        viscous[n] -= by_friction;
      } else {
        const Vec<D> both = (half - g) * own + (half + g) * u[n];
        sum += both;
        rate[n] -= both;
      }
      ++f;
    } while (f < mesh.n_interior && owner[f] == p);
    rate[p] += sum;
    if constexpr (Split) viscous[p] += sum_viscous;
  }
}

template <int D>
COUPLET_PROCESSOR_CLONES void rates_pass(const mesh::Mesh& mesh, double nu, bool split, const State<D>& s,
                                         Rates<D>& rates) {
  split ? face_rates<true>(mesh, nu, s, rates) : face_rates<false>(mesh, nu, s, rates);
}

/// (mean u).S, or its difference from `whole`.
template <bool Rest, int D>
[[gnu::always_inline]] inline void mean_fluxes(const mesh::Mesh& mesh, const Placement<D>& at,
                                               const Vectors<D>& u, const double* whole, double* flux) {
  const Index *owner = mesh.owner.data(), *neighbour = mesh.neighbour.data();
  const Vec<D>*value = u.data(), *s = at.area.data();
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const double w = at.flux_weight(f);
    const double mean = (w * value[owner[f]] + (1 - w) * value[neighbour[f]]).dot(s[f]);
    flux[f] = Rest ? whole[f] - mean : mean;
  }
}
template <int D>
COUPLET_PROCESSOR_CLONES void mean_flux_pass(const mesh::Mesh& mesh, const Placement<D>& at,
                                             const Vectors<D>& u, const double* whole, double* flux) {
  whole ? mean_fluxes<true>(mesh, at, u, whole, flux) : mean_fluxes<false>(mesh, at, u, nullptr, flux);
}

}  // namespace

template <int D>
void mean_flux(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
               const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient, std::span<double> flux,
               std::span<const double> whole) {
  mean_flux_pass<D>(mesh, at, u, whole.data(), flux.data());
  if (!at.skewed()) return;
  velocity_gradient<D>(mesh, at, u, u_boundary, gradient);
  const double sign = whole.empty() ? 1 : -1;
  for (Index f = 0; f < mesh.n_interior; ++f)
    flux[f] +=
        sign * 0.5 * ((gradient[mesh.owner[f]] + gradient[mesh.neighbour[f]]) * at.offset(f)).dot(at.area[f]);
}

template <int D>
void RateOperator<D>::face_loop(const State<D>& s, bool split, Rates<D>& rates) const {
  const Placement<D>& at = *s.placement;
  const std::vector<double>& inflow = boundary_.rows().inflow;
  rates_pass(mesh_, nu_, split, s, rates);
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index p = mesh_.owner[f];
    const Index b = f - mesh_.n_interior;
    const Vec<D>& on_face = s.u_boundary[b];
    rates.rate[p] -= (s.phi[f] < 0 ? inflow[b] : 1.0) * s.phi[f] * on_face;
    (split ? rates.viscous : rates.rate)[p] += nu_ * at.conductance[f] * (on_face - s.u[p]);
  }
}

template <int D>
void RateOperator<D>::add_oblique(const Placement<D>& at, const Vectors<D>& u, const Vectors<D>& u_boundary,
                                  Vectors<D>& rate) {
  velocity_gradient<D>(mesh_, at, u, u_boundary, gradient_);
  add_oblique(at, gradient_, rate);
}

template <int D>
void RateOperator<D>::add_oblique(const Placement<D>& at, const std::vector<Tensor<D>>& gradient,
                                  Vectors<D>& rate) const {
  if (at.oblique.empty()) return;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const double w = at.weight[f];
    const Tensor<D> mean = w * gradient[p] + (1 - w) * gradient[n];
    const Vec<D> part = nu_ * (mean * at.oblique[f]);
    rate[p] += part;
    rate[n] -= part;
  }
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const double friction = boundary_.rows().friction[f - mesh_.n_interior];
    rate[mesh_.owner[f]] += friction * nu_ * (gradient[mesh_.owner[f]] * at.oblique[f]);
  }
}

template <int D>
void RateOperator<D>::apply(const State<D>& state, bool split, bool correct_oblique, Rates<D>& rates,
                            const std::vector<Tensor<D>>* gradient) {
  rates.rate.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  rates.viscous.assign(split ? mesh_.cells.n_local() : 0, Vec<D>::Zero());
  face_loop(state, split, rates);
  if (fourth_) fourth_->add_rates(state, split ? 0 : nu_, rates.rate);
  const auto gradient_of_state = [&]() -> const std::vector<Tensor<D>>& {
    if (!gradient) {
      velocity_gradient<D>(mesh_, *state.placement, state.u, state.u_boundary, gradient_);
      gradient = &gradient_;
    }
    return *gradient;
  };
  for (const auto& term : terms_) term->add_rate(state, split, gradient_of_state, rates.rate);
  if (correct_oblique) add_oblique(*state.placement, gradient_of_state(), split ? rates.viscous : rates.rate);
}

template <int D>
void wall_flux(const mesh::Mesh& mesh, const Placement<D>& at, double viscosity, const Vectors<D>& u,
               const Vectors<D>& u_boundary, Vectors<D>& force) {
  force.resize(u_boundary.size());
  for (std::size_t b = 0; b < u_boundary.size(); ++b) {
    const Index f = mesh.n_interior + static_cast<Index>(b);
    force[b] = viscosity * at.conductance[f] * (u[mesh.owner[f]] - u_boundary[b]);
  }
}

template decltype(velocity_gradient<2>) velocity_gradient<2>;
template decltype(velocity_gradient<3>) velocity_gradient<3>;
template decltype(mean_flux<2>) mean_flux<2>;
template decltype(mean_flux<3>) mean_flux<3>;
template decltype(wall_flux<2>) wall_flux<2>;
template decltype(wall_flux<3>) wall_flux<3>;
template class RateOperator<2>;
template class RateOperator<3>;

}  // namespace couplet::fluid
