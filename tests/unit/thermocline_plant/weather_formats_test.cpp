// SPDX-License-Identifier: Apache-2.0
// Files as NREL and the JRC give them: real heads, gaps, units, and wrong files with their line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "common/base/error.hpp"
#include "tests/unit/thermocline_plant/support.hpp"
#include "thermocline/weather/weather_parameters.hpp"

namespace couplet::thermocline::weather_formats_test {
namespace {

namespace fs = std::filesystem;
using Edit = std::function<std::string(int, std::string)>;
using testing::HasSubstr;

class ForeignWeather : public testing::Test {
 protected:
  ForeignWeather() : folder_(fs::temp_directory_path() / fmt::format("couplet-formats-{}", getpid())) {
    fs::create_directories(folder_);
  }
  ~ForeignWeather() override { fs::remove_all(folder_); }
  std::string write(const std::string& text, const std::string& name = "weather.csv") {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::string complaint(const std::string& text, const std::string& name = "weather.csv") {
    try {
      read_weather(write(text, name));
    } catch (const Error& error) {
      std::string said = error.what();
      const std::string before = folder_.string() + "/";
      if (const auto at = said.find(before); at != std::string::npos) said.erase(at, before.size());
      return said;
    }
    return "nothing";
  }
  fs::path folder_;
};

/// Two days of the NSRDB's head as its service gives it; line 4 is hour 0.
std::string nsrdb(const Edit& edit = same, const std::string& pressure = "mbar") {
  std::string text =
      "Source,Location ID,City,State,Country,Latitude,Longitude,Time Zone,Elevation,Local Time Zone,Dew "
      "Point Units,"
      "DHI Units,DNI Units,GHI Units,Temperature Units,Pressure Units,Wind Direction Units,Wind "
      "Speed,Version\n"
      "NSRDB,145809,-,-,-,40.01,-105.26,-7,1628,-7,c,w/m2,w/m2,w/m2,c," +
      pressure +
      ",Degrees,m/s,v3.0.6\n"
      "Year,Month,Day,Hour,Minute,Temperature,Dew Point,DHI,DNI,GHI,Surface Albedo,Pressure,Wind "
      "Direction,Wind "
      "Speed\n";
  for (int h = 0; h < 48; ++h)
    text += edit(h, fmt::format("2003,1,{},{},30,{},-6,30,{},100,0.866,840,298.6,0.5\n", 1 + h / 24, h % 24,
                                h % 24 - 5, h % 24 == 12 ? 960 : 0));
  return text;
}

TEST_F(ForeignWeather, nsrdb_is_read_with_its_site_units_and_dew_point) {
  const WeatherHours w = read_weather(write(nsrdb()));
  EXPECT_EQ(w.days(), 2);
  EXPECT_EQ(w.first_day, 0);
  EXPECT_EQ(w.state_offset, 1800);
  EXPECT_EQ(w.dni[12], 960);
  EXPECT_EQ(w.temperature[3], -2);
  EXPECT_EQ(w.pressure[0], 84000);
  EXPECT_EQ(w.wind[0], 0.5);
  // Magnus: e(-6)/e(7), of water.
  EXPECT_NEAR(w.humidity[12], std::exp(17.625 * -6 / 237.04) / std::exp(17.625 * 7 / 250.04), 1e-9);
  EXPECT_NEAR(w.humidity[0], std::exp(17.625 * -6 / 237.04) / std::exp(17.625 * -5 / 238.04), 1e-9);
  ASSERT_TRUE(w.site.has_value());
  EXPECT_EQ(w.site->latitude, 40.01);
  EXPECT_NEAR(w.site->solar_ahead, -105.26 * 240 + 7 * 3600, 1e-9);
  EXPECT_TRUE(w.warnings.empty());
}

TEST_F(ForeignWeather, several_records_an_hour_are_averaged) {
  const WeatherHours w = read_weather(write(nsrdb([](int h, std::string line) {
    const std::string half = fmt::format("2003,1,{},{},0,{},-6,30,{},100,0.866,820,298.6,1.5\n", 1 + h / 24,
                                         h % 24, h % 24 - 7, h % 24 == 12 ? 800 : 0);
    return half + line;
  })));
  EXPECT_EQ(w.days(), 2);
  EXPECT_EQ(w.dni[12], 880);
  EXPECT_EQ(w.pressure[0], 83000);
  EXPECT_EQ(w.temperature[12], 6);
  EXPECT_EQ(w.state_offset, 1800);
}

TEST_F(ForeignWeather, a_record_that_is_there_twice_is_refused) {
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) { return h == 12 ? line + line : line; })),
              HasSubstr("weather.csv:17: minute 30 of hour 12 of the year comes after minute 30"));
}

