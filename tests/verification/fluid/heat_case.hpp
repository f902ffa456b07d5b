// SPDX-License-Identifier: Apache-2.0
// A fluid with heat for the tests: rho = c = 1, a reference of 300 K.
#pragma once

#include "fluid_case.hpp"

namespace couplet::fluid::test {
using TemperatureAt = std::function<double(const Vec3&)>;

constexpr double reference = 300;

/// The conductivity is the diffusivity [m^2/s].
inline FluidParameters warm(double viscosity, double conductivity, double tolerance = 1e-11) {
  FluidParameters p = fluid_of(1, viscosity, tolerance);
  p.heat.emplace();
  p.heat->conductivity = conductivity;
  p.heat->specific_heat = 1;
  p.heat->reference_temperature = reference;
  p.heat->initial_temperature.text = "300";
  return p;
}

inline BoundaryParameters at(BoundaryParameters b, const std::string& temperature) {
  b.temperature.emplace().text = temperature;
  return b;
}

template <int D>
double temperature_error(const FluidCase<D>& c, const TemperatureAt& exact) {
  const State<D>& s = c.state();
  double square = 0, volume = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    Vec3 x = Vec3::Zero();
    x.head<D>() = s.placement->centre[i];
    square += s.placement->volume[i] * std::pow(reference + s.heat.temperature[i] - exact(x), 2);
    volume += s.placement->volume[i];
  }
  return std::sqrt(parallel::sum(MPI_COMM_WORLD, square) / parallel::sum(MPI_COMM_WORLD, volume));
}

template <int D>
double stored(const FluidCase<D>& c) {
  double all = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    all += c.state().placement->volume[i] * c.state().heat.temperature[i];
  return parallel::sum(MPI_COMM_WORLD, all);
}

/// Sum of V |T - T_ref|, the scale of the balance.
template <int D>
double content(const FluidCase<D>& c) {
  double all = 0;
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i)
    all += c.state().placement->volume[i] * std::abs(c.state().heat.temperature[i]);
  return parallel::sum(MPI_COMM_WORLD, all);
}

/// Heat into the fluid that a patch conducts, over rho c [K m^3/s].
template <int D>
double flow(const FluidCase<D>& c, const std::string& patch) {
  const mesh::Patch& p = *c.mesh().find_patch(patch);
  double all = 0;
  for (Index f = p.first; f < p.first + p.count; ++f) all += c.state().heat.flow[f - c.mesh().n_interior];
  return parallel::sum(MPI_COMM_WORLD, all);
}

}  // namespace couplet::fluid::test
