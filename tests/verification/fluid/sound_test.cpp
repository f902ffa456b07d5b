// SPDX-License-Identifier: Apache-2.0
// Weak compressibility: pulses, standing waves, openings, closed cylinders and the way back to the incompressible fluid.
#include "fluid_solver/diagnostics/view.hpp"
#include "fluid_solver/output/output.hpp"
#include "fluid_solver/participant.hpp"
#include "sound_case.hpp"
#include "tests/support/observed_run.hpp"

namespace couplet::fluid::test::sound_test {
using namespace mesh;
using namespace sound;

TEST_P(Pulse, travels_at_the_speed_of_sound_and_leaves) {
  const bool three = GetParam() == WaveScheme::three_level;
  double before = 0;
  for (const double dt : {10e-6, 5e-6}) {
    FluidCase<2> d(MPI_COMM_WORLD, duct(400), pulse(GetParam()));
    d.run(0.1e-3, int(std::lround(0.1e-3 / dt)));
    const double from = pressures(d).centre;
    d.run(1.1e-3, int(std::lround(1e-3 / dt)));
    const double error = std::abs((pressures(d).centre - from) / (c * 1e-3) - 1);
    RecordProperty(fmt::format("speed_error_{:g}us", 1e6 * dt), fmt::format("{}", error));
    EXPECT_LT(error, dt > 7e-6 ? 4e-3 : 2e-3);
    EXPECT_NEAR(pressures(d).largest, 1, three ? 0.02 : 5e-3);
    if (before > 0 && three) {
      EXPECT_GT(std::log2(before / error), 1.7);
    }
    before = error;
    d.run(3.2e-3, int(std::lround(2.1e-3 / dt)));
    RecordProperty(fmt::format("reflection_{:g}us", 1e6 * dt), fmt::format("{}", pressures(d).largest));
    EXPECT_LT(pressures(d).largest, dt > 7e-6 ? 2e-3 : 1e-3);
  }
}

void stays_bounded(WaveScheme scheme, int steps) {
  for (const double courant : {1., 10., 100.}) {
    FluidParameters p = pulse(scheme);
    p.boundaries["xmax"] = boundary(BoundaryType::slip);
    FluidCase<2> d(MPI_COMM_WORLD, duct(100), p);
    const double dt = courant * 0.01 / c;
    double largest = 0, first = 0;
    for (int i = 0; i < steps; ++i) {
      d.step(dt);
      largest = std::max(largest, pressures(d).largest);
      if (i == 0) first = d.state().ledger.energy;
    }
    EXPECT_LT(largest, 2.2) << courant;
    EXPECT_LE(d.state().ledger.energy, first * 1.02) << courant;
    EXPECT_FALSE(d.state().ledger.is_known() && d.state().ledger.excess > 0.01 * d.state().ledger.reference)
        << courant;
    EXPECT_NEAR(pressures(d).mean, 0.068 * std::sqrt(std::acos(-1.)), 2e-3) << "the mean is conserved";
  }
}

// rho u^2/2 and (p - mean)^2/(2 rho c^2) of exp(-(x/(c width))^2), over the duct of 0.02 m.
TEST_P(Pulse, has_the_energy_of_its_motion_and_of_its_pressure) {
  FluidCase<2> d(MPI_COMM_WORLD, duct(200), pulse(GetParam()));
  for (int i = 0; i < 4; ++i) d.step(5e-6);
  const double square = c * width * std::sqrt(std::acos(-1.) / 2),
               mean = c * width * std::sqrt(std::acos(-1.));
  const double wanted = 0.02 * (square / 2 + (square - mean * mean) / 2) / (rho * c * c);
  EXPECT_NEAR(d.state().ledger.energy / wanted, 1, 2e-3);
}

TEST_P(Pulse, in_a_closed_duct_stays_bounded_at_any_courant_number) { stays_bounded(GetParam(), 600); }
TEST_P(Pulse, in_a_closed_duct_stays_bounded_over_ten_thousand_steps) { stays_bounded(GetParam(), 10000); }

/// What a step does not resolve rings with the trapezoidal rule, and with no other.
TEST(Sound, ringing_is_seen) {
  const auto rings = [](WaveScheme scheme, double courant) {
    FluidParameters p = pulse(scheme);
    p.boundaries["xmax"] = boundary(BoundaryType::slip);
    FluidCase<2> d(MPI_COMM_WORLD, duct(100), p);
    int rung = 0, most = 0;  // steps in a row
    for (int i = 0; i < 60; ++i) {
      d.step(courant * 0.01 / c);
      rung = ringing_share(d.mesh(), d.state()) > ringing_limit ? rung + 1 : 0;
      most = std::max(most, rung);
    }
    return most >= 10;
  };
  EXPECT_TRUE(rings(WaveScheme::trapezoidal, 100));
  EXPECT_FALSE(rings(WaveScheme::trapezoidal, 1));
  EXPECT_FALSE(rings(WaveScheme::three_level, 100));
}

/// Error of the speed over 1 ms with fine cells.
TEST(Sound, a_pulse_has_order_two_in_time) {
  std::vector<double> errors;
  for (const double dt : {20e-6, 10e-6, 5e-6, 2.5e-6}) {
    FluidCase<2> d(MPI_COMM_WORLD, duct(1600), pulse(WaveScheme::three_level));
    d.run(0.1e-3, int(std::lround(0.1e-3 / dt)));
    const double from = pressures(d).centre;
    d.run(1.1e-3, int(std::lround(1e-3 / dt)));
    errors.push_back(std::abs((pressures(d).centre - from) / (c * 1e-3) - 1));
  }
  RecordProperty("speed_error_5us", fmt::format("{}", errors[2]));
  RecordProperty("order", fmt::format("{}", std::log2(errors[2] / errors[3])));
  EXPECT_GT(std::log2(errors[2] / errors[3]), 1.9);
  EXPECT_LT(errors[2], 2e-3);
}

/// Of all cells: their pressure times that of the mode.
double share_of(const FluidCase<2>& d, const std::function<double(double)>& mode) {
  double share = 0;
  for (Index i = 0; i < d.mesh().cells.n_owned(); ++i)
    share += d.state().pressure[0]->p[i] * mode(d.state().placement->centre[i][0]);
  return parallel::sum(d.mesh().comm, share);
}

/// A quarter wave: closed on the left, open on the right.
TEST(Sound, modes_of_a_duct_that_is_open_at_one_end) {
  double worst = 0;
  for (const int mode : {1, 2, 3}) {
    FluidParameters p = air();
    p.boundaries["xmax"] = boundary(BoundaryType::outlet);
    const double k = (mode - 0.5) * std::acos(-1.);
    p.initial_pressure = config::ExpressionText{fmt::format("cos({}*x)", k)};
    FluidCase<2> d(MPI_COMM_WORLD, duct(200), p);
    const double period = 2 * std::acos(-1.) / (k * c);
    const double got = period_of(
        d, period, [&](const State<2>&) { return share_of(d, [k](double x) { return std::cos(k * x); }); });
    worst = std::max(worst, std::abs(got / period - 1));
  }
  RecordProperty("period_error", fmt::format("{}", worst));
  EXPECT_LT(worst, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Sound, Pulse, ::testing::Values(WaveScheme::three_level, WaveScheme::trapezoidal),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Sound, Wave, ::testing::Values(WaveScheme::three_level, WaveScheme::trapezoidal),
                         name_of);

TEST(Sound, a_uniform_flow_on_a_moving_mesh_stays_so) {
  FluidParameters p = air();
  p.viscosity = 0.01;
  p.boundaries["xmin"] = absorbing(boundary(BoundaryType::inlet, {"3", "0"}));
  p.boundaries["xmax"] = absorbing(boundary(BoundaryType::outlet));
  p.initial_velocity = {{"3"}, {"0"}};
  const double pi = std::acos(-1.);
  FluidCase<2> d(MPI_COMM_WORLD, make_box(BoxCells::triangles, {12, 6, 1}, Vec3::Zero(), Vec3(1, 0.5, 1)), p,
                 [pi](const Vec3& x, GlobalIndex, double t) {
                   const double bump = std::sin(pi * x[0]) * std::sin(2 * pi * x[1]) * std::sin(300 * t);
                   return Vec3(x[0] + 0.03 * bump, x[1] + 0.02 * bump, 0);
                 });
  for (int i = 1; i <= 40; ++i) d.step(i % 3 == 0 ? 1e-4 : 2e-4);
  const double apart = d.largest_velocity_error([](const Vec3&) { return Vec3(3, 0, 0); }) / 3;
  RecordProperty("uniform_flow", fmt::format("{}", apart));
  EXPECT_LT(apart, 1e-12);
  EXPECT_LT(pressures(d).largest, 3e-12 * rho * c * 3);
}

/// The right wall comes in to 0.8 of the length within 40 ms, and stays.
double stroke(double t) {
  const double pi = std::acos(-1.);
  return t > 0.04 ? 0.2 : 0.1 * (1 - std::cos(pi * t / 0.04));
}

// The pressure is that of a change of volume in small steps, of second order in time. A flow along the piston keeps its
// kinetic energy.
TEST_P(Wave, a_piston_compresses_a_closed_cylinder) {
  std::vector<double> errors;
  for (const int steps : {300, 600}) {
    FluidParameters p = air(GetParam());
    for (const char* side : {"ymin", "ymax"}) p.boundaries[side] = boundary(BoundaryType::periodic);
    p.initial_velocity = {{"0"}, {"2"}};
    p.initial_pressure = config::ExpressionText{"0"};
    p.boundaries["xmax"] = boundary(BoundaryType::interface);
    RawMesh raw = duct(20);
    raw.periodic = {{"ymin", "ymax"}};
    FluidCase<2> d(MPI_COMM_WORLD, raw, p, [](const Vec3& x, GlobalIndex, double t) {
      return Vec3(x[0] * (1 - stroke(t)), x[1], 0);
    });
    double worst = 0, energy = 0;
    for (int i = 0; i < steps; ++i) {
      d.step(0.06 / steps,
             [&](const Vec3&, double t) { return Vec3((stroke(t - 1e-7) - stroke(t)) / 1e-7, 0, 0); });
      const double t = d.state().pressure[0]->time, exact = -rho * c * c * std::log(1 - stroke(t));
      if (t > 0.01) worst = std::max(worst, std::abs(pressures(d).mean / exact - 1));
      double squares = 0;
      for (Index cell = 0; cell < d.mesh().cells.n_owned(); ++cell)
        squares += d.state().placement->volume[cell] * std::pow(d.state().u[cell][1], 2);
      energy = std::max(energy, std::abs(parallel::sum(d.mesh().comm, squares) / (0.02 * 4) - 1));
    }
    errors.push_back(worst);
    RecordProperty(fmt::format("energy_{}", steps), fmt::format("{}", energy));
    EXPECT_LT(energy, 1e-3) << steps;
  }
  RecordProperty("piston_error", fmt::format("{}", errors.back()));
  EXPECT_LT(errors.back(), 4e-4);
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.7);
}

// What leaves and what compression takes up, dp/dt V/(rho c^2) by the rule of the step itself, add up to nothing.
TEST_P(Pulse, keeps_the_mass_in_each_row_of_its_balance) {
  FluidParameters p = pulse(GetParam());
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.01*sin(3000*t)", "0"});
  FluidCase<2> d(MPI_COMM_WORLD, duct(50), p);
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() /
      fmt::format("couplet-sound-{}-{}", parallel::comm_size(MPI_COMM_WORLD), int(GetParam()));
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) std::filesystem::create_directories(folder);
  MPI_Barrier(MPI_COMM_WORLD);
  {
    FluidOutput<2> output(d.fluid(), d.geometry(), {.output_folder = folder});
    for (int i = 0; i < 40; ++i) {
      d.step(i < 20 ? 50e-6 : 20e-6);
      output.write_series(d.state().time);
    }
  }
  if (parallel::comm_rank(MPI_COMM_WORLD) > 0) return;
  std::ifstream in(folder / "balance.csv");
  double net = 0, defect = 0;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<double> row;
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) row.push_back(std::stod(word));
    net = std::max(net, std::abs(row.at(2) - row.at(1))), defect = std::max(defect, std::abs(row.at(7)));
  }
  RecordProperty("mass_defect", fmt::format("{} of {}", defect, net));
  EXPECT_GT(net, 1e-5);
  EXPECT_LT(defect, 1e-7 * net);
}