TEST_F(ForeignWeather, a_sun_at_night_is_doubted) {
  const auto doubts = [&](const std::string& zone, const std::string& longitude,
                          std::optional<SiteParameters> site = {}) {
    std::string text = nsrdb([](int h, std::string) {
      return fmt::format("2003,1,{},{},30,{},-6,30,{},100,0.866,840,298.6,0.5\n", 1 + h / 24, h % 24,
                         h % 24 - 5, h % 24 >= 9 && h % 24 < 15 ? 500 : 0);
    });
    const std::string place = "-105.26,-7,";
    text.replace(text.find(place), place.size(), longitude + "," + zone + ",");
    WeatherParameters p;
    p.kind = WeatherKind::file;
    p.file = write(text);
    p.site = site;
    return make_weather(p, ".")->doubts();
  };
  EXPECT_THAT(doubts("-7", "-105.26"), testing::IsEmpty());
  const auto other = doubts("5", "-105.26");
  ASSERT_EQ(other.size(), 2u);
  EXPECT_THAT(other[0], HasSubstr("solar time of its longitude is 12.0 h behind its time zone"));
  EXPECT_THAT(other[1], HasSubstr("100 % of the irradiation is in hours with the sun below the horizon"));
  EXPECT_THAT(doubts("-7", "-105.26", SiteParameters{40.01, -105.26, -7}), testing::IsEmpty());
  const auto moved = doubts("-7", "-105.26", SiteParameters{37, -105.26, -7});
  ASSERT_EQ(moved.size(), 1u);
  EXPECT_THAT(moved[0], HasSubstr("'site' (latitude 37 deg"));
}

TEST_F(ForeignWeather, other_units_and_separators_are_told_by_what_they_give) {
  EXPECT_THAT(complaint(nsrdb([](int h, std::string) {
                return fmt::format("2003,1,{},{},30,1,-6,30,{},100,0.866,840,298.6,0.5\n", 1 + h / 24, h % 24,
                                   h % 24 == 12 ? 0.96 : 0);
              })),
              HasSubstr("not kW/m^2"));
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) {
                return h % 24 == 12 ? line.replace(line.find(",960,"), 5, ",3.4,") : line;
              })),
              HasSubstr("is 3.4: too low for the sun"));
  WeatherParameters p;
  p.kind = WeatherKind::file;
  for (const bool sun : {false, true}) {
    std::string text = "hour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n";
    for (int h = 0; h < 24 * 20; ++h)
      text += fmt::format("{},{},10,1,40,90000\n", h, sun && h == 36 ? 600 : 0);
    p.file = write(text);
    EXPECT_THAT(make_weather(p, ".")->doubts(), testing::SizeIs(sun ? 0 : 1)) << "20 days without any sun";
  }
  std::string own = "hour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n", dry = own;
  for (int h = 0; h < 24; ++h)
    own += fmt::format("{},500,10,1,40,90000\n", h), dry += fmt::format("{},500,10,1,0.4,90000\n", h);
  EXPECT_EQ(complaint("\xEF\xBB\xBF" + own), "nothing") << "a byte order mark";
  EXPECT_THAT(complaint(dry), HasSubstr("expected percent"));
  std::replace(own.begin(), own.end(), ',', ';');
  EXPECT_THAT(complaint(own), HasSubstr("weather.csv:1: the columns are separated by ';'"));
}

