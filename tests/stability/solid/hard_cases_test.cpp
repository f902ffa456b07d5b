// SPDX-License-Identifier: Apache-2.0
// Free swings of a sheet and the largest energy that they reach.
#include "common/diagnostics/finding.hpp"
#include "tests/verification/heat/support.hpp"
#include "tests/verification/solid/partner_load.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::hard_cases_test {
using namespace mesh;
using namespace time;
using time::TimeScheme;

/// A sheet held at xmin that starts with a velocity; undamped.
SolidParameters free_swing(time::TimeScheme scheme, FaceGradient gradient) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e5, 0.3};
  p.time_scheme.type = scheme;
  p.method.face_gradient = gradient;
  p.method.relative_tolerance = 1e-12;
  p.boundaries["xmin"] = clamped(2);
  p.initial_velocity = {{"0.1*x*sin(9*y)"}, {"0.2*x*x"}};
  p.output.energies = true;
  return p;
}

struct Swing {
  double growth =
      0;  ///< largest energy (kinetic, and the smaller of strain energy and work) over the first, minus 1
  bool ended = false;  ///< by the energy guard of the program
  std::string cause;
};

/// `steps`: one after the other, again and again; the balance of energies is looked at every 20 of them.
Swing swing(const mesh::RawMesh& raw, const SolidParameters& p, const std::vector<double>& steps, int count) {
  const auto solid = make_solid(raw, p);
  EnergyBalance balance(solid->view(), std::make_shared<StrainEnergy>(solid->view()));
  diagnostics::Report report;
  Swing result;
  double largest = 0, first = 1;
  try {
    for (int i = 0; i < count; ++i) {
      step(*solid, steps[std::size_t(i) % steps.size()]);
      const SolidEnergies e = energies(*solid);
      first = e.initial_kinetic;
      largest = std::max(largest, e.kinetic + std::max(0.0, std::min(e.strain, e.internal_work)));
      if (i % 20 == 19) balance.look(report);
    }
  } catch (const Error& error) {
    result.ended = true;
    result.cause = error.what();
  }
  result.growth = largest / first - 1;
  return result;
}

/// Ten cells along, four across; the middle leans, the ends stand.
mesh::RawMesh sheet(double lean) {
  mesh::RawMesh raw =
      mesh::make_box(mesh::BoxCells::quadrilaterals, {10, 4, 1}, Vec3::Zero(), Vec3(1, 0.4, 0));
  for (Vec3& x : raw.points) x[0] += lean * (x[1] - 0.2) * std::sin(M_PI * x[0]);
  return raw;
}

// Structures that break schemes: steps that jump by a factor of 100, cells of aspect 1000, stiffness that jumps by 1e6.
// Each stands beside the neighbour that fails, and that neighbour is told.

// Mechanism: a scheme that carries an acceleration or an earlier level along weighs it by a step that is gone.
const std::vector<double> jumping{1e-3, 0.1, 0.1, 1e-3, 1e-3, 0.1, 3e-3, 0.05};

TEST(StepsThatJumpByAHundred, leave_the_energy_of_the_other_schemes_alone) {
  for (const TimeScheme scheme :
       {TimeScheme::euler, TimeScheme::three_point, TimeScheme::trapezoidal, TimeScheme::bathe})
    for (const double lean : {0.0, 1.0}) {
      const Swing s = swing(sheet(lean), free_swing(scheme, FaceGradient::symmetric), jumping, 240);
      EXPECT_FALSE(s.ended) << s.cause;
      EXPECT_LT(s.growth, 1e-8) << name(scheme) << ", lean " << lean;
    }
}

TEST(StepsThatJumpByAHundred, make_generalised_alpha_grow_and_the_run_ends_with_the_cause) {
  const SolidParameters p = free_swing(TimeScheme::generalised_alpha, FaceGradient::symmetric);
  const Swing jumps = swing(sheet(0), p, jumping, 800), even = swing(sheet(0), p, {0.05}, 240);
  fmt::print("generalised-alpha: {:.3g}, {}\n", jumps.growth, jumps.cause);
  EXPECT_GT(jumps.growth, 1);
  EXPECT_TRUE(jumps.ended) << "grew by " << jumps.growth;
  EXPECT_FALSE(even.ended);
  EXPECT_LT(even.growth, 1e-8);
}

struct Plate {
  double over_beam = 0;  ///< displacement at the end over that of the theory of bars and beams
  bool doubted = false;
};