/// Pressures and velocities of all cells in a row.
std::vector<double> numbers(const State<2>& s) {
  std::vector<double> all(s.pressure[0]->p);
  all.insert(all.end(), s.phi.begin(), s.phi.end());
  for (const auto& u : s.u) all.insert(all.end(), u.data(), u.data() + 2);
  all.insert(all.end(), s.openings.mean.begin(), s.openings.mean.end());
  all.insert(all.end(), s.pressure[0]->ends.begin(), s.pressure[0]->ends.end());
  return all;
}

TEST_P(Pulse, goes_on_bit_for_bit_from_a_checkpoint) {
  for (const std::string behind : {"nothing", "volume"}) {
    FluidParameters p = pulse(GetParam());
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.01*sin(3000*t)", "0"});
    p.boundaries["xmin"].absorbing = behind == "nothing";
    if (behind == "volume") p.compressibility->upstream_volume = 0.003;
    FluidCase<2> d(MPI_COMM_WORLD, duct(50), p);
    d.run(6e-4, 30);
    io::StateInMemory memory;
    {
      io::CheckpointWriter writer(memory);
      write_state(writer, d.state());
      d.fluid().solvers().save(writer);
      writer.close();
    }
    Fluid<2> other(d.mesh(), d.geometry(), d.fluid().parameters(), false);
    io::CheckpointReader reader(memory);
    other.restore(read_state<2>(reader, d.mesh(), other.state().placement));
    other.solvers().load(reader);
    for (int i = 0; i < 4; ++i)
      for (Fluid<2>* fluid : {&d.fluid(), &other}) {
        fluid->begin_step(fluid->state().time, 2e-5);
        fluid->solve({}, {});
        fluid->accept();
      }
    EXPECT_EQ(numbers(d.state()), numbers(other.state())) << behind;
  }
}

