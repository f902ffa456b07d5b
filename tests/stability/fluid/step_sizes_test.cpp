// SPDX-License-Identifier: Apache-2.0
// The fluid stays bounded whatever step it is asked for: it cuts it into stable parts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "../../verification/fluid/fluid_case.hpp"
#include "common/base/error.hpp"

namespace couplet::fluid::test::step_sizes_test {
using namespace mesh;
namespace {

using Case = std::tuple<ViscousTreatment, double>;
class StepSizes : public ::testing::TestWithParam<Case> {};

TEST_P(StepSizes, keep_the_flow_bounded) {
  FluidParameters p = channel(std::get<0>(GetParam()), 1e-8);
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), p);
  for (int i = 0; i < 4; ++i) c.step(std::get<1>(GetParam()));
  double largest = 0;
  for (const Vec<2>& u : c.state().u) largest = std::max(largest, u.norm());
  EXPECT_LT(largest, 3);
  EXPECT_GT(largest, 0.5);
}

INSTANTIATE_TEST_SUITE_P(from_tiny_to_huge, StepSizes,
                         ::testing::Combine(::testing::Values(ViscousTreatment::explicit_,
                                                              ViscousTreatment::implicit,
                                                              ViscousTreatment::automatic),
                                            ::testing::Values(1e-9, 1e-5, 1e-2, 1.0, 5.0)));

class DistortedCells : public ::testing::TestWithParam<std::tuple<BoxCells, double, ViscousTreatment>> {};

TEST_P(DistortedCells, keep_the_channel_flow_near_its_profile) {
  const auto [cells, amount, viscous] = GetParam();
  const bool flat = cells == BoxCells::quadrilaterals || cells == BoxCells::triangles;
  FluidParameters p;
  p.density = 1.3;
  p.viscosity = 0.05;
  p.viscous = viscous;
  p.pressure_tolerance = 1e-7;
  const std::vector<std::string> profile{"4*y*(1-y)", "0", "0"};
  p.boundaries["zmin"] = p.boundaries["zmax"] = boundary(BoundaryType::slip);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  const auto check = [&]<int D>(std::integral_constant<int, D>) {
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {profile.begin(), profile.begin() + D});
    if (D == 2)
      for (const char* side : {"zmin", "zmax"}) p.boundaries.erase(side);
    RawMesh raw =
        make_box(cells, D == 2 ? std::array{24, 12, 1} : std::array{10, 6, 3}, Vec3::Zero(), Vec3(2, 1, 0.5));
    perturb_interior(raw, amount, 7);
    FluidCase<D> c(MPI_COMM_WORLD, raw, p);
    c.run(1.2, 30);
    return c.velocity_error([](const Vec3& x) { return Vec3(4 * x.y() * (1 - x.y()), 0, 0); });
  };
  const double error =
      flat ? check(std::integral_constant<int, 2>{}) : check(std::integral_constant<int, 3>{});
  printf("distorted channel: %.2e\n", error);
  EXPECT_LT(error, flat ? 0.03 : 0.12);
}

INSTANTIATE_TEST_SUITE_P(
    of_all_kinds, DistortedCells,
    ::testing::Combine(::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                         BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed),
                       ::testing::Values(0.0, 0.15, 0.2),
                       ::testing::Values(ViscousTreatment::explicit_, ViscousTreatment::implicit)));

TEST(FixedStep, beyond_the_stability_limit_is_a_failure_that_names_the_place) {
  FluidParameters p = channel(ViscousTreatment::explicit_, 1e-8);
  p.time_step = 0.5;
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), p);
  try {
    c.run(100, 200);
    FAIL() << "the step is far beyond the limit";
  } catch (const couplet::SolveFailure& failure) {
    EXPECT_THAT(failure.what(), ::testing::HasSubstr("in cell"));
    EXPECT_THAT(failure.what(), ::testing::HasSubstr("step of"));
  }
}

}  // namespace
}  // namespace couplet::fluid::test::step_sizes_test
