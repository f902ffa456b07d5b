// SPDX-License-Identifier: Apache-2.0
#include "thermocline/plant/report.hpp"
#include "common/base/numbers.hpp"
#include "common/io/series.hpp"
#include "tests/unit/thermocline/support.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline::report_test {

constexpr double megawatt_hour = 3.6e9;

// A plant whose tank gives back at the design temperature what it took: every row of the report can be had by
// hand. From 00:00 the field gives 3 Q_PB for 6 h, then nothing. The tank is full after 5 h of charge and
// empty after 5/0.5 = 10 h of discharge; so there are 1 h of charged and 8 h of discharged stand-by, and a
// full cycle of 10 h Q_PB.
class IdealDay {
 public:
  IdealDay() : plant_(PlantParameters{40e6, 0.4, 1e5, 0.5, 673.15, 573.15, 15, 10}, salt) {
    // 1e5 m^2 * 0.5 * 6000 W/m^2 = 3 * 100 MW: not of this world, but round.
    hours_.state_offset = 0;
    for (int h = 0; h < 24 * 365; ++h) {
      hours_.dni.push_back(h % 24 < 6 ? 6000 : 0);
      hours_.temperature.push_back(20);
      hours_.wind.push_back(0);
      hours_.humidity.push_back(0.5);
      hours_.pressure.push_back(1e5);
    }
    weather_.emplace(hours_, WeatherPeriod{});
    temperature_.assign(z_.size(), 0);
  }
  DayReport report(double run_in) const {
    ReportParameters parameters;
    parameters.run_in = run_in;
    return report(parameters);
  }
  DayReport report(const ReportParameters& parameters) const { return {parameters, plant_, *weather_, {}}; }
  /// One hour of the day.
  void hour(DayReport& report, int h) {
    const int clock = h % 24;
    PlantMode mode = PlantMode::standby;
    if (clock < 5) mode = PlantMode::charge;
    if (clock >= 6 && clock < 16) mode = PlantMode::discharge;
    const double power = mode == PlantMode::charge ? 200e6 : mode == PlantMode::discharge ? 100e6 : 0;
    const double sign = mode == PlantMode::charge ? -1 : 1;
    std::vector<BedStep> steps;
    for (int i = 0; i < 4; ++i) {
      BedStep step;
      step.t = h * 3600. + i * 900.;
      step.dt = 900;
      step.flow.mode = int(mode);
      step.flow.mass_flow = sign * power / (salt * 100);
      step.flow.inlet_temperature = 273.15 + (sign < 0 ? 400 : 300);
      step.outlet_temperature = 273.15 + (sign < 0 ? 300 : 400);
      steps.push_back(step);
    }
    TankRecord record;
    record.time = (h + 1) * 3600.;
    record.dt = 3600;
    record.steps = steps;
    record.z = z_;
    record.dz = dz_;
    // Half the bed is hot, with a straight thermocline of 1 m between 300 and 400 degC: 0.7 m between 315 and
    // 385.
    for (std::size_t i = 0; i < z_.size(); ++i)
      temperature_[i] = 273.15 + std::min(400., std::max(300., 350 + 100 * (z_[i] - 5)));
    record.fluid_temperature = temperature_;
    record.filler_temperature = temperature_;
    // The loss is a MWh an hour, out of what is in the tank.
    record.stored = (-sign * power - 1e6) * 3600;
    record.losses = 1e6 * 3600;
    record.heat_capacity = 2000 * megawatt_hour / 100;
    // Both rings swing once a day; the lower one reaches 0.6 on ordinary days and 0.8 at 12:00 of day 3.
    const double swing = 0.5 - 0.5 * std::cos(2 * M_PI * clock / 24);
    const double peak = h == 3 * 24 + 12 ? 0.8 : 0.2 + 0.4 * swing;
    const std::array<double, 2> equivalent{peak * 300e6, (0.1 + 0.3 * swing) * 200e6}, yield{300e6, 200e6},
        wall{1, 2};
    record.wall_z = wall;
    record.equivalent_stress = equivalent;
    record.yield_strength = yield;
    report.record(record);
  }
  std::map<std::string, double> values(const DayReport& report) const {
    std::map<std::string, double> result;
    for (const ReportLine& line : report.lines()) result[line.quantity] = line.value;
    return result;
  }

 private:
  Plant plant_;
  WeatherHours hours_;
  std::optional<Weather> weather_;
  std::vector<double> z_ = [] {
    std::vector<double> z;
    for (int i = 0; i < 1000; ++i) z.push_back((i + 0.5) / 100);
    return z;
  }();
  std::vector<double> dz_ = std::vector<double>(1000, 0.01), temperature_;
};

