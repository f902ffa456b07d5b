// SPDX-License-Identifier: Apache-2.0
// Quantities as contracts: usual magnitudes, temperatures and their differences, numbers that need a unit.
#include "common/config/values.hpp"
#include "tests/unit/config/fixture.hpp"

namespace couplet::quantities_test {
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Quantities {
  double temperature = 290, difference = 10, angle = 0, speed = 0, rate = 0, density = 1000, modulus = 1e9;
  Vec3 gravity = Vec3::Zero();
  std::vector<double> lengths;
  config::ExpressionText load, hot;
  std::vector<config::ExpressionText> traction;
};

void declare(config::Section& s, Quantities& q) {
  s.value("temperature", q.temperature).unit("K", 70, 5000);
  s.value("difference", q.difference).unit("K difference", 0.1, 500);
  s.value("angle", q.angle).unit("rad").any_magnitude("it turns for ever");
  s.value("speed", q.speed).unit("rad/s");
  s.value("rate", q.rate).unit("1/s");
  s.value("density", q.density).unit("kg/m^3", 1, 25000).positive();
  s.value("modulus", q.modulus).unit("Pa", 1e3, 2e12).positive();
  s.value("gravity", q.gravity).unit("m/s^2", 1e-3, 2000);
  s.value("lengths", q.lengths).unit("m", 1e-3, 10);
  s.value("load", q.load).unit("Pa", 1, 1e9);
  s.value("hot", q.hot).unit("K", 70, 5000);
  s.value("traction", q.traction).unit("Pa", 1, 1e9);
  s.doubt([&q] { return config::check_wave_speed(q.modulus, q.density); }, "density");
}

struct Judged {
  std::vector<std::string> errors, doubts;
  Quantities values;
};

Judged judge(const std::string& text) {
  Judged j;
  j.errors = config::load(
      config::Document::parse(text, "case.yaml"), "", [&](config::Section& s) { declare(s, j.values); }, {},
      &j.doubts);
  return j;
}

TEST(Quantities, bare_temperatures_and_angles_are_refused_in_every_form) {
  for (const std::string text : {"temperature: 20", "hot: 20", "hot: {of: t, at: [0, 1], values: [20, 30]}",
                                 "load: {of: T, at: [300, 400], values: [1, 2]}"})
    EXPECT_THAT(judge(text).errors, ElementsAre(HasSubstr("has no unit, but one is required: write")))
        << text;
  EXPECT_THAT(
      judge("temperature: 20").errors,
      ElementsAre(
          "case.yaml:1:1: temperature: '20' has no unit, but one is required: write 20 degC or 20 K."));
  EXPECT_THAT(judge("angle: 30").errors, ElementsAre(HasSubstr("write 30 deg or 30 rad.")));
  EXPECT_THAT(judge("speed: 30").errors, ElementsAre(HasSubstr("write 30 deg/s or 30 rad/s.")));
}

TEST(Quantities, with_a_unit_or_where_zero_is_zero_in_both_they_are_taken) {
  const Judged j = judge("{temperature: 20 degC, angle: 180 deg, speed: 0, hot: 300 + 10*t}");
  EXPECT_THAT(j.errors, IsEmpty());
  EXPECT_DOUBLE_EQ(j.values.temperature, 293.15);
  EXPECT_NEAR(j.values.angle, 3.14159265358979, 1e-14);
}

TEST(Quantities, a_temperature_is_no_difference_and_a_difference_no_temperature) {
  EXPECT_THAT(judge("difference: 10 degC").errors, ElementsAre(HasSubstr("write 10 K")));
  EXPECT_THAT(judge("temperature: 10 K difference").errors,
              ElementsAre(HasSubstr("a temperature difference, but")));
  for (const std::string text : {"difference: 10 K", "difference: 10", "difference: 10 K difference"}) {
    const Judged j = judge(text);
    EXPECT_THAT(j.errors, IsEmpty()) << text;
    EXPECT_EQ(j.values.difference, 10) << text;
  }
}

TEST(Quantities, nothing_is_colder_than_absolute_zero) {
  EXPECT_THAT(judge("temperature: -300 degC").errors,
              ElementsAre(HasSubstr("is -26.85 K, below absolute zero.")));
  EXPECT_THAT(judge("hot: -1 K").errors, ElementsAre(HasSubstr("below absolute zero.")));
  EXPECT_THAT(judge("hot: {of: t, at: [0, 1], values: [20 degC, -300 degC]}").errors,
              ElementsAre(HasSubstr("below absolute zero.")));
  EXPECT_THAT(judge("temperature: -273.15 degC").errors, IsEmpty());
}

TEST(Quantities, a_frequency_is_no_speed_of_rotation) {
  for (const std::string text :
       {"speed: 10 Hz", "speed: 60 1/min", "speed: 2 1/s", "speed: 50 %", "angle: 50 %"})
    EXPECT_THAT(judge(text).errors, ElementsAre(HasSubstr("(a turn is 6.2832 rad or 360 deg)"))) << text;
  EXPECT_THAT(judge("rate: 3 rad/s").errors, ElementsAre(HasSubstr("'rad/s' is not convertible to 1/s")));
  EXPECT_NEAR(judge("speed: 60 deg/s").values.speed, 1.0471975511966, 1e-12);
}

TEST(Quantities, what_is_unusual_is_flagged_with_its_place_and_stays_valid) {
  const Judged j = judge("density: 7.85e-9\nmodulus: 1e-9");
  EXPECT_THAT(j.errors, IsEmpty());
  EXPECT_THAT(
      j.doubts,
      ElementsAre(
          "case.yaml:1:1: density: 7.85e-09 kg/m^3 (usual: 1 to 25000 kg/m^3): implausible; check the "
          "number and its unit.",
          HasSubstr("case.yaml:2:1: modulus: 1e-09 Pa")));
}

TEST(Quantities, ends_of_the_range_and_zero_are_usual_one_beyond_is_not) {
  for (const std::string text :
       {"temperature: 70 K", "temperature: 5000 K", "gravity: [0, 0, 0]", "gravity: [0, -2000, 1e-20]"})
    EXPECT_THAT(judge(text).doubts, IsEmpty()) << text;
  for (const std::string text :
       {"temperature: 69 K", "temperature: 5001 K", "gravity: [0, -9810]", "gravity: [1e-4, 0]"})
    EXPECT_THAT(judge(text).doubts, testing::SizeIs(1)) << text;
}

TEST(Quantities, lists_tables_and_vectors_of_expressions_are_judged_expressions_are_not) {
  EXPECT_THAT(judge("lengths: [1, 2, 3000]").doubts, ElementsAre(HasSubstr("3000 m (usual: 0.001 to 10 m)")));
  EXPECT_THAT(judge("load: {of: t, at: [0, 1], values: [0, 3e12]}").doubts,
              ElementsAre(HasSubstr("3e+12 Pa")));
  EXPECT_THAT(judge("load: {of: t, at: [1e12, 2e12], values: [0, 3]}").doubts, IsEmpty());
  EXPECT_THAT(judge("load: 'table(t, 1e12, 0, 2e12, 3)'").doubts, IsEmpty());
  EXPECT_THAT(judge("load: 'table(t, error, 1e12, 0, 2e12, 3)'").doubts, IsEmpty());
  EXPECT_THAT(judge("load: 'table(t, 1, 0, 2, 3e12)'").doubts, ElementsAre(HasSubstr("3e+12 Pa")));
  EXPECT_THAT(judge("load: 'table(max(t, 1e12), 1, 0, 2, 3)'").doubts, IsEmpty());
  EXPECT_THAT(judge("traction: [1e12, 0]").doubts, ElementsAre(HasSubstr("1e+12 Pa")));
  EXPECT_THAT(judge("traction: [1e3, 1e-9]").doubts, IsEmpty());
  EXPECT_THAT(judge("load: 1e12*sin(t)").doubts, IsEmpty());
}

TEST(Quantities, pairs_are_judged_where_each_alone_is_usual_and_nothing_is_wrong) {
  EXPECT_THAT(
      judge("density: 7.85\nmodulus: 210 GPa").doubts,
      ElementsAre(HasSubstr("density: waves would travel at 1.64e+05 m/s (usual: 0.2 to 20000 m/s)")));
  EXPECT_THAT(judge("density: 7850\nmodulus: 210 GPa").doubts, IsEmpty());
  EXPECT_THAT(config::check_wave_speed(210, 7850), HasSubstr("0.164 m/s"));
  EXPECT_EQ(config::check_wave_speed(100, 1000), "");  // a gel
  EXPECT_THAT(judge("density: 7.85\nmodulus: 210 kg").doubts, IsEmpty());
}

TEST(Quantities, kinematic_viscosity_in_place_of_the_dynamic_one_is_found) {
  EXPECT_THAT(config::check_kinematic_viscosity(1e-6, 1000), HasSubstr("would be 0.001 Pa s"));
  EXPECT_EQ(config::check_kinematic_viscosity(1e-3, 1000), "");
  EXPECT_EQ(config::check_kinematic_viscosity(1.5e-3, 13500), "");  // mercury
  EXPECT_EQ(config::check_kinematic_viscosity(0, 1000), "");        // no friction at all
}

TEST(Quantities, the_reference_and_the_schema_show_the_contract) {
  Quantities q;
  const auto declaration = [&](config::Section& s) { declare(s, q); };
  const std::string markdown = config::markdown("it", declaration),
                    schema = config::json_schema("it", declaration);
  EXPECT_THAT(markdown, HasSubstr("above 0 kg/m^3; usual: 1 to 25000 kg/m^3"));
  EXPECT_THAT(markdown, HasSubstr("any magnitude: it turns for ever"));
  EXPECT_THAT(schema, HasSubstr("\"x-unit\": \"K difference\""));
  EXPECT_THAT(schema, HasSubstr("\"x-usual\": "));
}

TEST(Quantities, values_in_force_are_written_so_that_they_can_be_read_again) {
  Quantities q;
  q.temperature = 300, q.angle = 0.5, q.hot.text = "310";
  const std::string text = config::effective([&](config::Section& s) { declare(s, q); });
  const Judged again = judge(text);
  EXPECT_THAT(again.errors, IsEmpty()) << text;
  EXPECT_EQ(again.values.temperature, 300);
  EXPECT_EQ(again.values.angle, 0.5);
  EXPECT_EQ(again.values.hot.text, "310");
}

}  // namespace couplet::quantities_test