/// EPW of a site in the south of Spain; `first`: the month that it begins with, `records` an hour.
std::string epw(int first, int records) {
  std::string text = "LOCATION,Sevilla,-,ESP,SWEC,083910,37.00,-5.00,1.0,31.0\n";
  for (int i = 0; i < 7; ++i) text += "COMMENTS\n";
  constexpr int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  for (int m = 0; m < 12; ++m)
    for (int d = 1; d <= days[(first - 1 + m) % 12]; ++d)
      for (int h = 1; h <= 24; ++h)
        for (int r = 1; r <= records; ++r)
          text += fmt::format("1999,{},{},{},{},?,{},5,50,95000,0,0,300,0,{},0,0,0,0,0,180,2\n",
                              (first - 1 + m) % 12 + 1, d, h, 60 * r / records, (first - 1 + m) % 12 + 1,
                              h == 12 ? 100 * r : 0);
  return text;
}

TEST_F(ForeignWeather, epw_may_begin_in_july_and_have_several_records_an_hour) {
  const WeatherHours july = read_weather(write(epw(7, 1), "a.epw")),
                     january = read_weather(write(epw(1, 1), "b.epw"));
  EXPECT_EQ(july.first_day, 0);
  EXPECT_EQ(july.temperature, january.temperature);
  EXPECT_EQ(july.dni, january.dni);
  EXPECT_EQ(january.state_offset, 3600);
  const WeatherHours twice = read_weather(write(epw(1, 2), "c.epw"));
  EXPECT_EQ(twice.days(), 365);
  EXPECT_EQ(twice.dni[11], 150);
  EXPECT_EQ(twice.state_offset, 2700) << "the mean of 12:30 and 13:00";
}

TEST_F(ForeignWeather, sam_names_and_a_leap_day_are_known) {
  std::string text =
      "Latitude,Longitude,Time Zone,Elevation\n33.2,-97.1,-6,190\n"
      "Year,Month,Day,Hour,GHI,DNI,DHI,Tdry,Tdew,RH,Pres,Wspd,Wdir,Albedo\n";
  for (const char* day : {"2,28", "2,29", "3,1"})
    for (int h = 0; h < 24; ++h)
      text += fmt::format("2004,{},{},0,{},0,10,5,70,990,3,180,0.2\n", day, h, h == 12 ? 700 : 0);
  const WeatherHours w = read_weather(write(text));
  EXPECT_EQ(w.days(), 2);
  EXPECT_EQ(w.first_day, 58);
  EXPECT_NEAR(w.humidity[0], 0.7, 1e-12);
  EXPECT_EQ(w.site->latitude, 33.2);
}

TEST_F(ForeignWeather, gaps_and_codes_for_missing_values_are_closed_or_refused) {
  const WeatherHours w = read_weather(write(nsrdb([](int h, std::string line) {
    if (h == 5) return fmt::format("2003,1,1,5,30,-9999,-6,30,0,100,0.866,840,298.6,0.5\n");
    return h == 7 ? std::string() : line;
  })));
  EXPECT_NEAR(w.temperature[5], 0, 1e-12);
  ASSERT_FALSE(w.warnings.empty());
  EXPECT_THAT(w.warnings[0], HasSubstr("weather.csv:"));
  EXPECT_THAT(
      complaint(nsrdb([](int h, std::string line) { return h >= 5 && h < 15 ? std::string() : line; })),
      HasSubstr("weather.csv:9: hours 5 to 14 of the year are missing"));
}

