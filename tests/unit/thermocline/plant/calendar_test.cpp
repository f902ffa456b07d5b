// SPDX-License-Identifier: Apache-2.0
// Load and tariff by weekday and season.
#include "thermocline/plant/plant.hpp"

#include "tests/unit/thermocline/support.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::thermocline::calendar_test {
using testing::HasSubstr;

/// Weekends ask for a fifth; summer evenings earn more, summer weekends less.
PlantParameters working_week() {
  PlantParameters p{40e6, 0.4, 1e5, 0.5, 673.15, 573.15, 15, 10};
  p.tariff = {50};
  std::vector<double> evening(24, 60);
  evening[19] = 140;
  p.calendar = {{{"weekend"}, "06-01", "08-31", {}, {30}},
                {{}, "06-01", "08-31", {}, evening},
                {{"saturday", "sunday"}, "", "", {0.2}, {}},
                {{}, "12-20", "01-10", {0.5}, {}}};
  p.start.weekday = "thursday";
  p.start.day = day_of_year("05-30");
  return p;
}

TEST(Calendar, weekdays_and_seasons_decide_the_first_rule_that_gives_a_value_counts) {
  const Plant plant(working_week(), 1500);
  // 30 May is the thursday of t = 0; 1 June is a saturday.
  EXPECT_EQ(plant.load(0), 1);
  EXPECT_EQ(plant.tariff(19.5 * hour), 50) << "no season yet";
  EXPECT_EQ(plant.load(2 * day - 1e-9), 0.2) << "rounding of a step's end";
  EXPECT_EQ(plant.load(2 * day - 1), 1) << "the last second of friday";
  EXPECT_EQ(plant.tariff(2 * day + 19.5 * hour), 30) << "the first rule covers the second";
  EXPECT_EQ(plant.tariff(4 * day + 19.5 * hour), 140) << "a monday of June";
  EXPECT_EQ(plant.tariff(4 * day + 20.5 * hour), 60);
  const double september = (day_of_year("09-01") - day_of_year("05-30")) * day;
  EXPECT_EQ(plant.tariff(september - hour), 30) << "31 August, a saturday";
  EXPECT_EQ(plant.tariff(september), 50);
  EXPECT_EQ(plant.load_until(17.2 * hour), 18 * hour);
}

TEST(Calendar, a_season_may_cross_the_year_and_the_weather_may_go_round) {
  PlantParameters p = working_week();
  const double new_year = (365 - day_of_year("05-30")) * day;
  EXPECT_EQ(Plant(p, 1500).load(new_year + 9 * day), 0.5) << "10 January, a friday";
  EXPECT_EQ(Plant(p, 1500).load(new_year + 12 * day), 1) << "13 January, a monday";
  p.start.period = 2;  // 30 and 31 May for ever: no summer
  EXPECT_EQ(Plant(p, 1500).tariff(40 * day), 50);
  EXPECT_EQ(Plant(p, 1500).load(9 * day), 0.2) << "but weeks go on: a saturday";
  EXPECT_EQ(Plant(p, 1500).load(11 * day), 1);
}

TEST(Calendar, rules_that_never_hold_are_said) {
  PlantParameters p = working_week();
  EXPECT_TRUE(Calendar(p.calendar, p.start).doubts().empty());
  p.calendar.insert(p.calendar.begin(), {{}, "", "", {}, {10}});
  const auto covered = Calendar(p.calendar, p.start).doubts();
  ASSERT_EQ(covered.size(), 2u);
  EXPECT_THAT(covered[0], HasSubstr("flow.calendar[1] applies on no day"));
  p = working_week();
  p.start.period = 30;  // to 28 June: winter never comes
  ASSERT_EQ(Calendar(p.calendar, p.start).doubts().size(), 1u);
  EXPECT_THAT(Calendar(p.calendar, p.start).doubts()[0], HasSubstr("flow.calendar[3]"));
}

TEST(Calendar, without_rules_the_plant_is_as_before) {
  PlantParameters p{40e6, 0.4, 1e5, 0.5, 673.15, 573.15, 15, 10};
  EXPECT_TRUE(std::isinf(Plant(p, 1500).load_until(5)));
  EXPECT_EQ(Calendar({}, {}).load(1e6), nullptr);
}

}  // namespace couplet::thermocline::calendar_test
