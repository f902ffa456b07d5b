// SPDX-License-Identifier: Apache-2.0
// What the report says of a year that is none, and its time series.
#include "tests/unit/thermocline/support.hpp"
#include "thermocline/plant/report.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline::year_test {

/// Steps of a tank at rest at 300 degC.
void stand(DayReport& report, int steps, double dt) {
  const std::array<double, 2> z{0.5, 1.5}, dz{1, 1}, temperature{573.15, 573.15};
  for (int i = 0; i < steps; ++i) {
    BedStep step;
    step.t = i * dt, step.dt = dt;
    TankRecord record;
    record.time = step.t + dt, record.dt = dt;
    record.steps = {&step, 1};
    record.z = z, record.dz = dz, record.fluid_temperature = temperature;
    report.record(record);
  }
}

/// plant.csv of one hour with a third of the load.
TEST(DayReport, the_series_has_what_the_block_got_and_what_it_asked_for) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("couplet-series-{}", getpid());
  std::filesystem::create_directories(folder);
  WeatherParameters sunny;
  sunny.constant.dni = 500, sunny.constant.wind = 3;
  const auto weather = make_weather(sunny, ".");
  PlantParameters p{40e6, 0.4, 1e5, 0.5, 673.15, 573.15, 15, 10};
  p.load.assign(24, 0.6), p.load[0] = 0;
  std::vector<std::string> rows;
  {
    DayReport report({}, Plant(p, salt), *weather, folder);
    stand(report, 2, 3600);
  }
  std::ifstream file(folder / "plant.csv");
  for (std::string line; std::getline(file, line);) rows.push_back(line);
  std::filesystem::remove_all(folder);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].find("time [s],solar field [W],power block [W],demand [W],"), 0u) << rows[0];
  EXPECT_NE(rows[0].find("irradiance [W/m^2],air [degC],wind [m/s]"), std::string::npos) << rows[0];
  const auto numbers = [](const std::string& row) {
    std::vector<double> all;
    std::stringstream fields(row);
    for (std::string field; std::getline(fields, field, ',');) all.push_back(std::stod(field));
    return all;
  };
  // The field has 25 MW; nothing is asked for in the first hour, 60 MW in the second.
  const auto first = numbers(rows[1]), second = numbers(rows[2]);
  ASSERT_EQ(first.size(), 12u);
  EXPECT_NEAR(first[1], 25e6, 1);
  EXPECT_EQ(first[2], 0);
  EXPECT_EQ(first[3], 0);
  EXPECT_NEAR(second[1], 25e6, 1);
  EXPECT_NEAR(second[2], 25e6, 1);
  EXPECT_NEAR(second[3], 60e6, 1);
  EXPECT_NEAR(second[9], 500, 1e-6);
  EXPECT_NEAR(second[10], 20, 1e-9);
  EXPECT_EQ(second[11], 3);
}

TEST(DayReport, a_year_of_a_month_that_goes_round_is_no_year) {
  WeatherParameters june;
  june.from = "06-01", june.to = "06-30";
  ReportParameters p;
  p.economics.emplace().fixed = 1;
  const auto said = [&](const WeatherParameters& w, int days) {
    const auto weather = make_weather(w, ".");
    DayReport report(p, Plant({1e6, 0.4, 1, 0.5, 673.15, 573.15, 15, 10}, salt), *weather, {});
    stand(report, days, 86400);
    report.finish();
    std::vector<std::string> doubts = report.doubts();
    // No heat, no electricity: that is said beside it.
    EXPECT_EQ(
        std::erase_if(doubts,
                      [](const std::string& s) { return s.find("levelised cost is infinite") != s.npos; }),
        1u);
    for (const ReportLine& line : report.lines())
      if (line.quantity == "electricity") {
        EXPECT_EQ(line.unit, doubts.empty() ? "MWh/year" : "MWh/365 such days");
      }
    return doubts;
  };
  ASSERT_EQ(said(june, 365).size(), 1u);
  EXPECT_NE(said(june, 365)[0].find("the weather's 30 days repeated 12.2 times"), std::string::npos);
  EXPECT_TRUE(said({}, 365).empty());
}

}  // namespace couplet::thermocline::year_test