TEST_F(ForeignWeather, wrong_nsrdb_files_are_said_with_their_line) {
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) {
                return h == 3 ? line.replace(line.find(",30,"), 4, ",60,") : line;
              })),
              HasSubstr("weather.csv:7: the minute is 60"));
  std::string twice = nsrdb();
  twice.replace(twice.find(",GHI,Surface"), 4, ",DNI");
  EXPECT_THAT(complaint(twice), HasSubstr("weather.csv:3: the column 'DNI' appears twice"));
  EXPECT_THAT(complaint(nsrdb() + std::string(1, '\0')),
              HasSubstr("weather.csv:52: this weather file is not plain text"));
  EXPECT_THAT(complaint(nsrdb(same, "Pa")),
              HasSubstr("weather.csv:2: 'Pressure Units' is 'Pa'; only mbar is supported"));
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) {
                return h == 3 ? "2003,1,1,3,30,warm,-6,30,0,1,0.8,840,298,0.5\n" : line;
              })),
              HasSubstr("weather.csv:7: 'warm' is not a number"));
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) { return h == 3 ? "2003,1,1,3\n" : line; })),
              HasSubstr("weather.csv:7: 4 values, but the file has 14 columns"));
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) {
                return h == 3 ? "2003,13,1,3,30,1,-6,30,0,1,0.8,840,298,0.5\n" : line;
              })),
              HasSubstr("weather.csv:7: '13-01' is not a date"));
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) {
                return h == 3 ? "2003,1,1,24,30,1,-6,30,0,1,0.8,840,298,0.5\n" : line;
              })),
              HasSubstr("weather.csv:7: the hour is 24"));
  EXPECT_THAT(complaint(nsrdb([](int h, std::string line) {
                return h == 3 ? "2003,1,1,3,30,1,-6,30,0,1,0.8,84000,298,0.5\n" : line;
              })),
              HasSubstr("weather.csv:7: the pressure [Pa] is 8.4e+06"));
  EXPECT_THAT(
      complaint(
          "Source,Latitude,Longitude,Time Zone\nNSRDB,40,-105,-7\nYear,Month,Day,Hour,GHI,Temperature\n"),
      HasSubstr("weather.csv:3: the column for the direct normal irradiance [W/m^2] is missing"));
  EXPECT_THAT(complaint("Source,Latitude,Longitude,Time Zone\nNSRDB,140,-105,-7\nYear,Month,Day,Hour\n"),
              HasSubstr("weather.csv:2: latitude 140"));
  EXPECT_THAT(complaint("Source,Latitude,Longitude,Time Zone\nNSRDB,40,-105,-7\n"),
              HasSubstr("weather.csv:1: a SAM or NSRDB"));
}

/// TMY3 as NREL's archive has it: line 3 is the hour that ends at 01:00.
std::string tmy3(const Edit& edit = same) {
  std::string text =
      "723170,\"GREENSBORO, PIEDMONT TRIAD INT\",NC,-5.0,36.100,-79.950,273\n"
      "Date (MM/DD/YYYY),Time (HH:MM),ETR (W/m^2),ETRN (W/m^2),GHI (W/m^2),GHI source,GHI uncert (%),DNI "
      "(W/m^2),DNI "
      "source,DNI uncert (%),Dry-bulb (C),Dry-bulb source,RHum (%),RHum source,Pressure (mbar),Pressure "
      "source,Wspd "
      "(m/s),Wspd source\n";
  for (int h = 0; h < 48; ++h)
    text += edit(h, fmt::format("01/{:02d}/1988,{:02d}:00,0,0,0,1,0,{},1,0,{},A,77,A,993,A,6.2,A\n",
                                1 + h / 24, h % 24 + 1, h % 24 == 11 ? 426 : 0, h % 24));
  return text;
}

