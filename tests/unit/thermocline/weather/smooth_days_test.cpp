// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/made_days.hpp"

#include "tests/support/test.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::thermocline::smooth_days_test {

constexpr double kwh = 3.6e6;  // [J]

SmoothDays granada() {
  SmoothDays d;
  d.latitude = 37.2;
  d.daily_sums.assign(12, 5 * kwh);
  d.daily_sums[5] = 8.222 * kwh;
  return d;
}
WeatherHours made(const SmoothDays& d) {
  return with_smooth_days(clear_sky_year({.latitude = d.latitude}), d);
}
double day_sum(const WeatherHours& w, int day) {
  return 3600 * std::accumulate(w.dni.begin() + 24 * day, w.dni.begin() + 24 * day + 24, 0.0);
}

TEST(SmoothDays, every_day_has_the_sum_of_its_month) {
  for (const double n : {1.2, 8.0})
    for (const double p : {0.25, 2.0}) {
      SmoothDays d = granada();
      d.n = {n}, d.p = {p};
      const WeatherHours year = made(d);
      for (int day = 0; day < 365; ++day)
        EXPECT_NEAR(day_sum(year, day), d.daily_sums[std::size_t(month_of_day(day))], 1e-9 * kwh);
    }
}

TEST(SmoothDays, the_day_is_as_long_as_astronomy_says) {
  const double degree = std::numbers::pi / 180;
  for (const double latitude : {37.2, -28.4, 0.0})
    for (const int day : {0, 80, 171, 354}) {
      const double delta = 23.45 * degree * std::sin(2 * std::numbers::pi * (285 + day) / 365);
      EXPECT_NEAR(day_length(latitude, day),
                  24 / std::numbers::pi * std::acos(-std::tan(latitude * degree) * std::tan(delta)), 1e-9);
    }
  EXPECT_NEAR(day_length(75, 171), 24, 1e-9);
  EXPECT_NEAR(day_length(75, 354), 0, 1e-9);
  SmoothDays d = granada();
  d.daily_sums.assign(12, 2 * kwh);
  d.length = {0.5};
  const WeatherHours year = made(d);
  const double half = day_length(37.2, 171) / 4;
  for (int h = 0; h < 24; ++h) EXPECT_EQ(year.dni[171 * 24 + h] > 0, h + 1 > 12 - half && h < 12 + half) << h;
}

TEST(SmoothDays, n_and_p_of_the_parabola_are_those_of_its_integral) {
  // n = 2, p = 1: the hour before noon has the mean A (1 - (2/T)^2/3), the day the sum A T 2/3.
  const SmoothDays d = granada();
  const WeatherHours year = made(d);
  const double length = day_length(37.2, 171), top = d.daily_sums[5] / 3600 / (length * 2 / 3);
  EXPECT_NEAR(year.dni[171 * 24 + 11], top * (1 - std::pow(2 / length, 2) / 3), 1e-3 * top);
  EXPECT_NEAR(year.dni[171 * 24 + 11], year.dni[171 * 24 + 12], 1e-9);
}

TEST(SmoothDays, what_cannot_be_is_said) {
  SmoothDays d = granada();
  std::string key;
  EXPECT_EQ(problem_of(d, key), "");
  d.daily_sums.pop_back();
  EXPECT_THAT(problem_of(d, key), testing::HasSubstr("has 11 values"));
  EXPECT_EQ(key, "daily-sums");
  d = granada();
  d.daily_sums[3] = 500 * kwh;
  EXPECT_THAT(problem_of(d, key), testing::HasSubstr("not a plausible daily sum"));
  d = granada();
  d.n = {1, 2};
  EXPECT_THAT(problem_of(d, key), testing::HasSubstr("has 2 values"));
  EXPECT_EQ(key, "form-n");
  d = granada();
  d.p = {0};
  EXPECT_THAT(problem_of(d, key), testing::HasSubstr("0 is out of range"));
  EXPECT_EQ(key, "form-p");
  d = granada();
  d.latitude = 80;
  EXPECT_THROW(made(d), Error);  // sun in polar night
  d = granada();
  d.length = {0.2};
  EXPECT_THROW(made(d), Error);  // more than outside the atmosphere
  d = granada();
  d.daily_sums.assign(12, 7);
  EXPECT_THAT(problem_of(d, key), testing::HasSubstr("write '7 kWh/m^2'"));
  EXPECT_EQ(key, "daily-sums");
  d = granada();
  d.length = {2.5};
  try {
    made(d);
    ADD_FAILURE() << "sun at midnight";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("it would shine at midnight"));
  }
}

}  // namespace couplet::thermocline::smooth_days_test
