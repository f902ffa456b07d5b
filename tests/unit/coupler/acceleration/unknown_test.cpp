// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/unknown.hpp"
#include "coupler/output/record.hpp"
#include "coupler/parameters/schedule.hpp"
#include "tests/support/test.hpp"

namespace couplet::unknown_test {
using namespace coupling;
using namespace coupler;
using Place = Interface::Place;
using coupling::Scheme;
using testing::HasSubstr;

Side point(const std::string& name, std::vector<Interface::Datum> takes,
           std::vector<Interface::Datum> gives) {
  Interface i{3, {{0, 0, 0}}, {{0, 0, 0}}, {{1, 0, 0}}, std::move(takes), std::move(gives)};
  return {MPI_COMM_SELF, name, i};
}
const std::vector<Interface::Datum> lagged_motion{{"displacement", "m", Place::vertices, 1},
                                                  {"velocity", "m/s", Place::vertices, 1}};
const std::vector<Interface::Datum> force{{"force", "N", Place::faces, 1}};

struct Pair {
  std::vector<Side> sides{point("fluid", lagged_motion, force), point("solid", force, lagged_motion)};
  Links links{MPI_COMM_SELF, sides, {}};
  Unknown serial{MPI_COMM_SELF, sides, links, {0, 1}, false},
      parallel{MPI_COMM_SELF, sides, links, {0, 1}, true};
};

TEST(Unknown, one_after_the_other_it_is_what_the_later_gives_to_the_earlier_side_by_side_all) {
  const Pair p;
  ASSERT_EQ(p.serial.parts().size(), 2u);
  EXPECT_FALSE(p.serial.parts()[0].is_dependent);
  EXPECT_TRUE(p.serial.parts()[1].is_dependent) << "the velocity goes with the displacement";
  EXPECT_EQ(p.parallel.parts().size(), 3u);
  const Unknown other_order(MPI_COMM_SELF, p.sides, p.links, {1, 0}, false);
  ASSERT_EQ(other_order.parts().size(), 1u);
  EXPECT_EQ(other_order.parts()[0].datum.name, "force");
}

TEST(Unknown, several_data_are_scaled_to_like_size_and_come_back_as_they_were) {
  Pair p;
  const std::vector<Exchange> given{{{"force", {1e6}}}, {{"displacement", {1e-4}}, {"velocity", {0.1}}}};
  EXPECT_TRUE(p.serial.parts()[0].scaled);
  EXPECT_FALSE(p.parallel.parts()[0].scaled);
  p.parallel.scale(given);
  const Iterate x = p.parallel.gather(given);
  ASSERT_EQ(x.unknown.size(), 2u);
  for (const double v : x.unknown) EXPECT_DOUBLE_EQ(v, 1);
  EXPECT_EQ(x.dependent[0], 0.1);
  EXPECT_DOUBLE_EQ(predict(p.parallel, {x, {}, {}, 0, 0}, 0.01, 1).unknown[0], 1 + 0.01 * 0.1 / 1e-4);
  std::vector<Exchange> again(2);
  p.parallel.scatter(x, again);
  for (std::size_t i = 0; i < 2; ++i)
    for (const auto& [name, values] : given[i]) EXPECT_DOUBLE_EQ(again[i].at(name)[0], values[0]) << name;
  // Residuals are those of the data, whatever the scale.
  Iterate image = x;
  image.unknown[0] *= 1.01;
  image.unknown[1] *= 1.02;
  for (const Residual& r : p.parallel.measure(x, image)) EXPECT_GT(r.relative, 0.009);
}

TEST(Unknown, data_without_units_are_scaled_each_by_its_first_values_that_are_not_zero) {
  const std::vector<Interface::Datum> a{{"alfa", "1", Place::vertices, 1}},
      b{{"beta", "1", Place::vertices, 1}};
  const std::vector<Side> sides{point("left", b, a), point("right", a, b)};
  const Links links(MPI_COMM_SELF, sides, {});
  Unknown unknown(MPI_COMM_SELF, sides, links, {0, 1}, true);
  unknown.scale({{{"alfa", {0}}}, {{"beta", {1e-6}}}});
  EXPECT_EQ(unknown.parts()[0].scaled + 2 * unknown.parts()[1].scaled,
            unknown.parts()[0].datum.name == "alfa" ? 2 : 1);
  const std::vector<Exchange> later{{{"alfa", {500}}}, {{"beta", {3e-6}}}};
  unknown.scale(later);
  const std::vector<double> weights = unknown.weights();
  Unknown restored(MPI_COMM_SELF, sides, links, {0, 1}, true);
  restored.restore_weights(weights);
  for (Unknown* one : {&unknown, &restored}) {
    const Iterate x = one->gather(later);
    EXPECT_DOUBLE_EQ(x.unknown[0] * x.unknown[1], 3);
    const std::vector<Residual> r = one->measure(x, x);
    EXPECT_DOUBLE_EQ(r[0].size * r[1].size, 500 * 3e-6);
  }
}

TEST(Unknown, rest_is_a_start_for_motion_alone) {
  const Pair p;
  std::vector<Exchange> given(2);
  EXPECT_TRUE(p.serial.start_at_rest(given));
  EXPECT_EQ(given[1].at("velocity"), std::vector<double>{0});
  EXPECT_FALSE(p.parallel.start_at_rest(given)) << "a force has no natural start";
}

/// Motion with velocity v(t) = 2 + 3 t and displacement 2 t + 1.5 t^2, known at t = 1 and, with a step of
/// 0.4, before.
CouplingHistory accelerated_motion() { return {{{3.5}, {5.}}, {{0.}, {2 + 3 * 0.6}}, {}, 0.4, 0}; }

TEST(Predictor, order_0_repeats_the_last_state) {
  const Pair p;
  const Iterate guess = predict(p.serial, accelerated_motion(), 0.2, 0);
  EXPECT_EQ(guess.unknown[0], 3.5);
  EXPECT_EQ(guess.dependent[0], 5);
}

TEST(Predictor, order_1_goes_on_with_the_last_velocity) {
  const Pair p;
  const Iterate guess = predict(p.serial, accelerated_motion(), 0.2, 1);
  EXPECT_DOUBLE_EQ(guess.unknown[0], 3.5 + 0.2 * 5);
  EXPECT_EQ(guess.dependent[0], 5);
}

TEST(Predictor, order_2_is_exact_for_constant_acceleration_also_when_the_step_changes) {
  const Pair p;
  for (const double dt : {0.1, 0.4, 1.}) {
    const Iterate guess = predict(p.serial, accelerated_motion(), dt, 2);
    const double t = 1 + dt;
    EXPECT_NEAR(guess.unknown[0], 2 * t + 1.5 * t * t, 1e-14) << dt;
    EXPECT_NEAR(guess.dependent[0], 2 + 3 * t, 1e-14) << dt;
  }
}

TEST(Predictor, first_step_of_order_2_is_of_order_1) {
  const Pair p;
  CouplingHistory history = accelerated_motion();
  history.old = {};
  history.old_dt = 0;
  const Iterate guess = predict(p.serial, history, 0.2, 2);
  EXPECT_DOUBLE_EQ(guess.unknown[0], 4.5);
  EXPECT_EQ(guess.dependent[0], 5);
}

TEST(Predictor, data_without_velocity_follow_the_polynomial_through_their_last_values) {
  const Pair p;
  const Unknown forces(MPI_COMM_SELF, p.sides, p.links, {1, 0}, false);
  const auto f = [](double t) { return 1 + 2 * t - 3 * t * t; };
  CouplingHistory history;
  for (const auto& [t, dt] : {std::pair{0.1, 0.1}, std::pair{0.5, 0.4}, std::pair{0.7, 0.2}})
    history.accepted({{f(t)}, {}}, dt, 2);
  EXPECT_NEAR(predict(forces, history, 0.3, 2).unknown[0], f(1.0), 1e-14);
  EXPECT_NEAR(predict(forces, history, 0.3, 1).unknown[0], f(0.7) + 0.3 * (f(0.7) - f(0.5)) / 0.2, 1e-14);
  EXPECT_DOUBLE_EQ(predict(forces, history, 0.3, 0).unknown[0], f(0.7));
}

/// A step with so many renewals: whether the scheme has changed.
bool step(SchemeChoice& choice, int renewals) {
  choice.start_step();
  for (int i = 0; i < renewals; ++i) choice.count_renewal();
  return choice.accepted(1);
}

TEST(SchemeChoice, becomes_implicit_after_as_many_renewed_steps_in_a_row_as_it_says_and_once) {
  SchemeChoice choice{{}};
  for (int n = 1; n < SchemeChoice::most_in_a_row; ++n) EXPECT_FALSE(step(choice, SchemeChoice::too_many));
  EXPECT_EQ(choice.now(), Scheme::semi_implicit);
  EXPECT_TRUE(step(choice, SchemeChoice::too_many));
  EXPECT_EQ(choice.now(), Scheme::implicit);
  EXPECT_FALSE(step(choice, 0));
  EXPECT_EQ(choice.now(), Scheme::implicit);
}

TEST(SchemeChoice, stays_where_steps_with_few_renewals_lie_between) {
  SchemeChoice choice{{}};
  for (int n = 0; n < 20; ++n)
    EXPECT_FALSE(step(
        choice, n % SchemeChoice::most_in_a_row == 0 ? SchemeChoice::too_many - 1 : SchemeChoice::too_many));
  EXPECT_EQ(choice.now(), Scheme::semi_implicit);
}

TEST(SchemeChoice, becomes_implicit_where_half_of_the_steps_are_renewed_and_not_where_a_third_is) {
  SchemeChoice often{{}}, seldom{{}};
  int change = 0;
  for (int n = 1; n <= 400; ++n) {
    if (step(often, n % 2)) change = n;
    EXPECT_FALSE(step(seldom, n % 3 == 0 ? 2 : 0));
  }
  EXPECT_GT(change, 60);
  EXPECT_LT(change, 120);
  EXPECT_EQ(often.now(), Scheme::implicit);
}

TEST(SchemeChoice, a_scheme_that_was_asked_for_stays) {
  for (const Scheme asked : {Scheme::explicit_, Scheme::semi_implicit, Scheme::implicit}) {
    SchemeChoice choice{asked};
    for (int n = 0; n < 20; ++n) EXPECT_FALSE(step(choice, 9));
    EXPECT_FALSE(choice.failed());
    EXPECT_EQ(choice.now(), asked);
  }
}

TEST(SchemeChoice, a_failed_step_is_tried_once_as_an_implicit_one_until_withdrawn) {
  SchemeChoice choice{{}};
  EXPECT_TRUE(choice.failed());
  EXPECT_EQ(choice.now(), Scheme::implicit);
  EXPECT_FALSE(choice.failed());
  choice.withdraw();
  EXPECT_EQ(choice.now(), Scheme::semi_implicit);
  EXPECT_TRUE(choice.failed());
}

TEST(SchemeChoice, a_step_after_a_failed_one_is_semi_implicit_again_until_three_in_a_row_have_failed) {
  SchemeChoice choice{{}};
  const auto fails = [&] {
    choice.start_step();
    EXPECT_TRUE(choice.failed());
    return choice.accepted(1);
  };
  for (int n = 0; n < 2; ++n) {
    EXPECT_TRUE(fails()) << "what was learnt is of another scheme";
    EXPECT_TRUE(fails());
    EXPECT_FALSE(step(choice, 0));
    EXPECT_EQ(choice.now(), Scheme::semi_implicit);
  }
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(fails());
  EXPECT_EQ(choice.now(), Scheme::implicit);
  EXPECT_FALSE(choice.failed());
}

TEST(SchemeChoice, continues_from_a_checkpoint_with_its_count_or_its_change) {
  SchemeChoice choice{{}};
  step(choice, 4), step(choice, 4);
  SchemeChoice again{{}};
  again.restore(choice.state());
  for (int n = 3; n < SchemeChoice::most_in_a_row; ++n) EXPECT_FALSE(step(again, 4));
  EXPECT_TRUE(step(again, 4));
  SchemeChoice after{{}};
  after.restore(again.state());
  EXPECT_EQ(after.now(), Scheme::implicit);
  SchemeChoice fixed{Scheme::semi_implicit};
  fixed.restore(again.state());
  EXPECT_EQ(fixed.now(), Scheme::semi_implicit) << "the key of the run that continues decides";
}

TEST(Waiting, names_who_is_waited_for) {
  EXPECT_EQ(
      waiting_sentence({"fluid", "solid"}, {9, 1}, false),
      "waiting: the participants run one after another, and the others wait for 'fluid' during 90 % of the computing time");
  EXPECT_THAT(waiting_sentence({"fluid", "solid"}, {1, 9}, true),
              HasSubstr("run concurrently, and all wait for 'solid'"));
}

TEST(Waiting, is_silent_about_one_participant_and_short_runs) {
  EXPECT_EQ(waiting_sentence({"fluid"}, {100}, false), "");
  EXPECT_EQ(waiting_sentence({"fluid", "solid"}, {0.5, 0.1}, false), "");
}

}  // namespace couplet::unknown_test
