// SPDX-License-Identifier: Apache-2.0
// Free vibration without damping for a hundred thousand steps: the trapezoidal rule on the symmetric gradient keeps its energy.
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::undamped_test {
using namespace mesh;

/// Largest change of the energy over its first value, looked at every thousandth step.
double drift(BoxCells cells, double dt, int steps, FaceGradient gradient) {
  const int dim = dimension_of(cells);
  SolidParameters p = box_parameters(dim);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {2600, 1e7, 0.3};
  p.time_scheme.type = time::TimeScheme::trapezoidal;
  p.method.face_gradient = gradient;
  p.method.relative_tolerance = 1e-14;
  p.output.energies = true;
  p.boundaries["xmin"] = clamped(dim);
  p.initial_velocity = {{"0.1*x*sin(9*y)"}, {"0.2*x*x"}};
  if (dim == 3) p.initial_velocity.push_back({"0.05*x*cos(7*y)"});
  RawMesh raw = make_box(cells, {4, 2, 2}, Vec3::Zero(), Vec3(4, 1, dim == 3 ? 1 : 0));
  perturb_interior(raw, 0.2, 3);
  const auto solid = make_solid(raw, p);
  double worst = 0;
  for (int i = 1; i <= steps; ++i) {
    step(*solid, dt);
    if (i % 1000 > 0) continue;
    const SolidEnergies e = energies(*solid);
    worst = std::max(worst, std::abs((e.kinetic + e.strain) / e.initial_kinetic - 1));
    if (worst > 1) break;  // the failing neighbour would overflow
  }
  return worst;
}

class Undamped : public ::testing::TestWithParam<std::tuple<BoxCells, double>> {};

TEST_P(Undamped, keeps_its_energy_for_1e5_steps) {
  const auto [cells, dt] = GetParam();
  const double worst = drift(cells, dt, 100000, FaceGradient::symmetric);
  fmt::print("{}, dt {} s: {:.2e}\n", name(cells), dt, worst);
  RecordProperty(fmt::format("{}_{}", dt == 0.01 ? "long" : "short", name(cells)),
                 fmt::format("{:.3e}", worst));
  EXPECT_LT(worst, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, Undamped,
                         ::testing::Combine(::testing::ValuesIn(all_cells), ::testing::Values(0.01, 0.001)));

// The thesis's operator is not symmetric: its motion grows out of nothing beside it.
TEST(UndampedNeighbour, of_the_thesiss_gradient_grows) {
  EXPECT_GT(drift(BoxCells::quadrilaterals, 0.01, 100000, FaceGradient::thesis), 0.01);
}

}  // namespace couplet::testing::undamped_test
