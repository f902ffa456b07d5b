// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/momentum/rates.hpp"

#include <cmath>

namespace couplet::fluid {
namespace {

// Below this the flow has no gradient, and WALE's quotient is 0/0 [1/s].
constexpr double no_gradient = 1e-150;

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

}  // namespace couplet::fluid
