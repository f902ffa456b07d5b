// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather_parameters.hpp"

#include "common/base/error.hpp"
#include "thermocline/celsius.hpp"
#include "thermocline/weather_date.hpp"

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
          "after this day, MM-DD, the weather begins again with that of 'from'; it may lie in the next year; "
          "without it: "
          "the year (or the file) goes round");
  s.check([&] { return wrong_date(p.from); }, "from");
  s.check([&] { return p.to.empty() ? "" : wrong_date(p.to); }, "to");
}

void declare_file(config::Section& s, WeatherParameters& p) {
  s.value("file", p.file)
      .required()
      .doc(
          "hourly weather: EnergyPlus (.epw) or CSV with the columns hour (of the year, from 0), dni_W_m2 "
          "(mean of the "
          "hour), T_degC, wind_m_s, rh_pct, p_Pa; either may be compressed (.gz)");
  s.value("shift", p.shift_hours)
      .range(-12, 12)
      .doc("hours by which the simulation's clock is ahead of the file's");
  s.choice("days", p.mean_days, {{"as-recorded", false}, {"monthly-mean", true}})
      .doc(
          "monthly-mean: each hour has the mean irradiance of that hour in its month, as tables of average "
          "days give it");
  declare_period(s, p);
}

void declare_clear_sky(config::Section& s, WeatherParameters& p) {
  s.value("latitude", p.sky.latitude)
      .unit("deg")
      .range(-90, 90)
      .required()
      .doc("of the site, north positive; the sun of cloudless days follows from it");
  s.value("altitude", p.sky.altitude).unit("m").range(0, 2500).doc("of the site above the sea");
  s.value("coldest", p.sky.coldest).unit("K").range(200, 340).doc("temperature of the air at 03:00");
  s.value("warmest", p.sky.warmest).unit("K").range(200, 340).doc("temperature of the air at 15:00");
  s.value("wind", p.sky.wind).unit("m/s").range(0, 80).doc("speed of the wind");
  s.value("humidity", p.sky.humidity).range(0, 1).doc("relative humidity of the air");
  declare_period(s, p);
}

void declare_constant(config::Section& s, WeatherParameters& p) {
  Ambient& a = p.constant;
  s.value("dni", a.dni).unit("W/m^2").range(0, 1412).doc("direct normal irradiance, day and night");
  s.value("temperature", a.temperature).unit("K").range(200, 340).doc("of the air");
  s.value("wind", a.wind).unit("m/s").range(0, 80).doc("speed of the wind");
  s.value("humidity", a.humidity).range(0, 1).doc("relative humidity of the air");
  s.value("pressure", a.pressure).unit("Pa").range(40000, 110000).doc("of the air");
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
    return p.mean_days ? with_mean_days(std::move(record)) : record;
  }
  return p.kind == WeatherKind::clear_sky ? clear_sky_year(p.sky) : constant_year(p);
}

}  // namespace

void declare(config::Section& section, WeatherParameters& p) {
  section.variant<WeatherKind>(
      "type", p.kind,
      {{"constant", WeatherKind::constant, [&](config::Section& s) { declare_constant(s, p); }},
       {"file", WeatherKind::file, [&](config::Section& s) { declare_file(s, p); }},
       {"clear-sky", WeatherKind::clear_sky, [&](config::Section& s) { declare_clear_sky(s, p); }}},
      "where the sun and the air come from");
}

std::unique_ptr<Weather> make_weather(const WeatherParameters& p, const std::filesystem::path& case_folder) {
  const WeatherHours record = record_of(p, case_folder);
  WeatherPeriod period{day_of_year(p.from), {}};
  if (!p.to.empty()) period.to = day_of_year(p.to);
  return std::make_unique<Weather>(record, period, p.shift_hours);
}

}  // namespace couplet::thermocline
