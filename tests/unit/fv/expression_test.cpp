// SPDX-License-Identifier: Apache-2.0
#include "common/fv/expression.hpp"
#include "tests/support/test.hpp"

namespace couplet::expression_test {
using namespace fv;

std::string message_of(const std::string& text) {
  return support::error_of([&] { Expression expression(config::ExpressionText{text}, "traction.value[1]"); });
}

TEST(Expression, takes_space_and_time) {
  const Expression f(config::ExpressionText{"2*sin(pi*x)*y + z^2 - (t < 7 ? t/7 : 0)"});
  const Vec3 x(0.3, 2, -1.5);
  EXPECT_NEAR(f(x, 3.5), 2 * std::sin(M_PI * 0.3) * 2 + 2.25 - 0.5, 1e-14);
  EXPECT_NEAR(f(x, 8), 2 * std::sin(M_PI * 0.3) * 2 + 2.25, 1e-14);
  EXPECT_TRUE(f.uses_time());
  EXPECT_TRUE(f.uses_space());
}

TEST(Expression, knows_when_it_is_constant_or_zero) {
  EXPECT_TRUE(Expression().is_zero());
  EXPECT_TRUE(Expression(config::ExpressionText{"1 - 1"}).is_zero());
  EXPECT_FALSE(Expression(config::ExpressionText{"x - x"}).is_zero());
  const Expression constant(config::ExpressionText{"5e3"});
  EXPECT_FALSE(constant.uses_time() || constant.uses_space());
  EXPECT_EQ(constant(Vec3(1, 2, 3), 4), 5e3);
  EXPECT_EQ(Expression(2.5)(Vec3(1, 2, 3), 4), 2.5);
}

TEST(Expression, fills_one_component_of_packed_vectors) {
  const Expression f(config::ExpressionText{"x + 10*y"});
  const std::vector<Vec3> points{{1, 2, 0}, {3, 4, 0}};
  std::vector<double> values(4, -1);
  f.evaluate(points, 0, values, 2, 1);
  EXPECT_THAT(values, ::testing::ElementsAre(-1, 21, -1, 43));
}

TEST(Expression, survives_being_moved) {
  Expression f(config::ExpressionText{"x*t"});
  std::vector<Expression> many;
  for (int i = 0; i < 20; ++i) many.emplace_back(config::ExpressionText{"x*t + " + std::to_string(i)});
  const Expression g = std::move(f);
  EXPECT_EQ(g(Vec3(2, 0, 0), 3), 6);
  EXPECT_EQ(many[17](Vec3(2, 0, 0), 3), 23);
}

TEST(Expression, names_key_column_and_known_variables_of_an_error) {
  EXPECT_THAT(
      message_of("2*sin(q)"),
      ::testing::AllOf(::testing::StartsWith("traction.value[1]: cannot parse the expression '2*sin(q)'"),
                       ::testing::HasSubstr("column 7: unknown name 'q'"),
                       ::testing::HasSubstr("variables x, y, z [m] and t [s]")));
  EXPECT_THAT(message_of("2*(x + 1"), ::testing::HasSubstr("column 9: a ')' is missing"));
  EXPECT_THAT(message_of("x + + * 2"), ::testing::HasSubstr("at column"));
  EXPECT_THAT(message_of(""), ::testing::HasSubstr("cannot parse"));
}

TEST(Expression, refuses_what_would_be_read_in_another_way) {
  for (const char* text : {"1,5*x", "1,000,000", "(0,5)*x", "t < 1 ? 1,5 : 0", "sin(x) + 2,5", "2*(1,5 + x)"})
    EXPECT_THAT(message_of(text), ::testing::HasSubstr("write a decimal point")) << text;
  for (const char* text : {"y = 0.1", "x = 0 && y > 1", "t = 2 ? 1 : 0", "max(x = 1, 2)"})
    EXPECT_THAT(message_of(text), ::testing::HasSubstr("'=' is not a comparison")) << text;
  for (const char* text :
       {"0.05 < y < 0.1", "0 <= x <= 1 ? 1 : 0", "x == y == z", "t > 1 && 0 < y < 1", "max(0 < x < 1, 2)"})
    EXPECT_THAT(message_of(text), ::testing::HasSubstr("comparisons cannot be chained")) << text;
  for (const char* text : {"0 < x && x < 1 || y >= 2", "x < 1 ? y < 2 : z != 3", "max(x < 1, y < 2)",
                           "(x < 1) == (y < 2)", "atan2(y, max(x, 1))", "x <= 1"})
    EXPECT_EQ(problem_of(config::ExpressionText{text}), "") << text;
}

TEST(Expression, refuses_values_outside_the_range_of_its_key) {
  const auto value = [](const char* text, const config::KeyFacts& key, double t) {
    return support::error_of([&] {
      Expression(config::ExpressionText{text, key}, "coefficient")(Vec3::Zero(), t);
    });
  };
  const config::KeyFacts film{.unit = "W/(m^2 K)", .lowest = 0}, kelvin{.unit = "K", .lowest = 0},
      ratio{.highest = 0.5};
  EXPECT_THAT(value("10 - t", film, 5), ::testing::Not(::testing::HasSubstr("it must be")));
  EXPECT_THAT(value("10 - t", film, 20),
              ::testing::HasSubstr(
                  "yields -10 W/(m^2 K) at x = 0, y = 0, z = 0, t = 20; it must be at least 0 W/(m^2 K)"));
  EXPECT_THAT(value("table(t, 0, 300, 1, -20)", kelvin, 1), ::testing::HasSubstr("it must be at least 0 K"));
  EXPECT_THAT(value("0.3 + 0.4", ratio, 0), ::testing::HasSubstr("it must be at most 0.5"));
}

TEST(Expression, refuses_values_that_are_not_finite) {
  const Expression f(config::ExpressionText{"1/x"}, "value");
  EXPECT_EQ(f(Vec3(2, 0, 0), 0), 0.5);
  EXPECT_THROW(f(Vec3(0, 0, 0), 0), Error);
  EXPECT_THAT(message_of("1/0"), ::testing::HasSubstr("it must be finite"));
}

TEST(Expression, needs_one_component_a_dimension) {
  EXPECT_EQ(make_expressions({{"0"}, {"x"}}, 2, "value").size(), 2u);
  EXPECT_THROW(make_expressions({{"0"}, {"x"}}, 3, "value"), Error);
}

}  // namespace couplet::expression_test