TEST_F(ForeignWeather, tmy3_has_hours_that_end) {
  const WeatherHours w = read_weather(write(tmy3(), "723170TYA.CSV"));
  EXPECT_EQ(w.days(), 2);
  EXPECT_EQ(w.dni[11], 426) << "12:00 is the hour from 11 to 12";
  EXPECT_EQ(w.state_offset, 3600);
  EXPECT_EQ(w.pressure[0], 99300);
  EXPECT_EQ(w.humidity[0], 0.77);
  EXPECT_EQ(w.site->latitude, 36.1);
  EXPECT_NEAR(w.site->solar_ahead, -79.95 * 240 + 5 * 3600, 1e-9);
}

TEST_F(ForeignWeather, wrong_tmy3_files_are_said_with_their_line) {
  const auto with = [](const std::string& other) {
    return tmy3([other](int h, std::string line) { return h == 4 ? other + "\n" : line; });
  };
  EXPECT_THAT(complaint(with("01/01/1988,05:30,0,0,0,1,0,0,1,0,1,A,77,A,993,A,6.2,A")),
              HasSubstr("weather.csv:7: the time is 05:30"));
  EXPECT_THAT(complaint(with("1988-01-01,05:00,0,0,0,1,0,0,1,0,1,A,77,A,993,A,6.2,A")),
              HasSubstr("weather.csv:7: '1988-01-01,05:00'"));
  EXPECT_THAT(complaint(with("01/01/1988,05:00")), HasSubstr("weather.csv:7: 2 values"));
  EXPECT_THAT(complaint(with("01/01/1988,05:00,0,0,0,1,0,1500,1,0,1,A,77,A,993,A,6.2,A")),
              HasSubstr("weather.csv:7: the direct normal irradiance"));
  EXPECT_THAT(complaint("1,2\n" + tmy3().substr(tmy3().find('\n') + 1)),
              HasSubstr("weather.csv:1: the first line of a TMY3 file"));
  const WeatherHours gap =
      read_weather(write(with("01/01/1988,05:00,0,0,0,1,0,-9900,1,0,1,A,77,A,993,A,6.2,A")));
  EXPECT_EQ(gap.dni[4], 0);
  EXPECT_EQ(gap.warnings.size(), 1u);
}

/// PVGIS 5.x, the typical year; line 17 is 00:00 UTC.
std::string pvgis(const Edit& edit = same) {
  std::string text =
      "Latitude (decimal degrees): 45.000\nLongitude (decimal degrees): 8.000\nElevation (m): "
      "250.0\nmonth,year\n";
  for (int m = 1; m <= 12; ++m) text += fmt::format("{},{}\n", m, 2004 + m);
  text += "time(UTC),T2m,RH,G(h),Gb(n),Gd(h),IR(h),WS10m,WD10m,SP\n";
  for (int h = 0; h < 48; ++h) {
    const int clock = h % 24;
    text += edit(h, fmt::format("200901{:02d}:{:02d}00,{},91.95,0.0,{},0.0,322.99,2.3,334.0,99573.0\n",
                                1 + h / 24, clock, clock,
                                clock == 10   ? "600.0"
                                : clock == 11 ? "800.0"
                                              : "-0.0"));
  }
  return text + "\nT2m: 2-m air temperature (degree Celsius)\nRH: relative humidity (%)\n";
}

TEST_F(ForeignWeather, pvgis_gives_moments_and_its_legend_is_no_data) {
  const WeatherHours w = read_weather(write(pvgis()));
  EXPECT_EQ(w.days(), 2);
  EXPECT_EQ(w.dni[9], 300);
  EXPECT_EQ(w.dni[10], 700);
  EXPECT_EQ(w.dni[11], 400);
  EXPECT_EQ(w.dni[12], 0);
  EXPECT_EQ(w.state_offset, 0);
  EXPECT_EQ(w.pressure[0], 99573);
  EXPECT_NEAR(w.humidity[0], 0.9195, 1e-12);
  EXPECT_EQ(w.site->latitude, 45);
  EXPECT_EQ(w.site->solar_ahead, 8 * 240);
}

