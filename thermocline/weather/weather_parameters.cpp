// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {
namespace {

std::string wrong_date(const std::string& date) {
  try {
    day_of_year(date);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void declare_period(config::Section& s, WeatherParameters& p) {
  s.value("from", p.from).doc("the simulation starts at 00:00 of this day, MM-DD");
  s.value("to", p.to)
      .doc(
          "after this day, MM-DD, the weather repeats from that of 'from'; it may lie in the next year; "
          "absent: the year (or the file) repeats");
  s.check([&] { return wrong_date(p.from); }, "from");
  s.check([&] { return p.to.empty() ? "" : wrong_date(p.to); }, "to");
}

void declare_file(config::Section& s, WeatherParameters& p) {
  s.value("file", p.file)
      .required()
      .doc(
          "hourly weather: a CSV, plain or compressed, with the columns hour (of the year, from 0), "
          "dni_W_m2 (mean of the hour), T_degC, wind_m_s, rh_pct, p_Pa; 'couplet weather FILE' makes it "
          "of EPW, SAM, NSRDB, TMY3, PVGIS and other tables");
  s.value("shift", p.shift_hours)
      .range(-12, 12)
      .doc("whole hours by which the simulation's clock is ahead of the file's");
  s.check([&p] { return p.shift_hours == std::floor(p.shift_hours) ? "" : "is a whole number of hours"; },
          "shift");
  s.choice("days", p.mean_days, {{"as-recorded", false}, {"monthly-mean", true}})
      .doc(
          "monthly-mean: each hour has the mean irradiance of that hour in its month, as in tables of "
          "average days");
  declare_section(s, "site", p.site,
                  "for files without a location, to determine the sun's height (solar-absorptance)");
  declare_period(s, p);
}

void declare_air(config::Section& s, ClearSky& sky) {
  s.value("altitude", sky.altitude).unit("m").range(0, 2500).doc("altitude of the site");
  s.value("coldest", sky.coldest).unit("K").range(200, 340).doc("temperature of the air at 03:00");
  s.value("warmest", sky.warmest).unit("K").range(200, 340).doc("temperature of the air at 15:00");
  s.value("wind", sky.wind).unit("m/s").range(0, 80).doc("wind speed");
  s.value("humidity", sky.humidity).range(0, 1).doc("relative humidity of the air");
}

void declare_smooth_days(config::Section& s, WeatherParameters& p) {
  SmoothDays& d = p.smooth;
  s.value("latitude", d.latitude)
      .unit("deg")
      .range(-90, 90)
      .required()
      .doc("latitude of the site, north positive; it determines the length of the days");
  s.value("daily-sums", d.daily_sums)
      .unit("J/m^2")
      .plausible(1e5, 5e7)
      .required()
      .doc("mean daily direct normal irradiation of the 12 months, for example 7.2 kWh/m^2");
  s.value("form-n", d.n).doc("n of (1 - |2 t/T|^n)^p, one value or 12: 1 a peak, 2 round, large: a box");
  s.value("form-p", d.p).doc("p of the same expression: small: steep sides, large: a narrow bell");
  s.value("day-length", d.length).doc("T over the time from sunrise to sunset, one value or 12");
  for (const char* name : {"daily-sums", "form-n", "form-p", "day-length"})
    s.check(
        [&d, name] {
          std::string about;
          const std::string problem = problem_of(d, about);
          return about == name ? problem : "";
        },
        name);
  s.value("air", p.file)
      .doc("a weather file for air, wind, humidity and pressure; absent: the following keys");
  declare_air(s, p.sky);
  declare_period(s, p);
}

void declare_clear_sky(config::Section& s, WeatherParameters& p) {
  s.value("latitude", p.sky.latitude)
      .unit("deg")
      .range(-90, 90)
      .required()
      .doc("latitude of the site, north positive; it determines the sun of cloudless days");
  declare_air(s, p.sky);
  declare_period(s, p);
}

void declare_constant(config::Section& s, WeatherParameters& p) {
  Ambient& a = p.constant;
  s.value("dni", a.dni).unit("W/m^2").range(0, 1412).doc("direct normal irradiance, day and night");
  s.value("temperature", a.temperature).unit("K").range(200, 340).doc("temperature of the air");
  s.value("wind", a.wind).unit("m/s").range(0, 80).doc("wind speed");
  s.value("humidity", a.humidity).range(0, 1).doc("relative humidity of the air");
  s.value("pressure", a.pressure).unit("Pa").range(40000, 110000).doc("pressure of the air");
}

WeatherHours constant_year(const WeatherParameters& p) {
  WeatherHours year;
  year.source = "constant weather";
  year.state_offset = 0;
  constexpr std::size_t n = days_a_year * hours_a_day;
  year.dni.assign(n, p.constant.dni);
  year.temperature.assign(n, celsius(p.constant.temperature));
  year.wind.assign(n, p.constant.wind);
  year.humidity.assign(n, p.constant.humidity);
  year.pressure.assign(n, p.constant.pressure);
  return year;
}

WeatherHours record_of(const WeatherParameters& p, const std::filesystem::path& case_folder) {
  if (p.kind == WeatherKind::file) {
    WeatherHours record = read_weather(case_folder / p.file);
    constexpr double hour = 3600;
    if (p.site) {
      const WeatherHours::Site given = site_of(p.site->latitude, p.site->longitude, p.site->time_zone);
      constexpr double close = 0.1, close_time = 360;  // [deg], [s]
      if (record.site && (std::abs(given.latitude - record.site->latitude) > close ||
                          std::abs(given.solar_ahead - record.site->solar_ahead) > close_time))
        record.doubts.push_back(fmt::format(
            "{}: 'site' (latitude {:g} deg, solar time {:+.2f} h against the clock) replaces the file's "
            "own (latitude {:g} deg, {:+.2f} h)",
            record.source, given.latitude, given.solar_ahead / hour, record.site->latitude,
            record.site->solar_ahead / hour));
      record.site = given;
    }
    for (const std::string& doubt : doubts_about_sun(record)) record.doubts.push_back(doubt);
    return p.mean_days ? with_mean_days(std::move(record)) : record;
  }
  if (p.kind == WeatherKind::smooth_days) {
    ClearSky sky = p.sky;
    sky.latitude = p.smooth.latitude;
    WeatherHours record =
        with_smooth_days(p.file.empty() ? clear_sky_year(sky) : read_weather(case_folder / p.file), p.smooth);
    if (p.file.empty()) record.source = "smooth days";
    return record;
  }
  return p.kind == WeatherKind::clear_sky ? clear_sky_year(p.sky) : constant_year(p);
}

}  // namespace

void declare(config::Section& s, SiteParameters& p) {
  s.value("latitude", p.latitude).unit("deg").range(-90, 90).required().doc("north positive");
  s.value("longitude", p.longitude).unit("deg").range(-180, 180).required().doc("east positive");
  s.value("time-zone", p.time_zone)
      .range(-14, 14)
      .required()
      .doc("hours by which the file's clock is ahead of Greenwich");
}

void declare(config::Section& section, WeatherParameters& p) {
  section.variant<WeatherKind>(
      "type", p.kind,
      {{"constant", WeatherKind::constant, [&](config::Section& s) { declare_constant(s, p); }},
       {"file", WeatherKind::file, [&](config::Section& s) { declare_file(s, p); }},
       {"clear-sky", WeatherKind::clear_sky, [&](config::Section& s) { declare_clear_sky(s, p); }},
       {"smooth-days", WeatherKind::smooth_days, [&](config::Section& s) { declare_smooth_days(s, p); }}},
      "source of sun and air");
}

std::unique_ptr<Weather> make_weather(const WeatherParameters& p, const std::filesystem::path& case_folder) {
  WeatherPeriod period{day_of_year(p.from), {}};
  if (!p.to.empty()) period.to = day_of_year(p.to);
  return std::make_unique<Weather>(record_of(p, case_folder), period, int(p.shift_hours));
}

}  // namespace couplet::thermocline