/// 16 cells along, each `aspect` times as long as high.
Plate plate(FaceGradient gradient, double aspect, bool pull) {
  constexpr int along = 16, across = 16;
  const double length = along, height = across / aspect, modulus = 1e6 / (1 - 0.3 * 0.3);
  SolidParameters p = box_parameters(2);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {pull ? "1" : "0", pull ? "0" : "1e-3"});
  const auto solid = stepped(
      make_box(BoxCells::quadrilaterals, {along, across, 1}, Vec3::Zero(), Vec3(length, height, 0)), p);
  const std::vector<double> moved = solid->fields().point_displacement();
  const Geometry& geometry = solid->body().geometry();
  double end = 0;
  for (std::size_t i = 0; i < geometry.points.size(); ++i)
    if (geometry.points[i][0] > length - 1e-6) end = moved[2 * i + (pull ? 0 : 1)];
  const double beam = pull ? length / modulus
                           : 1e-3 * height * std::pow(length, 3) / (3 * modulus * std::pow(height, 3) / 12);
  return {end / beam, audit_of(*solid).is_doubtful()};
}

// Mechanism: differences along the long side do not see the bending between two cells.
TEST(CellsOfAspectAThousand, are_pulled_right_by_all_gradients_and_bent_the_right_way_by_the_symmetric_one) {
  for (const FaceGradient gradient : {FaceGradient::thesis, FaceGradient::symmetric}) {
    const Plate pulled = plate(gradient, 1000, true);
    EXPECT_NEAR(pulled.over_beam, 1, 0.01);
    EXPECT_FALSE(pulled.doubted);
  }
  const Plate bent = plate(FaceGradient::symmetric, 1000, false);
  RecordProperty("bent", fmt::format("{:.3f}", bent.over_beam));
  EXPECT_GT(bent.over_beam, 0.7);
  EXPECT_LT(bent.over_beam, 1.15);
}

TEST(CellsOfAspectAThousand, bend_wrongly_with_the_thesiss_gradient_and_that_is_told) {
  const Plate bent = plate(FaceGradient::thesis, 1000, false);
  EXPECT_LT(bent.over_beam, 0.1);
  EXPECT_TRUE(bent.doubted);
}

TEST(CellsOfAspectAThousand, keep_the_energy_of_a_swing_with_the_symmetric_gradient) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {10, 8, 1}, Vec3::Zero(), Vec3(1, 8e-4, 0));
  const Swing s = swing(raw, free_swing(TimeScheme::trapezoidal, FaceGradient::symmetric), {0.01}, 300);
  EXPECT_FALSE(s.ended) << s.cause;
  EXPECT_LT(std::abs(s.growth), 1e-3);
}

SolidParameters two_materials(SolidParameters p, double nu) {
  p.materials["soft"] = {{1000, 1e5, nu, {}}, {}};
  p.materials["hard"] = {{1000, 1e11, nu, {}}, {}};
  return p;
}

/// From x = 0.5 on a million times as stiff.
RawMesh joined(RawMesh raw, double from) {
  raw.zones = {"soft", "hard"};
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    raw.cell_zone[c] = raw.points[raw.cell_points[c][0]][0] > from;
  return raw;
}

// Mechanism: unsymmetric terms of the interface are as large as the stiff side, the soft side's modes small beside them.
TEST(StiffnessThatJumpsByAMillion, keeps_the_energy_of_a_swing_with_the_symmetric_gradient) {
  for (const double lean : {0.0, 1.0}) {
    const Swing s =
        swing(joined(sheet(lean), 0.45),
              two_materials(free_swing(TimeScheme::trapezoidal, FaceGradient::symmetric), 0.3), {0.01}, 300);
    EXPECT_FALSE(s.ended) << s.cause;
    EXPECT_LT(s.growth, 1e-8) << lean;
  }
}

TEST(StiffnessThatJumpsByAMillion, grows_with_the_thesiss_gradient_on_leaning_cells_and_the_run_ends) {
  const Swing s =
      swing(joined(sheet(1), 0.45),
            two_materials(free_swing(TimeScheme::trapezoidal, FaceGradient::thesis), 0.3), {0.01}, 1000);
  EXPECT_TRUE(s.ended) << "grew by " << s.growth;
  EXPECT_NE(s.cause.find("is not symmetric"), std::string::npos) << s.cause;
}