TEST(DayReport, has_every_row_of_tables_5_5_and_5_6_as_by_hand) {
  IdealDay ideal;
  DayReport report = ideal.report(1);
  for (int h = 0; h < 5 * 24; ++h) ideal.hour(report, h);
  report.finish();
  EXPECT_EQ(report.days_counted(), 4);
  auto v = ideal.values(report);
  EXPECT_NEAR(v["Q_SF"], 1800, 1e-6);
  EXPECT_NEAR(v["Q_excess/Q_SF"], 100 * 1200. / 1800, 1e-9);
  EXPECT_NEAR(v["Q_C/Q_excess"], 100 * (1000. - 5) / 1200, 1e-9);  // 5 h with a loss of 1 MW
  EXPECT_NEAR(v["Q_D/Q_C"], 100 * 1000. / 995, 1e-9);
  EXPECT_NEAR(v["B_D"], 1000 * (1 - 318.15 * std::log(673.15 / 573.15) / 100), 1e-6);
  EXPECT_NEAR(v["Q_lacking/Q_PB"], 100 * 800. / 2400, 1e-9);
  EXPECT_NEAR(v["energy losses"], 24, 1e-9);
  EXPECT_NEAR(v["charge time"], 5, 1e-12);
  EXPECT_NEAR(v["discharge time"], 10, 1e-12);
  EXPECT_NEAR(v["charged stand-by time"], 1, 1e-12);
  EXPECT_NEAR(v["discharged stand-by time"], 8, 1e-12);
  EXPECT_NEAR(v["time with cold outlet"], 100, 1e-9);
  EXPECT_NEAR(v["time with hot outlet"], 100, 1e-9);
  EXPECT_NEAR(v["eta_th"], 100 * 995. / 2000, 1e-9);
  EXPECT_NEAR(v["h_th/h_bed"], 7, 1e-6);
}

TEST(DayReport, factors_of_safety_know_their_place_and_time) {
  IdealDay ideal;
  DayReport report = ideal.report(0);
  for (int h = 0; h < 5 * 24; ++h) ideal.hour(report, h);
  report.finish();
  auto v = ideal.values(report);
  EXPECT_NEAR(v["FoS_static"], 1 / 0.8, 1e-12);
  EXPECT_EQ(v["FoS_static height"], 1);
  EXPECT_EQ(v["FoS_static time"], (3 * 24 + 13) * 3600.);
  // Lower ring: from 0.2 to (4 * 0.6 + 0.8) / 5 = 0.64; upper ring: from 0.1 to 0.4, factor 3.
  EXPECT_NEAR(v["FoS_dynamic"], (1 - 0.2) / (0.64 - 0.2), 1e-12);
  EXPECT_EQ(v["FoS_dynamic height"], 1);
}

TEST(DayReport, days_of_the_run_in_do_not_count) {
  IdealDay ideal;
  DayReport report = ideal.report(4);
  for (int h = 0; h < 5 * 24; ++h) ideal.hour(report, h);
  report.finish();
  EXPECT_EQ(report.days_counted(), 1);
  EXPECT_NEAR(ideal.values(report)["FoS_static"], 1 / 0.6, 1e-12) << "the peak of day 3 counted";
}

TEST(DayReport, goes_on_from_a_checkpoint_bit_for_bit) {
  IdealDay ideal;
  DayReport whole = ideal.report(1), second = ideal.report(1);
  {
    DayReport first = ideal.report(1);
    for (int h = 0; h < 60; ++h) ideal.hour(first, h);
    base::from_numbers(base::to_numbers(first), second, "report");
  }
  for (int h = 0; h < 5 * 24; ++h) ideal.hour(whole, h);
  for (int h = 60; h < 5 * 24; ++h) ideal.hour(second, h);
  EXPECT_EQ(base::to_numbers(whole), base::to_numbers(second));
  const auto a = whole.lines(), b = second.lines();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value) << a[i].quantity;
}

// 1 - T_ref ln(T_hot / T_cold) / (T_hot - T_cold), kelvin in the logarithm: 0.480 and 0.540, with which the
// delivered 1010 and 348 MWh of the thesis carry 485 and 188 MWh.
TEST(DayReport, exergy_of_heat_at_the_design_temperatures_is_that_of_the_thesis) {
  const auto factor = [](double hot) {
    WeatherParameters dark;
    const auto weather = make_weather(dark, {});
    DayReport report({}, Plant({1e6, 0.4, 1, 0.5, 273.15 + hot, 563.15, 15, 10}, salt), *weather, {});
    BedStep step;
    step.dt = 3600;
    step.flow = {100, 273.15 + 290, int(PlantMode::discharge)};
    step.outlet_temperature = 273.15 + hot;
    TankRecord record;
    const std::array<double, 2> z{0.5, 1.5}, dz{1, 1}, temperature{573.15, 573.15};
    const std::array steps{step};
    record.time = record.dt = 3600;
    record.steps = steps;
    record.z = z;
    record.dz = dz;
    record.fluid_temperature = temperature;
    report.record(record);
    report.finish();
    return report.results()[ReportSums::exergy] / report.results()[ReportSums::delivered];
  };
  EXPECT_NEAR(factor(390), 0.480, 5e-4);
  EXPECT_NEAR(factor(565), 0.540, 5e-4);
  EXPECT_NEAR(1010 * factor(390), 485, 0.5);
  EXPECT_NEAR(348 * factor(565), 188, 0.5);
}