TEST_F(ForeignWeather, pvgis_irradiance_belongs_to_its_own_moment) {
  const auto with = [](const std::string& head, const std::string& minute) {
    std::string text = pvgis([&](int, std::string line) { return line.replace(11, 2, minute); });
    return text.insert(text.find("month,year"), head);
  };
  const WeatherHours half = read_weather(write(with("Irradiance Time Offset (h): 0.5\n", "00")));
  // 600 at 10:30, 800 at 11:30, 0 at 9:30 and 12:30: (0 + 6 * 600 + 800)/8 from 10 to 11.
  EXPECT_NEAR(half.dni[9], 75, 1e-9);
  EXPECT_NEAR(half.dni[10], 550, 1e-9);
  EXPECT_NEAR(half.dni[11], 675, 1e-9);
  EXPECT_NEAR(half.dni[12], 100, 1e-9);
  EXPECT_EQ(half.state_offset, 0);
  const WeatherHours stamp = read_weather(write(with("", "30")));
  EXPECT_NEAR(stamp.dni[10], 550, 1e-9);
  EXPECT_EQ(stamp.state_offset, 1800);
  const WeatherHours earlier = read_weather(write(with("Irradiance Time Offset (h): -0.5\n", "00")));
  EXPECT_NEAR(earlier.dni[9], 550, 1e-9);
  EXPECT_THAT(complaint(with("Irradiance Time Offset (h): 30\n", "00")), HasSubstr("offset is 30 h"));
  EXPECT_THAT(
      complaint(pvgis([](int h, std::string line) { return h == 3 ? line.replace(11, 2, "10") : line; })),
      HasSubstr("weather.csv:21: the minute is 10; all records"));
}

TEST_F(ForeignWeather, pvgis_runs_on_local_standard_time_unless_told_otherwise) {
  WeatherParameters p;
  p.kind = WeatherKind::file;
  std::string text = pvgis();
  const std::string here = "Longitude (decimal degrees): 8.000";
  p.file = write(text.replace(text.find(here), here.size(), "Longitude (decimal degrees): 135.0"));
  const auto noon = [&] {
    const auto weather = make_weather(p, ".");
    double best = 0, when = 0;
    for (int h = 0; h < 24; ++h)
      if (const double sum = weather->irradiation(h * 3600., h * 3600. + 3600); sum > best)
        best = sum, when = h;
    return when;
  };
  EXPECT_EQ(noon(), 19) << "10 UTC";
  EXPECT_THAT(make_weather(p, ".")->warnings().back(), HasSubstr("the simulation's is +9 h ahead"));
  p.shift_hours = 0;
  EXPECT_EQ(noon(), 10);
}

TEST_F(ForeignWeather, wrong_pvgis_files_are_said_with_their_line) {
  EXPECT_THAT(complaint(pvgis([](int h, std::string line) { return h == 24 ? "\n" + line : line; })),
              HasSubstr("a record after the empty line 42, which ends"));
  EXPECT_THAT(complaint(pvgis([](int h, std::string line) {
                return h == 2 ? "2009-01-01,1,90,0,0,0,320,2,334,99573\n" : line;
              })),
              HasSubstr("weather.csv:20: '2009-01-01' is not a time"));
  EXPECT_THAT(
      complaint(pvgis([](int h, std::string line) { return h == 2 ? "20090101:0200,1,90,0\n" : line; })),
      HasSubstr("weather.csv:20: 4 values"));
  EXPECT_THAT(complaint("Latitude (decimal degrees):\t45\nLongitude (decimal "
                        "degrees):\t8\n\ntime,G(i),H_sun,T2m\n20050101:0010,0,0,1\n"),
              HasSubstr("weather.csv:1: the line 'time(UTC)"));
  EXPECT_THAT(complaint("{}", "year.json"), HasSubstr("year.json:1: JSON is not supported"));
}

}  // namespace
}  // namespace couplet::thermocline::weather_formats_test
