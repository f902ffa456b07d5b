// SPDX-License-Identifier: Apache-2.0
// Schedules: from a file, and found as fast as they are long.
#include "thermocline/plant/flow.hpp"

#include "tests/support/own_folder.hpp"
#include "tests/support/test.hpp"
#include "thermocline/material/numerics.hpp"

namespace couplet::thermocline::flow_file_test {
using testing::HasSubstr;

std::vector<ScheduleRow> read(const std::string& text) {
  const auto file = support::own_folder() / "flows.csv";
  std::ofstream(file) << text;
  return read_flow_file(file);
}

std::string said(const std::string& text) {
  return support::error_of([&] { read(text); });
}

constexpr const char* head = "time [h],mass-flow [kg/s],inlet-temperature [degC]\n";

TEST(FlowFile, units_order_and_empty_cells) {
  const auto rows = read(
      "# of the plant's log\n"
      "mass-flow [t/h]; inlet-temperature [degC]; time [min]; stop-above [degC]\n"
      "-360; 390; 0; 305\n"
      "0;; 90;   # a rest\n");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].mass_flow, -100, 1e-12);
  EXPECT_NEAR(rows[0].inlet_temperature, kelvin(390), 1e-12);
  EXPECT_NEAR(*rows[0].stop_above, kelvin(305), 1e-12);
  EXPECT_FALSE(rows[0].stop_below);
  EXPECT_EQ(rows[1].at, 5400);
  EXPECT_EQ(rows[1].mass_flow, 0);
}

TEST(FlowFile, what_is_wrong_is_said_with_file_and_line) {
  const std::string h = head;
  EXPECT_THAT(said(h + "0,-100,390\n1,abc,390\n"),
              HasSubstr("flows.csv:3: 'abc' is not a number; expected mass-flow here"));
  EXPECT_THAT(said(h + "0,-100,390\n1,50\n"), HasSubstr("flows.csv:3: 2 values, but the file has 3 columns"));
  EXPECT_THAT(said(h + "1,-100,390\n1,0,390\n"), HasSubstr("flows.csv:3: time 3600 s is not after"));
  EXPECT_THAT(said(h + "0,-100,\n"), HasSubstr("flows.csv:2: inlet-temperature is missing"));
  EXPECT_THAT(said(h + "-1,-100,390\n"), HasSubstr("flows.csv:2: time -3600 s is before the start"));
  EXPECT_THAT(said(h + "0,,390\n"), HasSubstr("flows.csv:2: mass-flow is empty"));
  EXPECT_THAT(said("time [h];mass-flow [kg/s];inlet-temperature [degC]\n0;-100,5;390\n"),
              HasSubstr("flows.csv:2: '-100,5' has a decimal comma; write -100.5"));
  EXPECT_THAT(said("0,-100,390\n"), HasSubstr("the first line of a flow file must name its columns"));
  EXPECT_THAT(said(h + "0,nan,390\n"), HasSubstr("flows.csv:2: 'nan' is not a finite number"));
  EXPECT_THAT(said(h + "0,50,-300\n"),
              HasSubstr("flows.csv:2: inlet-temperature is -26.85 K; expected 100 to 3000 K"));
  EXPECT_THAT(said(h + "0,50,1e6\n"), HasSubstr("flows.csv:2: inlet-temperature is 1.00027e+06 K"));
  EXPECT_THAT(said(h), HasSubstr("has no rows"));
  EXPECT_THAT(said("time [h],mass-flow [kg/s]\n0,1\n"),
              HasSubstr("flows.csv:1: the column 'inlet-temperature' is missing"));
  EXPECT_THAT(said("time [h],mass-flow [kg/s],inlet-temperature\n0,1,390\n"),
              HasSubstr("flows.csv:1: the unit of the column 'inlet-temperature' is missing"));
  EXPECT_THAT(said("time [h],mass-flow [m^3/s],inlet-temperature [K]\n0,1,390\n"),
              HasSubstr("flows.csv:1: column 'mass-flow': the unit 'm^3/s' is not convertible to kg/s"));
  EXPECT_THAT(said("time [h],massflow [kg/s]\n"), HasSubstr("Did you mean 'mass-flow'?"));
  EXPECT_THAT(said("time [h],time [s]\n"), HasSubstr("the column 'time' appears twice"));
  EXPECT_THAT(support::error_of([&] { read_flow_file("/nowhere/flows.csv"); }),
              HasSubstr("this flow file does not exist"));
}

/// The row that began last, by looking at every time at which any row has begun.
int row_by_looking(const FlowParameters& p, double t, double& next) {
  int found = -1;
  double began = -1;
  next = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < p.rows.size(); ++i) {
    const bool repeated = p.repeat && p.rows[i].at >= p.repeat->from;
    for (int k = 0; k <= (repeated ? 2500 / p.repeat->every : 0); ++k) {
      const double at = p.rows[i].at + (k > 0 ? k * p.repeat->every : 0);
      if (at <= t + 1e-6 && at > began) found = int(i), began = at;
      if (at > t + 1e-6) next = std::min(next, at);
    }
  }
  return found;
}

TEST(Schedule, finds_the_row_that_looking_at_all_finds) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 100);
  for (int scene = 0; scene < 60; ++scene) {
    FlowParameters p;
    double at = scene % 3 == 0 ? 0 : place(random);
    for (int i = 0; i < 1 + scene % 7; ++i, at += 1 + place(random))
      p.rows.push_back({at, double(i + 1), 500, {}, {}});
    if (scene % 2 == 0) {
      p.repeat =
          ScheduleRepeat{p.rows[std::size_t(scene / 2) % p.rows.size()].at - (scene % 4 == 0 ? 0.5 : 0), 0};
      if (p.repeat->from < 0) p.repeat->from = 0;
      p.repeat->every = p.rows.back().at - p.repeat->from + 1 + place(random);
    }
    ASSERT_EQ(problem_of_rows(p), "");
    FlowTable schedule(p);
    for (int i = 0; i < 200; ++i) {
      const double t = i % 5 == 0 ? p.rows[std::size_t(i) % p.rows.size()].at : 20 * place(random);
      double next = 0;
      const int row = row_by_looking(p, t, next);
      const Flow flow = schedule.decide(t, 500, 500, {});
      EXPECT_EQ(flow.mode, row + 1) << "scene " << scene << ", t = " << t;
      if (std::isinf(next))
        EXPECT_EQ(flow.until, next);
      else
        EXPECT_NEAR(flow.until, next, 1e-9 * next) << "scene " << scene << ", t = " << t;
    }
  }
}

}  // namespace couplet::thermocline::flow_file_test