std::vector<double> line(double bottom, double top, std::span<const double> z, double height) {
  std::vector<double> temperature;
  for (const double h : z) temperature.push_back(bottom + (top - bottom) * h / height);
  return temperature;
}

TEST(ThermoclineThickness, is_that_of_a_straight_profile_wherever_its_ends_are) {
  // Gradient 10 K/m everywhere: 70 K are 7 m in each of the cases of equation 5.30.
  std::vector<double> z;
  for (int i = 0; i < 2000; ++i) z.push_back((i + 0.5) / 100);
  const double height = 20;
  for (const auto& [bottom, top] : {std::pair{250., 450.}, {320., 520.}, {180., 380.}}) {
    const auto temperature = line(bottom, top, z, height);
    const auto thickness = thermocline_thickness(z, height, temperature, 315, 385);
    ASSERT_TRUE(thickness.has_value()) << bottom;
    EXPECT_NEAR(*thickness, 7, 0.01) << bottom;
  }
  // Neither critical temperature is in the bed: 50 K over 20 m.
  const auto flat = thermocline_thickness(z, height, line(320, 370, z, height), 315, 385);
  ASSERT_TRUE(flat.has_value());
  EXPECT_NEAR(*flat, 70 / 2.5, 0.03);
}

TEST(ThermoclineThickness, is_not_defined_in_a_uniform_bed) {
  const std::array<double, 3> z{0.5, 1.5, 2.5}, hot{390, 390, 390}, cold{300, 300, 300};
  EXPECT_FALSE(thermocline_thickness(z, 3, hot, 315, 385).has_value());
  EXPECT_FALSE(thermocline_thickness(z, 3, cold, 315, 385).has_value());
}

TEST(DayReport, a_part_of_a_year_is_doubted_and_no_day_is_no_answer) {
  IdealDay ideal;
  ReportParameters p;
  const auto report = [&](int days, int hours) {
    DayReport r = ideal.report(p);
    for (int h = 0; h < 24 * days + hours; ++h) ideal.hour(r, h);
    r.finish();
    return std::pair(r.doubts(), r.lines());
  };
  EXPECT_TRUE(report(3, 0).first.empty());
  p.run_in = 4;
  for (const int hours : {0, 5}) {
    const auto [doubts, lines] = report(3, hours);
    ASSERT_EQ(doubts.size(), 1u);
    EXPECT_NE(doubts[0].find("no day counts: the run has 3 whole days, but the first 4 are the run-in"),
              std::string::npos)
        << doubts[0];
    EXPECT_EQ(std::isnan(lines[0].value), hours == 0);
  }
  EXPECT_TRUE(report(6, 0).first.empty());
  p.economics.emplace().field = 1;
  const auto part = report(6, 0).first;
  ASSERT_EQ(part.size(), 1u);
  EXPECT_NE(part[0].find("extrapolated from 2 days to a year"), std::string::npos) << part[0];
  EXPECT_TRUE(report(4 + 365, 0).first.empty());
  const auto odd = report(4 + 400, 0).first;
  ASSERT_EQ(odd.size(), 1u);
  EXPECT_NE(odd[0].find("400 counted days are not a whole number of years"), std::string::npos) << odd[0];
  EXPECT_TRUE(report(4 + 2 * 365, 0).first.empty());
}

TEST(DayReport, a_run_in_that_would_undo_what_was_counted_is_refused) {
  IdealDay ideal;
  DayReport first = ideal.report(2);
  for (int h = 0; h < 126; ++h) ideal.hour(first, h);  // 5 days, of which 3 count
  for (const double run_in : {1., 3.}) {
    DayReport other = ideal.report(run_in);
    try {
      base::from_numbers(base::to_numbers(first), other, "report");
      ADD_FAILURE() << run_in;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what())
                    .find("report.run-in: the run to be continued has completed 5 days and counted 3"),
                std::string::npos)
          << error.what();
    }
  }
  DayReport early = ideal.report(2), later = ideal.report(3);
  for (int h = 0; h < 30; ++h) ideal.hour(early, h);
  EXPECT_NO_THROW(base::from_numbers(base::to_numbers(early), later, "report"))
      << "nothing has been counted yet";
  for (int h = 30; h < 5 * 24; ++h) ideal.hour(later, h);
  EXPECT_EQ(later.days_counted(), 2);
}

TEST(DayReport, a_profile_day_beyond_the_run_is_said) {
  IdealDay ideal;
  ReportParameters p;
  p.profile_day = 2;
  DayReport report = ideal.report(p);
  for (int h = 0; h < 48; ++h) ideal.hour(report, h);
  ASSERT_EQ(report.doubts().size(), 1u);
  EXPECT_NE(report.doubts()[0].find("before profile-day 2"), std::string::npos);
  ideal.hour(report, 48);
  EXPECT_TRUE(report.doubts().empty());
}

}  // namespace couplet::thermocline::report_test
