// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "fluid_solver/momentum/rates.hpp"

namespace couplet::fluid {

namespace {

// nu_t (grad u + grad u^T) has at most twice the rate of nu_t grad u.
constexpr double stress_of_eddies = 2;
// Below this the flow has no gradient, and WALE's quotient is 0/0 [1/s].
constexpr double no_gradient = 1e-150;

/// Stress nu_t (grad u + grad u^T) of the unresolved scales, zero on walls, inlets and outlets.
template <int D>
class EddyStress final : public MomentumTerm<D> {
 public:
  EddyStress(const mesh::Mesh& mesh, const BoundaryRows& boundary, const TurbulenceParameters& model)
      : mesh_(mesh), boundary_(boundary), model_(model) {}

  void add_rate(const State<D>& s, bool split, const typename MomentumTerm<D>::Gradient& gradient,
                Vectors<D>& rate) override {
    if (split) return;
    add_stress(*s.placement, s.eddy, s.u, s.u_boundary, gradient(), rate);
  }
  void start(State<D>& s) override {
    velocity_gradient<D>(mesh_, *s.placement, s.u, s.u_boundary, gradient_);
    eddy_viscosity<D>(model_, *s.placement, gradient_, s.eddy);
  }
  void add_limits(const State<D>& s, Vectors<2>& rates) const override {
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      const double rate = stress_of_eddies * (s.eddy[p] + s.eddy[n]) * s.placement->conductance[f];
      rates[p][1] += rate;
      rates[n][1] += rate;
    }
    for (const Index b : boundary_.of_mirror) {
      const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
      rates[p][1] += stress_of_eddies * s.eddy[p] * s.placement->conductance[f];
    }
  }
  /// Adds the stress of u~ = (1 + r/2) u^n - r/2 u^{n-1} with its own nu_t on the mesh of level n. The nu_t
  /// must be the same for all three levels. With Adams-Bashforth, a nu_t that decreases tenfold per step, as
  /// in an opening gap, would leave an undamped old rate.
  void add_implicit(const State<D>& from, const FluidStep<D>& step, double a, Vectors<D>& rate,
                    std::vector<double>& added) override {
    const double ratio = step.ratio(), e0 = 1 + ratio / 2, e1 = -ratio / 2;
    Vectors<D> u = from.u, u_boundary = from.u_boundary;
    if (ratio > 0) {
      for (std::size_t c = 0; c < u.size(); ++c) u[c] = e0 * from.u[c] + e1 * from.u_old[c];
      for (std::size_t b = 0; b < u_boundary.size(); ++b)
        u_boundary[b] = e0 * from.u_boundary[b] + e1 * from.u_boundary_old[b];
    }
    const Placement<D>& at = *from.placement;
    std::vector<double> eddy;
    velocity_gradient<D>(mesh_, at, u, u_boundary, gradient_);
    eddy_viscosity<D>(model_, at, gradient_, eddy);
    add_stress(at, eddy, u, u_boundary, gradient_, rate);
    added.resize(mesh_.n_flux_faces(), 0);
    const double factor = stress_of_eddies * a * step.dt;
    for (Index f = 0; f < mesh_.n_interior; ++f)
      added[f] += 0.5 * factor * (eddy[mesh_.owner[f]] + eddy[mesh_.neighbour[f]]);
    for (const Index b : boundary_.of_mirror)
      added[mesh_.n_interior + b] += factor * eddy[mesh_.owner[mesh_.n_interior + b]];
  }

 private:
  void add_stress(const Placement<D>& at, const std::vector<double>& eddy, const Vectors<D>& u,
                  const Vectors<D>& u_boundary, const std::vector<Tensor<D>>& gradient,
                  Vectors<D>& rate) const {
    for (Index f = 0; f < mesh_.n_interior; ++f) {
      const Index p = mesh_.owner[f], n = mesh_.neighbour[f];
      const Vec<D> part = eddy_stress<D>(at, eddy, u, gradient, f, p, n);
      rate[p] += part;
      rate[n] -= part;
    }
    for (const Index b : boundary_.of_mirror) {
      const Index f = mesh_.n_interior + b, p = mesh_.owner[f];
      rate[p] += mirrored_eddy_stress<D>(at, eddy[p], u[p], u_boundary[b], f);
    }
  }

