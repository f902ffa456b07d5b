// SPDX-License-Identifier: Apache-2.0
// Volumes behind the inlets of a compressible fluid.
#include "sound_case.hpp"

namespace couplet::fluid::test::upstream_test {
using namespace mesh;
using namespace sound;

class Upstream : public Pulse {};
INSTANTIATE_TEST_SUITE_P(Sound, Upstream, ::testing::Values(WaveScheme::three_level, WaveScheme::trapezoidal),
                         name_of);

/// A Helmholtz resonator, a volume and a duct that is open at the other end: k tan k V_0/S = 1.
TEST_P(Upstream, a_volume_upstream_swings_with_the_duct_as_a_resonator) {
  double worst = 0;
  for (const double start : {0.6, 3.3, 6.35}) {
    FluidParameters p = air(GetParam());
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0", "0"});
    p.boundaries["xmax"] = boundary(BoundaryType::outlet);
    p.compressibility->upstream_volume = 0.05;
    double k = start;
    for (int i = 0; i < 50; ++i)
      k -= (std::tan(k) * k * 2.5 - 1) / ((std::tan(k) + k / std::pow(std::cos(k), 2)) * 2.5);
    p.initial_pressure = config::ExpressionText{fmt::format("sin({}*(1 - x))", k)};
    const double period = 2 * std::acos(-1.) / (k * c);
    FluidCase<2> d(MPI_COMM_WORLD, duct(200), p);
    const double got = period_of(d, period, [](const State<2>& s) { return s.pressure[0]->ends[0]; });
    worst = std::max(worst, std::abs(got / period - 1));
  }
  RecordProperty("period_error", fmt::format("{}", worst));
  EXPECT_LT(worst, 2e-3);
}

// Fluid from the inlet compresses the volume upstream and the closed duct alike: p = rho c^2 Q/(V_0 + V).
TEST_P(Upstream, a_volume_upstream_and_a_closed_duct_share_what_flows_in) {
  FluidParameters p = air(GetParam());
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1 - cos(50*pi*t)", "0"});
  p.compressibility->upstream_volume = 0.05;
  FluidCase<2> d(MPI_COMM_WORLD, duct(20), p);
  d.run(0.04, 400);  // Q = 0.02 m x 1 m/s x 0.04 s
  const double wanted = rho * c * c * 0.02 * 0.04 / (0.05 + 0.02);
  RecordProperty("upstream", fmt::format("{}", d.state().pressure[0]->ends[0] / wanted - 1));
  EXPECT_NEAR(d.state().pressure[0]->ends[0] / wanted, 1, 4e-3);
  EXPECT_NEAR(pressures(d).mean / wanted, 1, 4e-3);
}

}  // namespace couplet::fluid::test::upstream_test
