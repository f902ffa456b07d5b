// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/thermocline/support.hpp"
#include "thermocline/weather/weather.hpp"

namespace couplet::thermocline::weather_errors_test {

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
                                   return h == 10 || h == 23 ? fmt::format("{},500,,3,40,99000\n", h) : line;
                                 }));
  const WeatherHours record = read_weather(file);
  EXPECT_DOUBLE_EQ(record.temperature[3], 13);
  EXPECT_DOUBLE_EQ(record.temperature[4], 14);
  EXPECT_DOUBLE_EQ(record.temperature[10], 20);
  EXPECT_DOUBLE_EQ(record.temperature[23], 32);  // the last one that is known
  ASSERT_EQ(record.warnings.size(), 7u);
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
  EXPECT_EQ(
      complaint(write("w.csv", "hour,dni_W_m2,T_degC,wind,rh_pct,p_Pa\n0,0,0,0,0,0\n")),
      "w.csv:1: unknown column 'wind'. Did you mean 'wind_m_s'? 'couplet weather' converts tables with other "
      "column names.");
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

/// Rows that decimal commas make longer are not read as others.
TEST_F(WeatherFile, values_beyond_the_last_column_are_refused) {
  EXPECT_EQ(
      complaint(write("w.csv",
                      csv([](int h, std::string line) { return h == 5 ? "5,0,15,5,3,40,99000\n" : line; }))),
      "w.csv:8: 7 values, but the file has 6 columns. If commas are decimal commas, use decimal points.");
}

TEST_F(WeatherFile, says_where_the_site_is_and_when_the_states_hold) {
  const std::string site = "# latitude: 37.5\n# longitude: -5.25\n#time-zone:1\n";
  const WeatherHours w =
      read_weather(write("w.csv", "# note: from a tower\n# states-at: 3600\n" + site + csv(same)));
  EXPECT_EQ(w.state_offset, 3600);
  ASSERT_TRUE(w.site.has_value());
  EXPECT_EQ(w.site->latitude, 37.5);
  EXPECT_EQ(w.site->solar_ahead, -5.25 * 240 - 3600);
  const WeatherHours plain = read_weather(write("w.csv", csv(same)));
  EXPECT_EQ(plain.state_offset, 1800) << "the middle of the hour";
  EXPECT_FALSE(plain.site.has_value());
  EXPECT_EQ(complaint(write("w.csv", "# latitude: 137.5\n" + csv(same))),
            "w.csv:1: latitude is 137.5; it must be from -90 to 90.");
  EXPECT_EQ(complaint(write("w.csv", "# latitude: 37.5\n" + csv(same))),
            "w.csv: a line '# longitude: ...' is missing; a location has latitude, longitude and time-zone.");
  EXPECT_EQ(complaint(write("w.csv", "# latitude: south\n" + csv(same))),
            "w.csv:1: 'south' is not a number; expected latitude here.");
}

TEST_F(WeatherFile, another_format_is_refused_with_the_command_that_converts_it) {
  for (const std::string text :
       {"LOCATION,Nowhere,-,NOW,test,000000,37.5,-5.25,0,100\nHEADER\n",
        "Latitude (decimal degrees): 45.000\nLongitude (decimal degrees): 8.000\n",
        "Source,Latitude,Longitude,Time Zone\nNSRDB,40,-105,-7\nYear,Month,Day,Hour\n",
        "723170,\"GREENSBORO\",NC,-5.0,36.1,-79.95,273\nDate (MM/DD/YYYY),Time (HH:MM)\n"}) {
    const std::string said = complaint(write("site.epw.gz", text));
    EXPECT_THAT(said, testing::StartsWith("site.epw.gz:1: this is not the CSV of a thermocline")) << text;
    EXPECT_THAT(said, testing::EndsWith("couplet weather '" + (folder_ / "site.epw.gz").string() + "' -o '" +
                                        (folder_ / "site_weather.csv").string() + "'"));
  }
}

TEST_F(WeatherFile, a_year_may_begin_in_july) {
  const auto year = [&](int first) {
    std::string text = "hour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n";
    for (int i = 0; i < 8760; ++i) {
      const int h = (first + i) % 8760;
      text += fmt::format("{},{},{},1,40,90000\n", h, h % 24 == 12 ? 700 : 0, h % 50);
    }
    return read_weather(write("y.csv", text));
  };
  const WeatherHours july = year(181 * 24), january = year(0);
  EXPECT_EQ(july.first_day, 0);
  EXPECT_EQ(july.temperature, january.temperature);
  EXPECT_EQ(july.dni, january.dni);
}

/// Two days of a winter near Boulder, with sun from 9 to 15.
TEST_F(WeatherFile, a_sun_at_night_is_doubted) {
  const auto doubts = [&](const std::string& zone) {
    WeatherParameters p;
    p.kind = WeatherKind::file;
    p.file = write("w.csv", "# latitude: 40.01\n# longitude: -105.26\n# time-zone: " + zone + "\n" +
                                csv(
                                    [](int h, std::string) {
                                      const int dni = h % 24 >= 9 && h % 24 < 15 ? 500 : 0;
                                      return fmt::format("{},{},5,3,40,84000\n", h, dni);
                                    },
                                    48));
    return make_weather(p, ".")->doubts();
  };
  EXPECT_THAT(doubts("-7"), testing::IsEmpty());
  const auto other = doubts("5");
  ASSERT_EQ(other.size(), 2u);
  EXPECT_THAT(other[0], testing::HasSubstr("solar time of its longitude is 12.0 h behind its time zone"));
  EXPECT_THAT(other[1],
              testing::HasSubstr("100 % of the irradiation is in hours with the sun below the horizon"));
}

TEST_F(WeatherFile, other_units_and_separators_are_told_by_what_they_give) {
  const auto days = [&](double noon, double humidity, int count) {
    return csv(
        [&](int h, std::string) {
          return fmt::format("{},{},10,1,{},90000\n", h, h % 24 == 12 ? noon : 0, humidity);
        },
        24 * count);
  };
  EXPECT_THAT(complaint(write("w.csv", days(0.96, 40, 1))), testing::HasSubstr("not kW/m^2"));
  EXPECT_THAT(complaint(write("w.csv", days(3.4, 40, 1))), testing::HasSubstr("is 3.4: too low for the sun"));
  EXPECT_THAT(complaint(write("w.csv", days(500, 0.4, 1))), testing::HasSubstr("expected percent"));
  EXPECT_EQ(complaint(write("w.csv", "\xEF\xBB\xBF" + days(500, 40, 1))), "nothing") << "a byte order mark";
  std::string own = days(500, 40, 1);
  std::replace(own.begin(), own.end(), ',', ';');
  EXPECT_THAT(complaint(write("w.csv", own)),
              testing::HasSubstr("w.csv:2: the columns are separated by ';'"));
  WeatherParameters p;
  p.kind = WeatherKind::file;
  for (const double sun : {0, 600}) {
    p.file = write("w.csv", days(sun, 40, 20));
    EXPECT_THAT(make_weather(p, ".")->doubts(), testing::SizeIs(sun > 0 ? 0 : 1))
        << "20 days without any sun";
  }
}

}  // namespace couplet::thermocline::weather_errors_test
