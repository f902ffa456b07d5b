// SPDX-License-Identifier: Apache-2.0
// Air in a duct, for the tests of weak compressibility.
#pragma once

#include "fluid_case.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid::test::sound {
using namespace mesh;

constexpr double c = 340, rho = 1.2, width = 0.2e-3;  // [m/s], [kg/m^3]; half width of a pulse [s]

inline FluidParameters air(WaveScheme scheme = WaveScheme::three_level) {
  FluidParameters p = fluid_of(rho, 0, 1e-10);
  p.compressibility.emplace();
  p.compressibility->speed_of_sound = c;
  p.compressibility->scheme = scheme;
  for (const char* side : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[side] = boundary(BoundaryType::slip);
  return p;
}

inline BoundaryParameters absorbing(BoundaryParameters b) {
  b.absorbing = true;
  return b;
}

/// A duct of length 1 m in x, one cell high.
inline RawMesh duct(int cells) {
  return make_box(BoxCells::quadrilaterals, {cells, 1, 1}, Vec3::Zero(), Vec3(1, 0.02, 1));
}

/// Of the cells' pressures, by weight: p and p x; the largest |p|.
struct Pressures {
  double mean = 0, largest = 0, centre = 0;
};
inline Pressures pressures(const FluidCase<2>& d) {
  MPI_Comm comm = d.mesh().comm;
  const State<2>& s = d.state();
  double sums[4] = {};
  for (Index i = 0; i < d.mesh().cells.n_owned(); ++i) {
    const double p = s.pressure[0]->p[i], v = s.placement->volume[i];
    sums[0] += v, sums[1] += v * p, sums[2] += v * p * p, sums[3] += v * p * p * s.placement->centre[i][0];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, comm);
  double largest = 0;
  for (Index i = 0; i < d.mesh().cells.n_owned(); ++i)
    largest = std::max(largest, std::abs(s.pressure[0]->p[i]));
  return {sums[1] / sums[0], parallel::max(comm, largest), sums[3] / sums[2]};
}

/// A pulse of 1 Pa that goes to the right from x = 0.25 m.
inline FluidParameters pulse(WaveScheme scheme) {
  FluidParameters p = air(scheme);
  const std::string shape = fmt::format("exp(-((x - 0.25)/{})^2)", c * width);
  p.initial_pressure = config::ExpressionText{shape};
  p.initial_velocity = {{fmt::format("{}/{}", shape, rho * c)}, {"0"}};
  p.boundaries["xmax"] = absorbing(boundary(BoundaryType::outlet));
  p.compressibility->mean_time = 1;
  return p;
}

/// Of p at a place of the cells over four periods.
template <class Value>
double period_of(FluidCase<2>& d, double expected, const Value& value) {
  const int steps = 400;
  const double dt = expected / steps;
  double last = 0;
  std::vector<double> crossings;
  for (int i = 0; i < 5 * steps; ++i) {
    d.step(dt);
    const double now = value(d.state());
    if (last * now < 0) crossings.push_back(d.state().pressure[0]->time - now / (now - last) * dt);
    last = now;
  }
  return crossings.size() < 9 ? 0 : 2 * (crossings[8] - crossings[0]) / 8;
}

constexpr auto name_of = [](const ::testing::TestParamInfo<WaveScheme>& i) {
  return i.param == WaveScheme::three_level ? "three_level" : "trapezoidal";
};
class Pulse : public ::testing::TestWithParam<WaveScheme> {};
class Wave : public Pulse {};

}  // namespace couplet::fluid::test::sound
