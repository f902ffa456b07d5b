// SPDX-License-Identifier: Apache-2.0
// Each guard fires on what it is for and keeps still beside it.
#include "coupler/diagnostics/view.hpp"

#include "common/base/numbers.hpp"
#include "coupler/mapping/surface_checks.hpp"
#include "tests/support/test.hpp"

namespace couplet::view_test {
using namespace coupling;
using namespace coupler;

using testing::HasSubstr;
using Place = Interface::Place;
using Type = AccelerationParameters::Type;

// -- residuals of one step --------------------------------------------------------------------------------
/// Passes until the guard throws; 0 if it never does.
int thrown_at(const std::function<double(int)>& residual, Type type, std::string* text = nullptr) {
  ResidualGrowth guard;
  guard.start_step();
  for (int k = 1; k <= 60; ++k) try {
      guard.pass(residual(k), 1, type);
    } catch (const SolveFailure& failure) {
      if (text) *text = failure.what();
      EXPECT_EQ(dynamic_cast<const SchemeFailure*>(&failure) != nullptr, type == Type::constant);
      return k;
    }
  return 0;
}

TEST(ResidualGrowth, growth_is_named_within_a_few_passes_with_the_added_mass_behind_it) {
  std::string text;
  EXPECT_EQ(thrown_at([](int k) { return std::pow(2., k); }, Type::constant, &text),
            ResidualGrowth::patience + 1);
  // |1 - (1 + r)| = 2
  EXPECT_THAT(text, HasSubstr("an added mass of about 2 times the structure's"));
  EXPECT_THAT(text, HasSubstr("only relaxations below 0.667 converge"));
}

TEST(ResidualGrowth, a_run_away_is_named_before_patience_ends) {
  EXPECT_EQ(thrown_at([](int k) { return k == 1 ? 1. : std::pow(1e4, k); }, Type::aitken), 2);
}

TEST(ResidualGrowth, an_accelerated_iteration_that_grows_may_still_be_halved) {
  std::string text;
  const auto growing = [](int k) { return std::pow(1.5, k); };
  EXPECT_GT(thrown_at(growing, Type::aitken, &text), 0);
  EXPECT_THAT(text, HasSubstr("iqn-ils"));
  EXPECT_GT(thrown_at(growing, Type::iqn_ils, &text), 0);
  EXPECT_THAT(text, Not(HasSubstr("iqn-ils")));
}

TEST(ResidualGrowth, aitkens_first_overshoots_and_slow_convergence_pass) {
  // From relaxation 1 at a mass ratio of 50: one jump, then down with bumps.
  const double bumpy[] = {1, 50, 3, 4, 5, 2, 2.5, 1, 0.2, 0.3, 0.31, 0.32, 0.05};
  EXPECT_EQ(thrown_at([&](int k) { return k <= 13 ? bumpy[k - 1] : 0.05 * std::pow(0.9, k); }, Type::aitken),
            0);
  EXPECT_EQ(thrown_at([](int k) { return std::pow(0.99, k); }, Type::constant), 0);
  EXPECT_EQ(thrown_at([](int) { return 1.; }, Type::constant), 0) << "a plateau is for max-iterations";
}

// -- motion from step to step -----------------------------------------------------------------------------
/// Steps until the guard speaks; 0: never in 400.
int spoken_at(const std::function<double(double)>& motion, Scheme scheme = Scheme::explicit_,
              std::string* text = nullptr) {
  StepOscillation guard;
  for (int n = 1; n <= 400; ++n)
    if (const auto reason = guard.accepted({motion(n), 0.5 * motion(n)}, 0.01, scheme)) {
      if (text) *text = *reason;
      return n;
    }
  return 0;
}

TEST(StepOscillation, added_mass_growth_is_named_with_a_scheme_that_holds) {
  std::string text;
  EXPECT_LE(spoken_at([](double n) { return std::pow(-2., n); }, Scheme::explicit_, &text), 9);
  EXPECT_GT(spoken_at([](double n) { return std::pow(-2., n); }), 0);
  EXPECT_THAT(text, HasSubstr("added-mass instability of explicit coupling"));
  EXPECT_THAT(text, HasSubstr("scheme: semi-implicit"));
  const int slow = spoken_at([](double n) { return std::pow(-1.02, n); });
  EXPECT_GT(slow, 0);
  EXPECT_LT(slow, 70);
}

// A cure that no test shows is not named.
TEST(StepOscillation, an_uneven_growth_is_named_with_its_period_and_its_part_of_the_motion) {
  std::string text;
  const auto swing = [](double n) { return 1e-4 * n + 2e-4 * std::pow(-1.6, n) * (1 + 0.3 * std::cos(n)); };
  EXPECT_GT(spoken_at(swing, Scheme::semi_implicit, &text), 0);
  EXPECT_THAT(text, HasSubstr("a period of two steps (0.02 s)"));
  EXPECT_THAT(text, HasSubstr("of the largest motion"));
  EXPECT_THAT(text, testing::Not(HasSubstr("scheme:")));
}

TEST(StepOscillation, smooth_motion_decaying_swings_rounding_and_steady_swings_pass) {
  const double pi = 3.14159265358979;
  EXPECT_EQ(spoken_at([](double n) { return std::sin(0.1 * n); }), 0);
  EXPECT_EQ(spoken_at([](double n) { return std::exp(0.05 * n) * std::sin(0.5 * n); }), 0) << "flutter";
  EXPECT_EQ(spoken_at([](double n) { return std::pow(-0.9, n); }), 0);
  EXPECT_EQ(spoken_at([](double n) { return std::pow(-1., n); }), 0) << "an undamped trapezoidal rule";
  EXPECT_EQ(spoken_at([&](double n) { return 0.02 * n + 1e-6 * std::pow(-1.02, n / 4) * std::cos(pi * n); }),
            0)
      << "small beside the motion";
  for (const double detuned : {0.02, 0.05, 0.1, 0.2, 0.39})  // promises/stiff-flap beats by the last one
    for (const double phase : {0., 0.4, 0.8, 1.2})
      EXPECT_EQ(spoken_at([&](double n) { return std::cos((pi - detuned) * n + phase); }), 0) << detuned;
  for (const double power : {1, 2})
    EXPECT_EQ(spoken_at([&](double n) { return std::pow(-1., n) * std::pow(std::min(n / 50, 1.), power); }),
              0)
        << "a rising load";
  EXPECT_EQ(spoken_at([](double) { return 0.; }), 0);
  EXPECT_EQ(spoken_at([](double n) { return n < 3 ? 0. : 1.; }), 0) << "a kick";
}

/// A body at rest half a millimeter off, whose swings grow by 1.2 per step from 1e-10 of that: told at a thousandth, or at the
/// coupling's tolerance.
TEST(StepOscillation, swings_below_a_thousandth_or_the_tolerance_of_the_coupling_are_no_part_of_the_answer) {
  for (const double tolerance : {0., 1e-5, 1e-2}) {
    StepOscillation guard(MPI_COMM_SELF, tolerance);
    int told = 0;
    for (int n = 0; n < 120 && told == 0; ++n)
      if (guard.accepted({5e-4 * (1 + 1e-10 * std::pow(-1.2, n))}, 0.02, Scheme::semi_implicit)) told = n;
    const double least = std::max(tolerance, StepOscillation::floor);
    EXPECT_NEAR(told, std::log(least / 1e-10) / std::log(1.2), 2) << tolerance;
  }
}

TEST(StepOscillation, a_blow_up_that_ended_with_a_halved_step_does_not_hide_later_swings) {
  const auto told = [](double dt) {
    StepOscillation guard;
    for (int n = 1; n <= 20; ++n) guard.accepted({1e6 * n}, 0.01, Scheme::implicit);
    for (int n = 1; n <= 200; ++n)
      if (guard.accepted({1 + 2e7 * std::exp(-n) + 1e-3 * std::pow(-1.2, n)}, dt, Scheme::implicit)) return n;
    return 0;
  };
  EXPECT_GT(told(0.01), 80);
  EXPECT_GT(told(0.005), 0);
  EXPECT_LT(told(0.005), 70);
}

TEST(StepOscillation, steps_of_another_length_do_not_hide_it) {
  StepOscillation guard;
  std::string text;
  for (int n = 0; n < 12 && text.empty(); ++n)
    text = guard.accepted({std::pow(-2., n)}, n < 4 ? 0.01 : 0.005, Scheme::explicit_).value_or("");
  EXPECT_THAT(text, HasSubstr("added-mass instability"));
}

TEST(StepOscillation, a_step_that_fails_after_a_swing_is_explained_by_it_and_else_not) {
  StepOscillation swinging, smooth;
  for (int n = 0; n < 5; ++n) {
    EXPECT_FALSE(swinging.accepted({std::pow(-3., n)}, 0.01, Scheme::explicit_));
    EXPECT_FALSE(smooth.accepted({double(n * n)}, 0.01, Scheme::explicit_));
  }
  EXPECT_TRUE(swinging.suspects(Scheme::explicit_));
  EXPECT_FALSE(smooth.suspects(Scheme::explicit_));
}

// -- work -------------------------------------------------------------------------------------------------
TEST(WorkBalance, work_of_small_steps_and_turning_points_pass) {
  WorkBalance guard;
  for (int n = 0; n < 400; ++n) {
    const double work = std::sin(0.02 * n);
    guard.accepted(work, work * 1.01 + 0.005);
  }
  EXPECT_TRUE(guard.result().sound);
}

TEST(WorkBalance, a_guess_that_jitters_parts_the_work_but_is_no_instability) {
  WorkBalance guard;
  for (int n = 0; n < 200; ++n) guard.accepted(n % 2 ? -0.8 : 0.4, 0.35 + 0.05 * std::sin(n));
  EXPECT_FALSE(guard.result().sound) << "it is said at the end";
  EXPECT_THAT(guard.result().text, HasSubstr("NOT BALANCED"));
  EXPECT_TRUE(guard.result().useless);  // of an iteration
  const WorkBalance::WorkResult lagging = guard.result(true, true);
  EXPECT_FALSE(lagging.useless) << "the motion may be right";
  EXPECT_FALSE(lagging.sound);
  EXPECT_THAT(lagging.text, HasSubstr("in explicit coupling load and motion belong to different times"));
}

TEST(WorkBalance, an_answer_is_useless_where_half_of_the_work_is_apart_and_not_before) {
  for (const auto& [taken, steps, useless] :
       {std::tuple{0.51, 20, false}, {0.49, 19, false}, {0.49, 20, true}, {-0.5, 100, true}}) {
    WorkBalance guard;
    for (int n = 0; n < steps; ++n) guard.accepted(1, taken);
    EXPECT_EQ(guard.result().useless, useless) << taken << ", " << steps;
    EXPECT_FALSE(guard.result().sound);
  }
}

TEST(WorkBalance, work_is_judged_by_what_stays_not_by_what_went_to_and_fro) {
  // A damped oscillation: each step moves 1 J there or back, 5.7 J stay for one side and 6.3 J for the other.
  WorkBalance damped, there_and_back;
  for (int n = 0; n < 1000; ++n) {
    damped.accepted(std::sin(0.1 * n) + 0.0057, std::sin(0.1 * n) + 0.0063);
    // Nothing stays, but the structure's energy is 20 J at most.
    there_and_back.accepted(std::sin(0.1 * n), std::sin(0.1 * n) + 1e-4);
    damped.energy(0.5), there_and_back.energy(20 * std::abs(std::sin(0.05 * n)));
  }
  EXPECT_FALSE(damped.result().sound) << damped.result().text;
  EXPECT_FALSE(damped.result().useless);
  EXPECT_THAT(damped.result(true).text, testing::AllOf(HasSubstr("nearest"), HasSubstr("projection")));
  EXPECT_TRUE(there_and_back.result().sound) << there_and_back.result().text;
}

TEST(WorkBalance, its_sums_go_through_a_checkpoint) {
  WorkBalance guard, other;
  for (int n = 0; n < 5; ++n) guard.accepted(n, 1.5 * n);
  base::from_numbers(base::to_numbers(guard), other, "work");
  EXPECT_EQ(other.result().text, guard.result().text);
}

// -- data and places --------------------------------------------------------------------------------------
/// n faces of a line from (x, 0) to (x + length, 0).
Interface line(int n, double length, double x = 0, double y = 0) {
  Interface i;
  i.dim = 2;
  const double h = length / n;
  for (int k = 0; k <= n; ++k) i.vertices.emplace_back(x + k * h, y, 0);
  for (int k = 0; k < n; ++k) {
    i.face_centres.emplace_back(x + (k + 0.5) * h, y, 0);
    i.face_areas.emplace_back(0, h, 0);
  }
  i.gives = {{"pressure-force", "N", Place::faces}};
  return i;
}

PlaceReport judge(const Interface& solid, const Interface& fluid) {
  return compare_places(MPI_COMM_SELF, {MPI_COMM_SELF, "solid", solid}, {MPI_COMM_SELF, "fluid", fluid},
                        true);
}
std::string problem(const Interface& solid, const Interface& fluid) { return judge(solid, fluid).problem; }
TEST(Places, surfaces_elsewhere_or_of_another_size_are_refused) {
  EXPECT_THAT(problem(line(10, 1, 0, 2), line(10, 1)), HasSubstr("their positions differ"));
  EXPECT_THAT(problem(line(10, 1000), line(10, 1)), HasSubstr("one is 1e+03 times as large as the other"));
  EXPECT_THAT(problem(line(100, 1, 0.3), line(100, 1)), HasSubstr("their positions differ"));
  // A bulge in the middle that no box shows.
  Interface bulged = line(100, 1), box = line(100, 1);
  for (auto* i : {&bulged, &box}) i->vertices.emplace_back(0, 1, 0);
  bulged.vertices[50].y() = 0.1;
  EXPECT_THAT(problem(box, bulged), HasSubstr("is 0.1 m away from the nearest point of 'solid'"));
}

TEST(Places, equal_refined_coarser_and_shifted_surfaces_pass_and_stairs_are_said) {
  EXPECT_EQ(problem(line(10, 1), line(10, 1)), "");
  EXPECT_EQ(problem(line(20, 1), line(10, 1)), "");
  EXPECT_EQ(problem(line(10, 1, 0.03), line(13, 1)), "");
  EXPECT_EQ(problem(line(3, 1), line(60, 1)), "");
  EXPECT_TRUE(judge(line(20, 1), line(10, 1)).notes.empty());
  const auto notes = judge(line(3, 1), line(60, 1)).notes;
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("'solid' is much coarser than 'fluid'"));
}