  const mesh::Mesh& mesh_;
  const BoundaryRows& boundary_;
  TurbulenceParameters model_;
  std::vector<Tensor<D>> gradient_;
};

/// Half of u div u, so that convection by fluxes that are not divergence-free conserves energy.
template <int D>
class Dilatation final : public MomentumTerm<D> {
 public:
  explicit Dilatation(const mesh::Mesh& mesh) : mesh_(mesh) {}

  void add_rate(const State<D>& s, bool, const typename MomentumTerm<D>::Gradient&,
                Vectors<D>& rate) override {
    outflow_.assign(mesh_.cells.n_local(), 0.0);
    add_outflow(mesh_, s.phi, outflow_);
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) rate[c] += 0.5 * outflow_[c] * s.u[c];
  }

 private:
  const mesh::Mesh& mesh_;
  std::vector<double> outflow_;
};

}  // namespace

template <int D>
double eddy_viscosity(const TurbulenceParameters& model, const Tensor<D>& g, double volume) {
  const double width = D == 2 ? std::sqrt(volume) : std::cbrt(volume);
  const double scale = model.constant_of() * width * model.constant_of() * width;
  const Tensor<D> strain = 0.5 * (g + g.transpose());
  const double ss = strain.squaredNorm();
  if (!(ss > no_gradient)) return 0;
  if (model.model == TurbulenceModel::smagorinsky) return scale * std::sqrt(2 * ss);
  const Tensor<D> square = g * g;
  const Tensor<D> symmetric = 0.5 * (square + square.transpose());
  // Traceless in three dimensions, whatever D: Sd:Sd = s:s - tr(s)^2/3.
  const double trace = symmetric.trace(), dd = std::max(0.0, symmetric.squaredNorm() - trace * trace / 3);
  return scale * std::pow(dd, 1.5) / (std::pow(ss, 2.5) + std::pow(dd, 1.25));
}

template <int D>
void eddy_viscosity(const TurbulenceParameters& model, const Placement<D>& at,
                    const std::vector<Tensor<D>>& gradient, std::vector<double>& eddy) {
  eddy.resize(gradient.size());
  for (std::size_t c = 0; c < gradient.size(); ++c)
    eddy[c] = eddy_viscosity<D>(model, gradient[c], at.volume[c]);
}

template double eddy_viscosity<2>(const TurbulenceParameters&, const Tensor<2>&, double);
template double eddy_viscosity<3>(const TurbulenceParameters&, const Tensor<3>&, double);
template void eddy_viscosity(const TurbulenceParameters&, const Placement<2>&, const std::vector<Tensor<2>>&,
                             std::vector<double>&);
template void eddy_viscosity(const TurbulenceParameters&, const Placement<3>&, const std::vector<Tensor<3>>&,
                             std::vector<double>&);

template <int D>
MomentumTerms<D> make_momentum_terms(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                                     const FluidParameters& parameters) {
  MomentumTerms<D> terms;
  if (parameters.is_compressible()) terms.push_back(std::make_unique<Dilatation<D>>(mesh));
  if (parameters.turbulence)
    terms.push_back(std::make_unique<EddyStress<D>>(mesh, boundary.rows(), *parameters.turbulence));
  if (parameters.viscosity_law) terms.push_back(make_law_stress<D>(mesh, boundary, parameters));
  return terms;
}

template decltype(make_momentum_terms<2>) make_momentum_terms<2>;
template decltype(make_momentum_terms<3>) make_momentum_terms<3>;

}  // namespace couplet::fluid