TEST_P(Pulse, is_the_same_on_any_number_of_ranks) {
  FluidParameters p = pulse(GetParam());
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.01*sin(3000*t)", "0"});
  p.compressibility->upstream_volume = 0.003;
  FluidCase<2> all(MPI_COMM_WORLD, duct(50), p), alone(MPI_COMM_SELF, duct(50), p);
  all.run(6e-4, 20);
  alone.run(6e-4, 20);
  EXPECT_NEAR(pressures(all).centre, pressures(alone).centre, 1e-8);
  EXPECT_NEAR(pressures(all).largest, pressures(alone).largest, 1e-8);
  EXPECT_NEAR(all.state().pressure[0]->ends[0], alone.state().pressure[0]->ends[0], 1e-8);
  EXPECT_NEAR(all.state().openings.mean[0], alone.state().openings.mean[0], 1e-11);
  EXPECT_NEAR(all.state().ledger.energy / alone.state().ledger.energy, 1, 1e-8);
}

// The mirror image of the pulse above: the impedance of an inlet that absorbs is rho c.
TEST_P(Wave, leaves_through_an_inlet_that_absorbs) {
  FluidParameters p = air(GetParam());
  const std::string shape = fmt::format("exp(-((x - 0.75)/{})^2)", c * width);
  p.initial_pressure = config::ExpressionText{shape};
  p.initial_velocity = {{fmt::format("-{}/{}", shape, rho * c)}, {"0"}};
  p.boundaries["xmin"] = absorbing(boundary(BoundaryType::inlet, {"0", "0"}));
  p.compressibility->mean_time = 1;
  FluidCase<2> d(MPI_COMM_WORLD, duct(400), p);
  d.run(3.2e-3, 320);
  RecordProperty("reflection", fmt::format("{}", pressures(d).largest));
  EXPECT_LT(pressures(d).largest, 2e-3);
}