/// What is said of a wall of `n` faces that moves one of `m`, mapped by the nearest.
std::string said_of_nearest(int n, int m) {
  const std::vector<Interface::Datum> motion{{"displacement", "m", Place::vertices}},
      load{{"pressure-force", "N", Place::faces}};
  Interface solid = line(n, 1), fluid = line(m, 1);
  solid.gives = fluid.takes = motion, solid.takes = fluid.gives = load;
  const std::vector<Side> sides{{MPI_COMM_SELF, "solid", solid}, {MPI_COMM_SELF, "fluid", fluid}};
  const MappingParameters nearest{.type = MappingParameters::Type::nearest, .tolerance = {}};
  return support::error_of([&] {
    check_places(MPI_COMM_SELF, sides, {MPI_COMM_SELF, sides, nearest}, nearest);
  });
}

TEST(Places, nearest_is_refused_where_faces_do_not_nest_and_the_map_that_serves_is_named) {
  for (const auto& [n, m] : {std::pair{30, 20}, std::pair{20, 30}, std::pair{25, 40}, std::pair{7, 3}})
    EXPECT_THAT(said_of_nearest(n, m), testing::AllOf(HasSubstr("do not nest"), HasSubstr("projection")))
        << n << m;
  for (const auto& [n, m] : {std::pair{20, 20}, std::pair{40, 20}, std::pair{20, 40}})
    EXPECT_EQ(said_of_nearest(n, m), "");
}

