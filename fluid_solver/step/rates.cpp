// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/step/rates.hpp"

#include <algorithm>

#include "fluid_solver/turbulence/turbulence.hpp"

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

template <int D>
void mean_flux(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& u,
               const Vectors<D>& u_boundary, std::vector<Tensor<D>>& gradient, std::span<double> flux) {
  for (Index f = 0; f < mesh.n_interior; ++f)
    flux[f] = 0.5 * (u[mesh.owner[f]] + u[mesh.neighbour[f]]).dot(at.area[f]);
  if (!at.skewed()) return;
  velocity_gradient<D>(mesh, at, u, u_boundary, gradient);
  for (Index f = 0; f < mesh.n_interior; ++f)
    flux[f] += 0.5 * ((gradient[mesh.owner[f]] + gradient[mesh.neighbour[f]]) * at.offset(f)).dot(at.area[f]);
}

template <int D>
template <bool Split>
void RateOperator<D>::face_loop(const State<D>& s, Rates<D>& rates) const {
  const Placement<D>& at = *s.placement;
  const std::vector<double>& inflow = boundary_.rows().inflow;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> convective = -0.5 * s.phi[f] * (s.u[p] + s.u[n]);
    const Vec<D> viscous = nu_ * at.conductance[f] * (s.u[n] - s.u[p]);
    if constexpr (Split) {
      rates.rate[p] += convective;
      rates.rate[n] -= convective;
      rates.viscous[p] += viscous;
      rates.viscous[n] -= viscous;
    } else {
      const Vec<D> both = convective + viscous;
      rates.rate[p] += both;
      rates.rate[n] -= both;
    }
  }
  for (Index f = mesh_.n_interior; f < mesh_.n_flux_faces(); ++f) {
    const Index p = mesh_.owner[f];
    const Index b = f - mesh_.n_interior;
    const Vec<D>& on_face = s.u_boundary[b];
    rates.rate[p] -= (s.phi[f] < 0 ? inflow[b] : 1.0) * s.phi[f] * on_face;
    (Split ? rates.viscous : rates.rate)[p] += nu_ * at.conductance[f] * (on_face - s.u[p]);
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
    const double friction = boundary_.rows().friction(at, f - mesh_.n_interior, f);
    rate[mesh_.owner[f]] += friction * nu_ * (gradient[mesh_.owner[f]] * at.oblique[f]);
  }
}

template <int D>
void RateOperator<D>::set_eddy_viscosity(const TurbulenceParameters& model, State<D>& s) {
  velocity_gradient<D>(mesh_, *s.placement, s.u, s.u_boundary, gradient_);
  eddy_viscosity<D>(model, *s.placement, gradient_, s.eddy);
}

template <int D>
void RateOperator<D>::add_eddies(const State<D>& s, const std::vector<Tensor<D>>& gradient,
                                 Vectors<D>& rate) const {
  const Placement<D>& at = *s.placement;
  for (Index f = 0; f < mesh_.n_interior; ++f) {
    const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
    const Vec<D> part = eddy_stress<D>(at, s, gradient, f, p, n);
    rate[p] += part;
    rate[n] -= part;
  }
}

template <int D>
void RateOperator<D>::add_dilatation(const State<D>& s, Vectors<D>& rate) {
  dilatation_.assign(mesh_.cells.n_local(), 0.0);
  for (Index f = 0; f < mesh_.n_flux_faces(); ++f) {
    dilatation_[mesh_.owner[f]] += s.phi[f];
    if (f < mesh_.n_interior) dilatation_[mesh_.neighbour[f]] -= s.phi[f];
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) rate[c] += 0.5 * dilatation_[c] * s.u[c];
}

template <int D>
void RateOperator<D>::apply(const State<D>& state, bool split, bool correct_oblique, Rates<D>& rates,
                            const std::vector<Tensor<D>>* gradient) {
  rates.rate.assign(mesh_.cells.n_local(), Vec<D>::Zero());
  rates.viscous.assign(split ? mesh_.cells.n_local() : 0, Vec<D>::Zero());
  split ? face_loop<true>(state, rates) : face_loop<false>(state, rates);
  if (compressible_) add_dilatation(state, rates.rate);
  if (!correct_oblique && state.eddy.empty()) return;
  if (!gradient) {
    velocity_gradient<D>(mesh_, *state.placement, state.u, state.u_boundary, gradient_);
    gradient = &gradient_;
  }
  if (correct_oblique) add_oblique(*state.placement, *gradient, split ? rates.viscous : rates.rate);
  if (!state.eddy.empty()) add_eddies(state, *gradient, rates.rate);
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

template void velocity_gradient<2>(const mesh::Mesh&, const Placement<2>&, const Vectors<2>&,
                                   const Vectors<2>&, std::vector<Tensor<2>>&);
template void velocity_gradient<3>(const mesh::Mesh&, const Placement<3>&, const Vectors<3>&,
                                   const Vectors<3>&, std::vector<Tensor<3>>&);
template void mean_flux<2>(const mesh::Mesh&, const Placement<2>&, const Vectors<2>&, const Vectors<2>&,
                           std::vector<Tensor<2>>&, std::span<double>);
template void mean_flux<3>(const mesh::Mesh&, const Placement<3>&, const Vectors<3>&, const Vectors<3>&,
                           std::vector<Tensor<3>>&, std::span<double>);
template class RateOperator<2>;
template class RateOperator<3>;
template void wall_flux<2>(const mesh::Mesh&, const Placement<2>&, double, const Vectors<2>&,
                           const Vectors<2>&, Vectors<2>&);
template void wall_flux<3>(const mesh::Mesh&, const Placement<3>&, double, const Vectors<3>&,
                           const Vectors<3>&, Vectors<3>&);

}  // namespace couplet::fluid