TEST(StiffnessThatJumpsByAMillion, is_stretched_as_two_springs_in_a_row) {
  for (const FaceGradient gradient : {FaceGradient::thesis, FaceGradient::symmetric}) {
    SolidParameters p = two_materials(box_parameters(2), 0.0);
    p.method.face_gradient = gradient;
    p.method.relative_tolerance = 1e-12;
    p.boundaries["xmin"] = clamped(2);
    p.boundaries["xmax"] = boundary(Type::traction, {"10", "0"});
    const auto solid = stepped(joined(sheet(0), 0.45), p);
    const std::vector<double> moved = solid->fields().point_displacement();
    const Geometry& geometry = solid->body().geometry();
    for (std::size_t i = 0; i < geometry.points.size(); ++i) {
      const double x = geometry.points[i][0];
      EXPECT_NEAR(moved[2 * i], x < 0.5 ? 1e-4 * x : 5e-5 + 1e-10 * (x - 0.5), 1e-10) << x;
    }
  }
}

// Steps far below and far above what the cells ask for. Mechanism: a scheme without damping keeps what the operator makes, and
// an operator that is not symmetric makes energy on leaning cells, a little each step; a damping scheme must not make any where
// the step resolves nothing. Here over thousands of steps; 1e5 and 1e4 of them are rows of `scripts/validate stability`.

/// Step at an elastic Courant number: cells of 0.1 m, E = 1e5 Pa, 1000 kg/m^3.
double step_at(double courant) {
  const double lambda = 0.3e5 / (1.3 * 0.4), mu = 1e5 / 2.6;
  return courant * 0.1 / std::sqrt((lambda + 2 * mu) / 1000);
}

Swing swing_at(double courant, TimeScheme scheme, FaceGradient gradient, int steps) {
  return swing(sheet(0.5), free_swing(scheme, gradient), {step_at(courant)}, steps);
}

TEST(SlowSwings, at_a_courant_number_of_a_hundredth_keep_their_energy_with_the_symmetric_gradient) {
  const Swing s = swing_at(0.01, TimeScheme::trapezoidal, FaceGradient::symmetric, 4000);
  EXPECT_FALSE(s.ended) << s.cause;
  EXPECT_LT(s.growth, 1e-7);
}

// The neighbour: on the same leaning cells, where the steps follow the modes that grow.
TEST(SlowSwings, grow_with_the_trapezoidal_rule_and_the_thesiss_gradient) {
  const Swing s = swing_at(1, TimeScheme::trapezoidal, FaceGradient::thesis, 4000);
  fmt::print("thesis: {:.3g} {}\n", s.growth, s.cause);
  EXPECT_GT(s.growth, 1e-3);
}

// After some 180 steps the motion has died away to 1e-150, where norms underflow: no failure of the solver.
TEST(FastSwings, at_a_courant_number_of_a_thousand_do_not_grow_with_bathes_scheme) {
  for (const FaceGradient gradient : {FaceGradient::symmetric, FaceGradient::thesis}) {
    SolidParameters p = free_swing(TimeScheme::bathe, gradient);
    p.method.relative_tolerance = 1e-10;
    const Swing s = swing(sheet(0.5), p, {step_at(1000)}, 400);
    EXPECT_FALSE(s.ended) << s.cause;
    EXPECT_LT(s.growth, 1e-3);
  }
}

// The neighbour: the trapezoidal rule keeps all of what an operator without symmetry makes, also of what it does not resolve
// (at 1000 too little for a test: a swing that is turned round in each step feels next to nothing of the operator).
TEST(FastSwings, at_a_courant_number_of_ten_grow_with_the_trapezoidal_rule_and_the_thesiss_gradient) {
  for (const TimeScheme scheme : {TimeScheme::trapezoidal, TimeScheme::bathe}) {
    SolidParameters p = free_swing(scheme, FaceGradient::thesis);
    p.method.relative_tolerance = 1e-10;
    const Swing s = swing(sheet(0.5), p, {step_at(10)}, 4000);
    EXPECT_EQ(s.ended, scheme == TimeScheme::trapezoidal) << s.cause;
    EXPECT_EQ(s.growth > 1e-3, scheme == TimeScheme::trapezoidal) << s.growth;
  }
}

// Vibrations that the load of a partner excites in a body of large strain and that turn round from step to step.

