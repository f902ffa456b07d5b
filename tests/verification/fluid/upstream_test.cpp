// SPDX-License-Identifier: Apache-2.0
// Volumes and lines behind the inlets of a compressible fluid.
#include "sound_case.hpp"

namespace couplet::fluid::test::upstream_test {
using namespace mesh;
using namespace sound;

class Upstream : public Pulse {};
INSTANTIATE_TEST_SUITE_P(Sound, Upstream, ::testing::Values(WaveScheme::three_level, WaveScheme::trapezoidal),
                         name_of);

/// Share of `shape`, a function of x, in the pressure of the cells, and the size of what is left over, in sizes of it.
struct Echo {
  double share = 0, rest = 0;
};
Echo echo(const FluidCase<2>& d, const std::function<double(double)>& shape) {
  double sums[3] = {};
  for (Index i = 0; i < d.mesh().cells.n_owned(); ++i) {
    const double p = d.state().pressure[0]->p[i], s = shape(d.state().placement->centre[i][0]);
    sums[0] += p * s, sums[1] += s * s, sums[2] += p * p;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, d.mesh().comm);
  const double share = sums[0] / sums[1];
  return {share, std::sqrt(std::max(0., sums[2] / sums[1] - share * share))};
}

/// A pulse of 1 Pa goes to the left through the inlet into a line of 0.5 m and comes back from its end, or from the
/// mouth of a line of half the area, Z' = 2 Z: (Z' - Z)/(Z' + Z) = 1/3.
TEST_P(Upstream, comes_back_from_the_far_end_of_a_line) {
  using End = UpstreamLineParameters::End;
  struct Wanted {
    End end;
    double area, way, share;
  };
  constexpr double wide = 2 * c * width;
  for (const auto& [end, area, way, share] :
       {Wanted{End::closed, 0.02, 1, 1}, Wanted{End::open, 0.02, 1, -1}, Wanted{End::absorbing, 0.02, 1, 0},
        Wanted{End::absorbing, 0.01, 0, 1 / 3.}}) {
    FluidParameters p = pulse(GetParam());
    const std::string shape = fmt::format("exp(-((x - 0.5)/{})^2)", wide);
    p.initial_pressure = config::ExpressionText{shape};
    p.initial_velocity = {{fmt::format("-{}/{}", shape, rho * c)}, {"0"}};
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0", "0"});
    p.compressibility->upstream_line = line(area, end);
    FluidCase<2> d(MPI_COMM_WORLD, duct(200), p);
    d.run((way + 1) / c, int(std::lround((way + 1) / c / 5e-6)));
    const double at = c * d.state().pressure[0]->time - 0.5 - way;
    const Echo got = echo(d, [&](double x) { return std::exp(-std::pow((x - at) / wide, 2)); });
    const std::string name =
        std::array{"closed", "open", "absorbing"}[int(end)] + std::string(way > 0 ? "" : "_narrow");
    RecordProperty(name, fmt::format("{}", std::abs(got.share - share)));
    RecordProperty(name + "_rest", fmt::format("{}", got.rest));
    EXPECT_NEAR(got.share, share, 0.01) << name;
    EXPECT_LT(got.rest, 0.02) << name;
  }
}

/// A pulse of the flow that the inlet prescribes comes out of the line after L/c: from a piston with rho c u, and from a
/// tube that goes on with half of it.
TEST_P(Upstream, comes_out_of_a_line_after_the_travel_time_of_sound) {
  using End = UpstreamLineParameters::End;
  for (const auto& [end, share] : {std::pair(End::closed, 1.), std::pair(End::absorbing, 0.5)}) {
    FluidParameters p = pulse(GetParam());
    p.initial_pressure = config::ExpressionText{"0"};
    p.initial_velocity = {{"0"}, {"0"}};
    p.boundaries["xmin"] =
        boundary(BoundaryType::inlet, {fmt::format("exp(-((t - 1e-3)/{})^2)/{}", width, rho * c), "0"});
    p.compressibility->upstream_line = line(0.02, end);
    FluidCase<2> d(MPI_COMM_WORLD, duct(400), p);
    d.run(1e-3 + 1 / c, 788);
    const double at = c * (d.state().pressure[0]->time - 1e-3) - 0.5;
    const Echo got = echo(d, [&](double x) { return std::exp(-std::pow((x - at) / (c * width), 2)); });
    EXPECT_NEAR(got.share, share, 0.01) << share;
    EXPECT_LT(got.rest, 0.02) << share;
  }
}

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
    const double got = period_of(d, period, [](const State<2>& s) { return s.pressure[0]->upstream; });
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
  RecordProperty("upstream", fmt::format("{}", d.state().pressure[0]->upstream / wanted - 1));
  EXPECT_NEAR(d.state().pressure[0]->upstream / wanted, 1, 4e-3);
  EXPECT_NEAR(pressures(d).mean / wanted, 1, 4e-3);
}

/// The fluid in a line of the inlet's own area moves as fast as that beside it in the mesh.
TEST_P(Upstream, a_mean_flow_comes_out_of_a_line_as_it_is) {
  constexpr double u = 5;
  FluidParameters p = air(GetParam());
  p.initial_velocity = {{"5"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"5", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.compressibility->upstream_line = line(0.02, UpstreamLineParameters::End::absorbing);
  FluidCase<2> d(MPI_COMM_WORLD, duct(40), p);
  d.run(0.02, 1000);
  double change = 0;
  for (Index i = 0; i < d.mesh().cells.n_owned(); ++i)
    change = std::max(change, std::abs(d.state().u[i].x() / u - 1));
  EXPECT_LT(parallel::max(d.mesh().comm, change), 1e-9);
  EXPECT_NEAR(d.state().pressure[0]->upstream, 0, 1e-6);
}

TEST(UpstreamLine, velocities_of_an_open_end_are_refused) {
  FluidParameters p = air();
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"5", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.compressibility->upstream_line = line(0.02, UpstreamLineParameters::End::open);
  EXPECT_THAT(support::error_of([&] { FluidCase<2> d(MPI_COMM_WORLD, duct(4), p); }),
              ::testing::HasSubstr("the reservoir's pressure drives the flow"));
}

}  // namespace couplet::fluid::test::upstream_test
