// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "common/base/error.hpp"
#include "tests/unit/thermocline_plant/support.hpp"
#include "thermocline/weather/weather_hours.hpp"

namespace couplet::thermocline::weather_errors_test {
namespace {

namespace fs = std::filesystem;

class WeatherFile : public testing::Test {
 protected:
  WeatherFile() : folder_(fs::temp_directory_path() / fmt::format("couplet-weather-{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~WeatherFile() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const fs::path file = folder_ / name;
    std::ofstream(file) << text;
    return file.string();
  }
  /// What reading the file complains about, without the folder.
  std::string complaint(const std::string& file) {
    try {
      read_weather(file);
    } catch (const Error& error) {
      std::string text = error.what();
      const std::string folder = folder_.string() + "/";
      if (const auto at = text.find(folder); at != std::string::npos) text.erase(at, folder.size());
      return text;
    }
    return "nothing";
  }
  fs::path folder_;
};

/// A day as CSV: line 1 is a comment, 2 the head, 3 the hour 0; `edit` may change an hour's line or drop it.
std::string csv(const std::function<std::string(int, std::string)>& edit, int hours = 24) {
  std::string text = "# made for a test\nhour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n";
  for (int h = 0; h < hours; ++h) {
    const double dni = h > 6 && h < 18 ? 100. * (h - 6) * (18 - h) / 4 : 0;
    const std::string line = edit(h, fmt::format("{},{},{},3,40,99000\n", h, std::min(dni, 800.), 10 + h));
    text += line;
  }
  return text;
}
TEST_F(WeatherFile, a_right_csv_file_is_read) {
  const WeatherHours record = read_weather(write("right.csv", csv(same)));
  EXPECT_EQ(record.days(), 1);
  EXPECT_EQ(record.temperature[7], 17);
  EXPECT_EQ(record.humidity[7], 0.4);
  EXPECT_TRUE(record.warnings.empty());
}

TEST_F(WeatherFile, columns_may_come_in_any_order) {
  std::string text = "p_Pa,T_degC,hour,dni_W_m2,wind_m_s,rh_pct\n";
  for (int h = 0; h < 24; ++h) text += fmt::format("99000,{},{},{},3,40\n", h, h, 2 * h);
  const WeatherHours record = read_weather(write("order.csv", text));
  EXPECT_EQ(record.temperature[5], 5);
  EXPECT_EQ(record.dni[5], 10);
  EXPECT_EQ(record.pressure[5], 99000);
}

TEST_F(WeatherFile, short_gaps_are_closed_by_straight_lines_with_a_warning) {
  const std::string file = write("gap.csv", csv([](int h, std::string line) {
                                   if (h == 3 || h == 4) return std::string();
                                   return h == 10 ? fmt::format("{},500,,3,40,99000\n", h) : line;
                                 }));
  const WeatherHours record = read_weather(file);
  EXPECT_DOUBLE_EQ(record.temperature[3], 13);
  EXPECT_DOUBLE_EQ(record.temperature[4], 14);
  EXPECT_DOUBLE_EQ(record.temperature[10], 20);
  ASSERT_EQ(record.warnings.size(), 6u);
  EXPECT_THAT(record.warnings,
              testing::Contains(testing::HasSubstr(
                  "gap.csv:6: the air temperature [degC] is missing for 2 hours from here; the gap is filled "
                  "linearly.")));
  EXPECT_THAT(record.warnings, testing::Contains(testing::HasSubstr(
                                   "gap.csv:11: the air temperature [degC] is missing for 1 hour from")));
}

TEST_F(WeatherFile, what_is_wrong_is_said_with_file_and_line) {
  const auto with = [&](int hour, const std::string& line) {
    return complaint(write("w.csv", csv([&](int h, std::string old) { return h == hour ? line : old; })));
  };
  EXPECT_EQ(with(5, "5,0,95,3,40,99000\n"),
            "w.csv:8: the air temperature [degC] is 95; it must be from -70 to 65.");
  EXPECT_EQ(with(5, "5,-1,15,3,40,99000\n"),
            "w.csv:8: the direct normal irradiance [W/m^2] is -1; it must be from 0 to 1412.");
  EXPECT_EQ(with(5, "5,0,15,3,40,990\n"),
            "w.csv:8: the pressure [Pa] is 990; it must be from 40000 to 110000.");
  EXPECT_EQ(with(5, "5,0,warm,3,40,99000\n"),
            "w.csv:8: 'warm' is not a number; expected air temperature [degC] here.");
  EXPECT_EQ(with(5, "5,0,15,3,40\n"), "w.csv:8: 5 values, but the file has 6 columns.");
  EXPECT_EQ(with(5, "4,0,15,3,40,99000\n"),
            "w.csv:8: hour 4 of the year comes after hour 4: each hour must appear once, in order.");
  EXPECT_EQ(with(5, "5.5,0,15,3,40,99000\n"),
            "w.csv:8: the hour of the year must be a whole number from 0 to 8759, not '5.5'.");
  EXPECT_EQ(with(23, ""),
            "w.csv:25: the file ends after 23 of the 24 hours of its last day. Whole days are needed.");
  EXPECT_EQ(
      complaint(write("w.csv", csv([](int h, std::string line) { return h > 2 && h < 10 ? "" : line; }))),
      "w.csv:6: hours 3 to 9 of the year are missing. Gaps of more than 6 hours are not filled; complete the "
      "file or choose a period without the gap.");
  EXPECT_EQ(complaint(write("w.csv", csv([](int h, std::string line) {
                              return h > 2 && h < 10 ? fmt::format("{},nan,15,3,40,99000\n", h) : line;
                            }))),
            "w.csv:6: the direct normal irradiance [W/m^2] is missing for 7 hours from here. Gaps of more "
            "than 6 hours are not filled.");
}

TEST_F(WeatherFile, a_wrong_head_is_said) {
  EXPECT_EQ(complaint(write("w.csv", "hour,dni_W_m2,T_degC,wind,rh_pct,p_Pa\n0,0,0,0,0,0\n")),
            "w.csv:1: unknown column 'wind'. Did you mean 'wind_m_s'?");
  EXPECT_EQ(complaint(write("w.csv", "hour,dni_W_m2,T_degC,rh_pct,p_Pa\n")),
            "w.csv:1: the column 'wind_m_s' is missing. A weather file has the columns dni_W_m2, T_degC, "
            "wind_m_s, rh_pct, p_Pa, hour.");
  EXPECT_EQ(complaint(write("w.csv", "hour,hour\n")), "w.csv:1: the column 'hour' appears twice.");
  EXPECT_EQ(complaint(write("w.csv", "# nothing else\n")), "w.csv: this weather file contains no hours.");
  EXPECT_EQ(
      complaint((folder_ / "none.csv").string()),
      "none.csv: this weather file does not exist. Relative paths start at the folder of the YAML file.");
}

TEST_F(WeatherFile, a_damaged_compressed_file_is_refused) {
  const fs::path source = fs::path(WEATHER_FOLDER) / "upington_surrogate.csv.gz";
  fs::copy_file(source, folder_ / "cut.csv.gz");
  EXPECT_EQ(read_weather(folder_ / "cut.csv.gz").days(), 365);
  fs::resize_file(folder_ / "cut.csv.gz", fs::file_size(source) / 2);
  EXPECT_EQ(
      complaint((folder_ / "cut.csv.gz").string()),
      "cut.csv.gz: this weather file is damaged or truncated: decompression failed (its end is missing). "
      "Copy or compress it again.");
}

/// A day as EPW: the first record is line 9.
std::string epw(const std::function<std::string(int, std::string)>& edit) {
  std::string text = "LOCATION,Nowhere,-,XXX,test,000000,37.5,-5.25,0,100\n";
  for (int i = 0; i < 7; ++i) text += "HEADER\n";
  for (int h = 1; h <= 24; ++h) {
    const int dni = h > 6 && h < 19 ? 500 : 0;
    text += edit(
        h,
        fmt::format(
            "2005,3,1,{},0,source,{}.5,5,40,99000,0,0,300,0,{},0,0,0,0,0,180,2.5,0,0,9,9,9,9,0,0,0,0,0,0,0\n",
            h, h, dni));
  }
  return text;
}

TEST_F(WeatherFile, an_epw_file_is_read) {
  const WeatherHours record = read_weather(write("right.epw", epw(same)));
  EXPECT_EQ(record.first_day, 59);
  EXPECT_EQ(record.days(), 1);
  EXPECT_EQ(record.temperature[0], 1.5);  // at 01:00, the end of the first hour
  EXPECT_EQ(record.state_offset, 3600);
  EXPECT_EQ(record.dni[6], 500);  // from 06:00 to 07:00
  EXPECT_EQ(record.dni[5], 0);
  EXPECT_EQ(record.wind[3], 2.5);
  EXPECT_EQ(record.pressure[3], 99000);
  ASSERT_TRUE(record.site.has_value());
  EXPECT_EQ(record.site->latitude, 37.5);
  EXPECT_EQ(record.site->solar_ahead, -5.25 * 240);
}

/// Rows that decimal commas make longer are not read as others.
TEST_F(WeatherFile, values_beyond_the_last_column_are_refused) {
  const auto with_comma = [](int h, std::string line) {
    return h == 4 ? line.replace(line.find(",40,99000"), 9, ",40,5,99000") : line;
  };
  EXPECT_EQ(
      complaint(write("w.epw", epw(with_comma))),
      "w.epw:12: 36 values, but the file has 35 columns. If commas are decimal commas, use decimal points.");
  EXPECT_EQ(
      complaint(write("w.csv",
                      csv([](int h, std::string line) { return h == 5 ? "5,0,15,5,3,40,99000\n" : line; }))),
      "w.csv:8: 7 values, but the file has 6 columns. If commas are decimal commas, use decimal points.");
}

TEST_F(WeatherFile, missing_codes_of_epw_are_gaps) {
  const WeatherHours record =
      read_weather(write("code.epw", epw([](int h, std::string line) {
                           return h == 9 ? line.replace(line.find(",9.5,"), 5, ",99.9,") : line;
                         })));
  EXPECT_DOUBLE_EQ(record.temperature[8], 9.5);
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_THAT(record.warnings[0],
              testing::HasSubstr("code.epw:17: the air temperature [degC] is missing for 1 hour from here"));
}

TEST_F(WeatherFile, what_is_wrong_in_an_epw_file_is_said_with_the_line) {
  EXPECT_EQ(
      complaint(write("w.epw", "hour,dni\n")),
      "w.epw:1: this is not an EPW file: it must start with a line LOCATION,... and have 8 header lines.");
  EXPECT_EQ(complaint(write(
                "w.epw", epw([](int h, std::string line) { return h == 4 ? "2005,3,1,25,0,s,1\n" : line; }))),
            "w.epw:12: 7 columns; an EPW record has 35.");
  EXPECT_EQ(complaint(write("w.epw", epw([](int h, std::string line) {
                              return h == 4 ? line.replace(0, 9, "2005,3,32,") : line;
                            }))),
            "w.epw:12: '03-32' is not a date: month 3 of a year of 365 days has 31 days.");
}

}  // namespace
}  // namespace couplet::thermocline::weather_errors_test