// A strip of long thin faces, as of a wedge that stands for a round tank: their area says less than their corners.
TEST(Places, long_thin_faces_are_as_large_as_their_corners_say) {
  const auto strip = [](int n, double shift, bool corners) {
    const double h = 1. / n, w = h / 40;
    Interface i{3, {}, {}, {}, {{"displacement", "m", Place::vertices}}, {}};
    for (int k = 0; k <= n; ++k)
      for (const double z : {0., w}) i.vertices.emplace_back(std::clamp(k * h + shift, 0., 1.), 0, z);
    for (int k = 0; k < n; ++k) {
      i.face_centres.emplace_back((k + 0.5) * h, 0, w / 2);
      i.face_areas.emplace_back(0, h * w, 0);
      if (!corners) continue;
      if (k == 0) i.face_offset = {0};
      for (const int v : {2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2}) i.face_vertices.push_back(v);
      i.face_offset.push_back(4 * (k + 1));
    }
    return i;
  };
  EXPECT_EQ(problem(strip(20, 0, true), strip(20, 0.02, true)), "");
  EXPECT_THAT(problem(strip(20, 0, false), strip(20, 0.02, false)), HasSubstr("not the same surface"));
}

TEST(Places, a_load_that_is_not_finite_is_named_with_its_place) {
  const Interface fluid = line(4, 1);
  Exchange data{{"pressure-force", std::vector<double>(8, 1.)}};
  EXPECT_NO_THROW(require_finite(MPI_COMM_SELF, data, fluid, fluid.gives, "fluid"));
  data["pressure-force"][5] = NAN;
  EXPECT_EQ(support::error_of<SolveFailure>(
                [&] { require_finite(MPI_COMM_SELF, data, fluid, fluid.gives, "fluid"); }),
            "'fluid' gave a 'pressure-force' that is not finite at face 2, (0.625, 0, 0).");
}

}  // namespace couplet::view_test