// The mean of the pressure does not push: what flows in is what is given, at any pressure of the outlet.
TEST_P(Wave, an_absorbing_inlet_keeps_its_flow_at_any_mean_pressure) {
  FluidParameters p = air(GetParam());
  p.initial_velocity = {{"0.5"}, {"0"}};
  p.boundaries["xmin"] = absorbing(boundary(BoundaryType::inlet, {"0.5", "0"}));
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "400");
  p.compressibility->mean_time = 5e-3;
  FluidCase<2> d(MPI_COMM_WORLD, duct(20), p);
  d.run(0.4, 4000);
  double flow = 0;  // out
  const Patch& inlet = *d.mesh().find_patch("xmin");
  for (Index f = inlet.first; f < inlet.first + inlet.count; ++f) flow += d.state().phi[f];
  EXPECT_NEAR(parallel::sum(d.mesh().comm, flow), -0.5 * 0.02, 1e-8);
  EXPECT_NEAR(pressures(d).mean, 400, 0.1);
}

/// Vortices in a closed box, and the same incompressible.
TEST(Sound, a_small_mach_number_gives_the_incompressible_flow) {
  const auto vortices = [](double mach) {
    FluidParameters p = air();
    p.viscosity = 0.05;
    p.density = 1;
    if (mach > 0)
      p.compressibility->speed_of_sound = 1 / mach;
    else
      p.compressibility.reset();
    p.initial_velocity = {{"sin(x)*cos(y) + 0.3*sin(2*x)*cos(2*y)"},
                          {"-cos(x)*sin(y) - 0.3*cos(2*x)*sin(2*y)"}};
    const double pi = std::acos(-1.);
    FluidCase<2> d(MPI_COMM_WORLD,
                   make_box(BoxCells::quadrilaterals, {24, 24, 1}, Vec3::Zero(), Vec3(pi, pi, 1)), p);
    d.run(1, 50);
    return d;
  };
  // The incompressible flow remembers only what alternates of the pressure's excess, so that it differs by an error in space.
  const FluidCase<2> incompressible = vortices(0), limit = vortices(1e-5);
  EXPECT_LT(difference(limit, incompressible), 1e-3);
  std::vector<double> changes;
  for (const double mach : {5e-4, 1e-4, 5e-5}) changes.push_back(difference(vortices(mach), limit));
  RecordProperty("change", fmt::format("{}", changes[1]));
  RecordProperty("slope", fmt::format("{}", std::log10(changes[0] / changes[2])));
  EXPECT_LT(changes[1], 1e-6);
  EXPECT_NEAR(std::log10(changes[0] / changes[2]), 2, 0.1);
}

