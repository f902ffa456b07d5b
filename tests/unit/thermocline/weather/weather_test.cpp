// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather.hpp"

#include "tests/unit/thermocline/support.hpp"
#include "thermocline/weather/made_days.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::thermocline::weather_test {

/// Some days with values that differ everywhere.
WeatherHours invented(int first_day, int days) {
  WeatherHours record;
  record.first_day = first_day;
  record.state_offset = 1800;
  for (int h = 0; h < 24 * days; ++h) {
    const double x = h;
    record.dni.push_back(std::max(0., 900 * std::sin(x * 0.2618 - 1.6) + 80 * std::cos(3.1 * x)));
    record.temperature.push_back(15 + 0.1 * x + 5 * std::sin(x));
    record.wind.push_back(std::abs(std::sin(2 * x)));
    record.humidity.push_back(0.5);
    record.pressure.push_back(1e5 + x);
  }
  return record;
}

TEST(Weather, keeps_the_energy_of_every_hour) {
  const WeatherHours record = invented(0, 5);
  const Weather weather(record, {});
  for (std::size_t h = 0; h < record.dni.size(); ++h)
    EXPECT_NEAR(weather.irradiation(double(h) * hour, double(h + 1) * hour), record.dni[h] * hour, 1e-6);
  // The same from the values at single moments: the midpoint rule is exact for the lines in parts of an hour.
  for (std::size_t h = 0; h < record.dni.size(); ++h) {
    double sum = 0;
    for (int i = 0; i < 20; ++i) sum += weather.at((double(h) + (i + 0.5) / 20) * hour).dni / 20;
    EXPECT_NEAR(sum, record.dni[h], 1e-9);
  }
}

TEST(Weather, irradiance_stays_within_its_neighbours) {
  const WeatherHours record = invented(0, 3);
  const Weather weather(record, {});
  const std::size_t n = record.dni.size();
  int sloped = 0;
  for (std::size_t h = 0; h < n; ++h) {
    const double a = record.dni[(h + n - 1) % n], b = record.dni[h], c = record.dni[(h + 1) % n];
    for (const double x : {0.001, 0.3, 0.7, 0.999}) {
      const double value = weather.at((double(h) + x) * hour).dni;
      EXPECT_GE(value, std::min({a, b, c}) - 1e-9);
      EXPECT_LE(value, std::max({a, b, c}) + 1e-9);
      sloped += std::abs(value - b) > 1;
    }
  }
  EXPECT_GT(sloped, int(n)) << "hours were flat: the bounds prove nothing";
}

TEST(Weather, states_are_straight_lines_between_mid_hours) {
  const WeatherHours record = invented(0, 2);
  const Weather weather(record, {});
  EXPECT_NEAR(weather.at(7.5 * hour).temperature, 273.15 + record.temperature[7], 1e-9);
  EXPECT_NEAR(weather.at(7.75 * hour).temperature,
              273.15 + 0.75 * record.temperature[7] + 0.25 * record.temperature[8], 1e-9);
  // The last hour and the first are neighbours.
  EXPECT_NEAR(weather.at(0).wind, (record.wind.front() + record.wind.back()) / 2, 1e-12);
}

TEST(Weather, a_slice_begins_at_its_day_and_repeats) {
  const WeatherHours record = invented(100, 10);
  const Weather weather(record, {103, 105});
  EXPECT_EQ(weather.period_length(), 3 * day);
  EXPECT_NEAR(weather.irradiation(0, hour), record.dni[3 * 24] * hour, 1e-6);
  EXPECT_NEAR(weather.irradiation(3 * day + 9 * hour, 3 * day + 10 * hour), record.dni[3 * 24 + 9] * hour,
              1e-6);
  EXPECT_NEAR(
      weather.irradiation(-hour, 7 * day),
      weather.irradiation(-hour, 0) + 2 * weather.irradiation(0, 3 * day) + weather.irradiation(0, day),
      1e-5);
  EXPECT_EQ(weather.date(0), date_of_day(103));
  EXPECT_EQ(weather.date(2.5 * day), date_of_day(105));
  EXPECT_EQ(weather.date(3.5 * day), date_of_day(103));
}

TEST(Weather, a_winter_goes_over_the_new_year) {
  const WeatherHours record = invented(0, 365);
  const Weather weather(record, {day_of_year("11-01"), day_of_year("02-28")});
  EXPECT_EQ(weather.period_length(), (30 + 31 + 31 + 28) * day);
  EXPECT_NEAR(weather.irradiation(61 * day + 5 * hour, 61 * day + 6 * hour), record.dni[5] * hour, 1e-5);
  EXPECT_EQ(weather.date(61 * day), "01-01");
}

