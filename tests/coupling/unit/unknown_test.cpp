// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/unknown.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace couplet::unknown_test {
using namespace coupling;
using namespace coupler;
namespace {

using Place = Interface::Place;

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
  EXPECT_FALSE(p.serial.parts()[0].rides);
  EXPECT_TRUE(p.serial.parts()[1].rides) << "the velocity goes with the displacement";
  EXPECT_EQ(p.parallel.parts().size(), 3u);
  const Unknown other_order(MPI_COMM_SELF, p.sides, p.links, {1, 0}, false);
  ASSERT_EQ(other_order.parts().size(), 1u);
  EXPECT_EQ(other_order.parts()[0].datum.name, "force");
}

TEST(Unknown, several_data_are_scaled_to_like_size_and_come_back_as_they_were) {
  Pair p;
  const std::vector<Exchange> given{{{"force", {1e6}}}, {{"displacement", {1e-4}}, {"velocity", {0.1}}}};
  EXPECT_TRUE(p.serial.scaled());
  EXPECT_FALSE(p.parallel.scaled());
  p.parallel.scale(given);
  const Iterate x = p.parallel.gather(given);
  ASSERT_EQ(x.unknown.size(), 2u);
  for (const double v : x.unknown) EXPECT_DOUBLE_EQ(v, 1);
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

TEST(Unknown, rest_is_a_start_for_motion_alone) {
  const Pair p;
  std::vector<Exchange> given(2);
  EXPECT_TRUE(p.serial.start_at_rest(given));
  EXPECT_EQ(given[1].at("velocity"), std::vector<double>{0});
  EXPECT_FALSE(p.parallel.start_at_rest(given)) << "a force has no natural start";
}

/// Motion with velocity v(t) = 2 + 3 t and displacement 2 t + 1.5 t^2, known at t = 1 and, with a step of
/// 0.4, before.
History accelerated_motion() { return {{{3.5}, {5.}}, {{0.}, {2 + 3 * 0.6}}, {}, 0.4, 0}; }

TEST(Predictor, order_0_repeats_the_last_state) {
  const Pair p;
  const Iterate guess = predict(p.serial, accelerated_motion(), 0.2, 0);
  EXPECT_EQ(guess.unknown[0], 3.5);
  EXPECT_EQ(guess.rider[0], 5);
}

TEST(Predictor, order_1_goes_on_with_the_last_velocity) {
  const Pair p;
  const Iterate guess = predict(p.serial, accelerated_motion(), 0.2, 1);
  EXPECT_DOUBLE_EQ(guess.unknown[0], 3.5 + 0.2 * 5);
  EXPECT_EQ(guess.rider[0], 5);
}

TEST(Predictor, order_2_is_exact_for_constant_acceleration_also_when_the_step_changes) {
  const Pair p;
  for (const double dt : {0.1, 0.4, 1.}) {
    const Iterate guess = predict(p.serial, accelerated_motion(), dt, 2);
    const double t = 1 + dt;
    EXPECT_NEAR(guess.unknown[0], 2 * t + 1.5 * t * t, 1e-14) << dt;
    EXPECT_NEAR(guess.rider[0], 2 + 3 * t, 1e-14) << dt;
  }
}

TEST(Predictor, first_step_of_order_2_is_of_order_1) {
  const Pair p;
  History history = accelerated_motion();
  history.old = {};
  history.old_dt = 0;
  const Iterate guess = predict(p.serial, history, 0.2, 2);
  EXPECT_DOUBLE_EQ(guess.unknown[0], 4.5);
  EXPECT_EQ(guess.rider[0], 5);
}

TEST(Predictor, data_without_velocity_follow_the_polynomial_through_their_last_values) {
  const Pair p;
  const Unknown forces(MPI_COMM_SELF, p.sides, p.links, {1, 0}, false);
  const auto f = [](double t) { return 1 + 2 * t - 3 * t * t; };
  History history;
  for (const auto& [t, dt] : {std::pair{0.1, 0.1}, std::pair{0.5, 0.4}, std::pair{0.7, 0.2}})
    history.accepted({{f(t)}, {}}, dt, 2);
  EXPECT_NEAR(predict(forces, history, 0.3, 2).unknown[0], f(1.0), 1e-14);
  EXPECT_NEAR(predict(forces, history, 0.3, 1).unknown[0], f(0.7) + 0.3 * (f(0.7) - f(0.5)) / 0.2, 1e-14);
  EXPECT_DOUBLE_EQ(predict(forces, history, 0.3, 0).unknown[0], f(0.7));
}

}  // namespace
}  // namespace couplet::unknown_test