/// The errors of the steps travel with a wave and leave with it, so that their sum would be many times too large.
TEST_P(Wave, has_an_unknown_error_of_its_steps_on_the_way_to_an_absorbing_end) {
  const double w = 2 * std::acos(-1.) * 500;
  FluidParameters p = air(GetParam());
  p.boundaries["xmin"] = boundary(BoundaryType::inlet);
  p.boundaries["xmin"].velocity = {{fmt::format("0.01*sin({}*t)", w)}, {"0"}};
  for (const bool absorbs : {true, false}) {
    p.boundaries["xmax"] =
        absorbs ? absorbing(boundary(BoundaryType::outlet)) : boundary(BoundaryType::outlet);
    FluidParticipant<2> fluid(distribute(MPI_COMM_WORLD, duct(50)), p, FluidContext{}, MotionLink{});
    const double step = support::observe(fluid, 100, 1e-4).diagnostics().errors().step;
    EXPECT_EQ(std::isnan(step), absorbs) << step;
  }
}

TEST(Sound, what_does_not_go_with_it_is_refused) {
  const auto told = [](FluidParameters p) -> std::string {
    return support::error_of([&] { FluidCase<2> d(MPI_COMM_WORLD, duct(4), p); });
  };
  FluidParameters p = air();
  EXPECT_EQ(told(p), "");
  p.compressibility->speed_of_sound.reset();
  p.density = 100;
  EXPECT_THAT(told(p), ::testing::HasSubstr("not a known gas or liquid"));
}

}  // namespace couplet::fluid::test::sound_test