TEST(Weather, a_day_that_the_record_lacks_is_refused) {
  const auto complaint = [](const WeatherPeriod& period) {
    return support::error_of([&] { Weather(invented(100, 10), period); });
  };
  const char* holds = "; it covers 04-11 to 04-20";
  EXPECT_THAT(complaint({98, 105}),
              testing::HasSubstr(std::string("this file has no weather for 04-09") + holds));
  EXPECT_THAT(complaint({105, 112}),
              testing::HasSubstr(std::string("this file has no weather for 04-21") + holds));
  EXPECT_THAT(complaint({0, {}}),
              testing::HasSubstr(std::string("this file has no weather for 01-01") + holds));
  EXPECT_THAT(complaint({300, {}}),
              testing::HasSubstr(std::string("this file has no weather for 10-28") + holds));
}

TEST(WeatherDate, days_and_dates_are_inverse) {
  for (int d = 0; d < 365; ++d) EXPECT_EQ(day_of_year(date_of_day(d)), d);
  EXPECT_EQ(day_of_year("01-01"), 0);
  EXPECT_EQ(day_of_year("06-01"), 151);
  EXPECT_EQ(day_of_year("12-31"), 364);
  for (const char* wrong : {"13-01", "00-10", "02-29", "06-31", "6-1", "June", "06/01", ""})
    EXPECT_THROW(day_of_year(wrong), Error) << wrong;
}

struct Season {
  const char *name, *file, *from, *to;
  double area, efficiency;  // of the solar field
  double published;         // MWh/day, tables 5.5 and 5.6 of the thesis
};

class SolarField : public testing::TestWithParam<Season> {};

// The eight different entries of Q_SF in tables 5.5 and 5.6: field area, efficiency and the irradiation of
// the shipped year give each to rounding.
TEST_P(SolarField, collects_what_tables_5_5_and_5_6_say) {
  const Season& s = GetParam();
  WeatherParameters parameters;
  parameters.kind = WeatherKind::file;
  parameters.file = std::string(s.file) + ".csv.gz";
  parameters.from = s.from;
  parameters.to = s.to;
  const auto weather = make_weather(parameters, WEATHER_FOLDER);
  EXPECT_TRUE(weather->warnings().empty());
  const double length = weather->period_length();
  const double heat = weather->irradiation(0, length) * s.area * s.efficiency / (length / day) / 3.6e9;
  RecordProperty("field_heat", std::to_string(heat));
  RecordProperty("published", std::to_string(s.published));
  EXPECT_NEAR(heat, s.published, 0.5);
}

constexpr double area_a = 510120, area_g = 306658;
INSTANTIATE_TEST_SUITE_P(
    Thesis, SolarField,
    testing::Values(Season{"A_summer", "granada_aldeire_surrogate", "06-01", "08-31", area_a, 0.70, 2936},
                    Season{"A_winter", "granada_aldeire_surrogate", "12-01", "02-28", area_a, 0.70, 1335},
                    Season{"A_L1", "upington_surrogate", "06-01", "08-31", area_a, 0.70, 2382},
                    Season{"A_L2", "upington_surrogate", "12-01", "02-28", area_a, 0.70, 3019},
                    Season{"G_summer", "sevilla_table52_scaled", "06-01", "08-31", area_g, 0.42, 938},
                    Season{"G_winter", "sevilla_table52_scaled", "12-01", "02-28", area_g, 0.42, 534},
                    Season{"G_L1", "upington_surrogate", "06-01", "08-31", area_g, 0.42, 859},
                    Season{"G_L2", "upington_surrogate", "12-01", "02-28", area_g, 0.42, 1089}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Weather, sun_at_night_is_doubted_without_a_site) {
  const auto doubts = [](int first, int hours) {
    WeatherHours record;
    for (int d = 0; d < 10; ++d)
      for (int h = 0; h < 24; ++h) record.dni.push_back((h - first + 24) % 24 < hours ? 800 : 0);
    return check_sun(record).size();
  };
  EXPECT_EQ(doubts(6, 12), 0u);
  EXPECT_EQ(doubts(4, 17), 0u) << "a summer far in the north";
  EXPECT_EQ(doubts(11, 10), 0u) << "the clock of Greenwich in the west of Brazil";
  EXPECT_EQ(doubts(0, 24), 1u);
  EXPECT_EQ(doubts(2, 20), 1u);
  EXPECT_EQ(doubts(21, 12), 1u) << "the clock of Greenwich in Japan";
  EXPECT_EQ(doubts(0, 0), 0u);
}

}  // namespace couplet::thermocline::weather_test
