// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/made_days.hpp"

#include "tests/support/test.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::thermocline::clear_sky_test {

// Duffie and Beckman, Solar Engineering of Thermal Processes, example 2.8.1: Madison (43 N, 270 m), 22
// August, 11:30 solar time: transmittance 0.62, beam normal irradiance 830 W/m^2.
TEST(ClearSky, gives_the_worked_example_of_duffie_and_beckman) {
  const ClearSky madison{.latitude = 43, .altitude = 270};
  const double irradiance = clear_sky_irradiance(madison, day_of_year("08-22"), 11.5);
  RecordProperty("irradiance", std::to_string(irradiance));
  EXPECT_NEAR(irradiance, 830, 5);
}

TEST(ClearSky, day_length_is_that_of_spherical_astronomy) {
  const ClearSky site{.latitude = 37.2};
  const double degree = std::numbers::pi / 180;
  for (const char* date : {"03-21", "06-21", "12-21"}) {
    const int day = day_of_year(date);
    const double declination = 23.45 * degree * std::sin(2 * std::numbers::pi * (285 + day) / 365);
    const double wanted = 24 / std::numbers::pi * std::acos(-std::tan(37.2 * degree) * std::tan(declination));
    int lit = 0;
    for (int i = 0; i < 24 * 600; ++i) lit += clear_sky_irradiance(site, day, (i + 0.5) / 600) > 0;
    EXPECT_NEAR(lit / 600., wanted, 0.01) << date;
  }
}

TEST(ClearSky, is_symmetric_about_noon_and_dark_at_night) {
  const ClearSky site{.latitude = -28.4, .altitude = 835};
  for (const double h : {0.5, 2., 4., 5.}) {
    EXPECT_NEAR(clear_sky_irradiance(site, 10, 12 - h), clear_sky_irradiance(site, 10, 12 + h), 1e-9);
    EXPECT_GT(clear_sky_irradiance(site, 10, 12 - h), 0);
  }
  EXPECT_EQ(clear_sky_irradiance(site, 10, 0), 0);
}

TEST(ClearSky, seasons_change_sides_with_the_hemisphere) {
  const auto day_sum = [](double latitude, const char* date) {
    double sum = 0;
    for (int h = 0; h < 240; ++h)
      sum += clear_sky_irradiance({.latitude = latitude}, day_of_year(date), h / 10. + 0.05) / 10;
    return sum;
  };
  EXPECT_GT(day_sum(40, "06-21"), 1.4 * day_sum(40, "12-21"));
  EXPECT_GT(day_sum(-40, "12-21"), 1.4 * day_sum(-40, "06-21"));
}

TEST(ClearSky, a_year_holds_what_it_was_told) {
  const ClearSky site{.latitude = 37, .altitude = 1100, .temperature = 294.15, .wind = 4};
  const WeatherHours year = clear_sky_year(site);
  EXPECT_EQ(year.days(), 365);
  EXPECT_NEAR(year.temperature[14] + year.temperature[15], 2 * 29, 0.2);
  EXPECT_NEAR(year.temperature[2] + year.temperature[3], 2 * 13, 0.2);
  EXPECT_EQ(year.wind[100], 4);
  EXPECT_NEAR(year.pressure[0], 88800, 200);  // US standard atmosphere at 1100 m: 88.75 kPa
}

}  // namespace couplet::thermocline::clear_sky_test
