// SPDX-License-Identifier: Apache-2.0
// Pressure and velocity live in the same cells: the mode that alternates from cell to cell must stay out of
// the pressure, and what that takes from the kinetic energy is told by the energy budget.
#include <gtest/gtest.h>

#include "fluid_case.hpp"
#include "fluid_solver/output/derived.hpp"

namespace couplet::fluid::test::checkerboard_test {
namespace {

constexpr int n = 48;

/// Amplitude of the alternating part of p, by its mixed fourth difference (0 for cubic fields, the amplitude
/// itself for +-1 from cell to cell), over the amplitude of p; away from the lid's corners, where p is
/// singular.
double alternating_part(const FluidCase<2>& c) {
  const State<2>& s = c.state();
  std::vector<double> p(n * n);
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    const Vec<2> place = n * s.placement->centre[i];
    p[int(place.y()) * n + int(place.x())] = s.pressure[0]->p[i];
  }
  double alternating = 0, mean = 0, square = 0;
  int count = 0;
  for (int j = n / 8; j < n - n / 8; ++j)
    for (int i = n / 8; i < n - n / 8; ++i) {
      const auto at = [&](int di, int dj) { return p[(j + dj) * n + i + di]; };
      const double part = (4 * at(0, 0) - 2 * (at(1, 0) + at(-1, 0) + at(0, 1) + at(0, -1)) + at(1, 1) +
                           at(1, -1) + at(-1, 1) + at(-1, -1)) /
                          16;
      alternating += part * part;
      mean += at(0, 0);
      square += at(0, 0) * at(0, 0);
      ++count;
    }
  mean /= count;
  return std::sqrt(alternating / count / (square / count - mean * mean));
}

/// Cavity at Re = 1000 to 4 s: the alternating part at the end, and the energy that the pressure took as a
/// share of what viscosity and pressure took.
struct Outcome {
  double alternating = 0, taken = 0;
};
Outcome cavity(Projection projection, double dt) {
  FluidParameters p;
  p.density = 1;
  p.viscosity = 1e-3;
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = dt;
  p.projection = projection;
  p.pressure_tolerance = 1e-8;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["ymax"] = boundary(BoundaryType::moving_wall, {"1", "0"});
  FluidCase<2> c(MPI_COMM_SELF,
                 mesh::make_box(mesh::BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3::Ones()), p);
  double viscous = 0, pressure = 0;
  for (int i = 0; i < std::lround(4 / dt); ++i) {
    c.step(dt);
    const EnergyBudget budget = energy_budget(c.fluid());
    viscous += budget.viscous;
    pressure += budget.pressure;
  }
  return {alternating_part(c), pressure / (pressure + viscous)};
}

TEST(Checkerboard, stays_out_of_the_pressure_whatever_the_step_and_costs_little_energy) {
  constexpr std::pair<Projection, const char*> projections[] = {
      {Projection::incremental, "incremental"},
      {Projection::flux_memory, "flux_memory"},
      {Projection::non_incremental, "non_incremental"}};
  for (const auto& [projection, name] : projections) {
    const Outcome coarse = cavity(projection, 0.01), fine = cavity(projection, 0.001);
    printf("checkerboard, %s: alternating %.1e %.1e, energy taken %.1e %.1e\n", name, coarse.alternating,
           fine.alternating, coarse.taken, fine.taken);
    RecordProperty(std::string("alternating_") + name,
                   std::to_string(1e9 * std::max(coarse.alternating, fine.alternating)) + "e-9");
    RecordProperty(std::string("taken_") + name, std::to_string(1e9 * coarse.taken) + "e-9");
    EXPECT_LT(coarse.alternating, 5e-3) << name;
    EXPECT_LT(fine.alternating, 5e-3) << name;
    EXPECT_LT(std::abs(coarse.taken), 0.05) << name;
  }
}

}  // namespace
}  // namespace couplet::fluid::test::checkerboard_test