/// Second differences of the velocity over three steps, squared: what turns round from step to step counts 16 times, what takes many steps
/// nothing.
double turning(const std::array<std::vector<double>, 3>& v) {
  double sum = 0;
  for (std::size_t i = 0; i < v[0].size(); ++i) sum += std::pow(v[2][i] - 2 * v[1][i] + v[0][i], 2);
  return parallel::sum(MPI_COMM_WORLD, sum);
}

/// What is left of a vibration 100 steps after the load that excited it and turned round each step.
double left_of_a_vibration(TimeScheme scheme) {
  const auto solid = testing::sheet(scheme);
  const coupling::Interface interface = solid->initialise();
  std::array<std::vector<double>, 3> v;
  double excited = 0, left = 0;
  for (int i = 0; i < 110; ++i) {
    step_under(*solid, interface, 0.4, i >= 10 ? 0 : i % 2 == 0 ? 100 : -100);
    v = {v[1], v[2], solid->stepper().state().cell_v};
    if (i >= 2 && i < 10) excited = std::max(excited, turning(v));
    if (i >= 100) left = std::max(left, turning(v));
  }
  fmt::print("{}: {:.2g} of a vibration's energy is left\n", time::name(scheme), left / excited);
  return left / excited;
}

TEST(PartnerVibration, dies_out_by_the_default_scheme) {
  EXPECT_LT(left_of_a_vibration(TimeScheme::automatic), 0.02);
}

TEST(PartnerVibration, stays_with_the_trapezoidal_rule) {
  EXPECT_GT(left_of_a_vibration(TimeScheme::trapezoidal), 0.3);
}

// A surface that is heated at once, with steps from half of what the first cell conducts in to a thousand times that.

struct Shock {
  double beyond = 0;  ///< largest distance of a temperature from between the old (0) and the new one (1)
  int told = 0;       ///< doubts of the program
  double back = 0;    ///< largest cooling of a cell in a step: the exact temperature only rises
};

Shock shock(HeatScheme scheme, double fourier) {
  constexpr Index n = 40;
  HeatParameters p;
  p.scheme = scheme;
  p.initial_temperature = {"0"};
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "1");
  HeatCase scene(
      mesh::make_box(mesh::BoxCells::quadrilaterals, {int(n), 1, 1}, Vec3::Zero(), Vec3(1, 0.1, 0)),
      {{1, 1.0, 1.0}}, p);
  Shock result;
  std::vector<double> before(n, 0);
  result.told = scene.doubts(60, fourier / (n * n), [&] {
    for (Index c = 0; c < n; ++c) {
      const double t = scene.temperature(c);
      result.beyond = std::max({result.beyond, -t, t - 1});
      result.back = std::max(result.back, before[std::size_t(c)] - t);
      before[std::size_t(c)] = t;
    }
  });
  return result;
}

// Mechanism: modes that a step does not resolve must decay, not change their sign.
TEST(ThermalShock, does_not_oscillate_with_eulers_scheme_whatever_the_step) {
  for (const double fourier : {0.5, 10.0, 1000.0}) {
    const Shock s = shock(HeatScheme::euler, fourier);
    EXPECT_LT(s.beyond, 1e-12) << fourier;
    EXPECT_LT(s.back, 1e-12) << fourier;
    EXPECT_EQ(s.told, 0);
  }
}

TEST(ThermalShock, with_the_three_point_scheme_overshoots_by_two_per_cent_at_most_and_by_nothing_up_to_ten) {
  for (const double fourier : {0.5, 10.0}) {
    EXPECT_LT(shock(HeatScheme::three_point, fourier).beyond, 1e-12) << fourier;
    EXPECT_LT(shock(HeatScheme::three_point, fourier).back, 1e-12) << fourier;
  }
  const Shock s = shock(HeatScheme::three_point, 1000);
  RecordProperty("overshoot", fmt::format("{:.3f}", s.beyond));
  EXPECT_LT(s.beyond, 0.025);
}

TEST(ThermalShock, swings_by_half_and_more_with_the_trapezoidal_rule_and_that_is_told_once) {
  const Shock short_steps = shock(HeatScheme::trapezoidal, 0.5);
  EXPECT_LT(short_steps.beyond, 1e-12);
  EXPECT_EQ(short_steps.told, 0);
  for (const double fourier : {10.0, 1000.0}) {
    const Shock s = shock(HeatScheme::trapezoidal, fourier);
    EXPECT_GT(s.beyond, 0.5) << fourier;
    EXPECT_EQ(s.told, 1) << fourier;
  }
}

}  // namespace couplet::testing::hard_cases_test
