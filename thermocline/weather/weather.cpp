// SPDX-License-Identifier: Apache-2.0
#include "thermocline/weather/weather.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "common/base/error.hpp"
#include "thermocline/material/numerics.hpp"
#include "thermocline/material/properties.hpp"

namespace couplet::thermocline {

namespace {

/// Monotonized central difference: zero at an extremum, at most twice a one-sided difference.
double limited_slope(double before, double here, double after) {
  const double left = here - before, right = after - here;
  if (left * right <= 0) return 0;
  const double size = std::min({2 * std::abs(left), 2 * std::abs(right), std::abs(left + right) / 2});
  return std::copysign(size, left);
}

/// Sine of the sun's height at a time [s] of the clock that starts at 00:00 of `first_day`.
double sun_over(const WeatherHours::Site& site, int first_day, double clock) {
  const double solar = clock + site.solar_ahead, whole_days = std::floor(solar / seconds_a_day);
  return sine_of_sun_height(site.latitude, first_day + int(whole_days),
                            (solar - whole_days * seconds_a_day) / seconds_an_hour);
}

/// Hour of the record for each hour of the period.
std::vector<std::size_t> chosen_hours(const WeatherHours& record, const WeatherPeriod& period) {
  const int first = record.first_day, days = record.days();
  const bool whole_year = days == days_a_year;
  const int begin = period.from;
  int count = whole_year ? days_a_year : std::max(1, first + days - begin);
  if (period.to) count = (*period.to - begin + days_a_year) % days_a_year + 1;
  for (int d = 0; d < count; ++d) {
    const int day = (begin + d) % days_a_year;
    if (day < first || day >= first + days)
      throw Error("{}: this file has no weather for {}; it covers {} to {}.", record.source, date_of_day(day),
                  date_of_day(first), date_of_day(first + days - 1));
  }
  const int n = days * hours_a_day;
  std::vector<std::size_t> chosen;
  for (int h = 0; h < count * hours_a_day; ++h) {
    const int in_year = (begin * hours_a_day + h) % (days_a_year * hours_a_day) - first * hours_a_day;
    chosen.push_back(static_cast<std::size_t>((in_year % n + n) % n));
  }
  return chosen;
}

/// Doubt about a record without a site. With the angle of the clock from noon, the irradiance has the mean exp(i angle) = R exp(i off).
/// Days of equal sun over the length T have R = sin(x)/x with x = pi T/24: 0.64 for 12 h, 0.3 for 18 h, 0 for 24 h.
std::vector<std::string> sun_at_night(const WeatherHours& record) {
  constexpr double least = 0.3;
  std::complex<double> sum = 0;
  double total = 0;
  for (std::size_t h = 0; h < record.dni.size(); ++h) {
    const double from_noon = double(h % hours_a_day) + 0.5 - 12;
    sum += std::polar(record.dni[h], from_noon * std::numbers::pi / 12);
    total += record.dni[h];
  }
  if (total == 0 || (std::abs(sum) >= least * total && sum.real() > 0)) return {};
  return {fmt::format(
      "{}: the sun shines at night, with irradiance in {} of {} hours{}. Check the column dni_W_m2, and that the hours are "
      "local time; the lines latitude, longitude and time-zone let the run judge better",
      record.source, std::ranges::count_if(record.dni, [](double dni) { return dni > 0; }), record.dni.size(),
      std::abs(sum) < least * total
          ? ""
          : fmt::format(" and its mean {:.1f} h from noon", std::arg(sum) * 12 / std::numbers::pi))};
}

}  // namespace

std::vector<std::string> check_sun(const WeatherHours& record) {
  constexpr std::size_t fortnight = 14 * hours_a_day;
  if (record.dni.size() >= fortnight && *std::max_element(record.dni.begin(), record.dni.end()) <= 0)
    return {fmt::format("{}: no direct irradiance in any of its {} days", record.source, record.days())};
  if (!record.site) return sun_at_night(record);
  constexpr double hour = 3600;         // [s]
  constexpr double farthest_clock = 3;  // [h]: 45 degrees
  // A degree below the horizon: refraction and the size of the sun's disc.
  constexpr double horizon = -0.02, most_in_the_dark = 0.01;
  std::vector<std::string> all;
  const WeatherHours::Site& site = *record.site;
  const double ahead = site.solar_ahead / hour;
  if (std::abs(ahead) > farthest_clock)
    all.push_back(fmt::format(
        "{}: the solar time of its longitude is {:.1f} h {} its time zone: is the sign of longitude or time zone wrong?",
        record.source, std::abs(ahead), ahead > 0 ? "ahead of" : "behind"));
  double total = 0, dark = 0;
  for (std::size_t h = 0; h < record.dni.size(); ++h) {
    if (record.dni[h] <= 0) continue;
    double highest = -1;
    for (const double part : {0.0, 0.5, 1.0})
      highest = std::max(highest, sun_over(site, record.first_day, (double(h) + part) * hour));
    total += record.dni[h];
    if (highest < horizon) dark += record.dni[h];
  }
  if (dark > most_in_the_dark * total)
    all.push_back(fmt::format(
        "{}: {:.0f} % of the irradiation is in hours with the sun below the horizon at latitude {:g} "
        "deg: latitude, longitude and time zone do not match this record",
        record.source, 100 * dark / total, site.latitude));
  return all;
}

Weather::Weather(const WeatherHours& record, const WeatherPeriod& period) : first_day_(period.from) {
  const std::vector<std::size_t> chosen = chosen_hours(record, period);
  hours_.source = record.source;
  hours_.state_offset = record.state_offset;
  hours_.site = record.site;
  hours_.warnings = record.warnings;
  hours_.doubts = record.doubts;
  mean_temperature_ = kelvin(std::accumulate(record.temperature.begin(), record.temperature.end(), 0.) /
                             double(record.temperature.size()));
  for (const auto quantity :
       {&WeatherHours::dni, &WeatherHours::temperature, &WeatherHours::wind, &WeatherHours::pressure})
    for (const std::size_t h : chosen) (hours_.*quantity).push_back((record.*quantity)[h]);
  const std::vector<double>& dni = hours_.dni;
  const std::size_t n = dni.size();
  cumulated_.assign(n + 1, 0);
  for (std::size_t h = 0; h < n; ++h) {
    slope_.push_back(limited_slope(dni[(h + n - 1) % n], dni[h], dni[(h + 1) % n]));
    cumulated_[h + 1] = cumulated_[h] + dni[h] * seconds_an_hour;
  }
}

double Weather::wrapped(double t) const {
  const double length = period_length();
  const double in = t - length * std::floor(t / length);
  return in < length ? in : 0;
}

double Weather::state(const std::vector<double>& values, double t) const {
  const std::size_t n = values.size();
  const double position = wrapped(t - hours_.state_offset) / seconds_an_hour;
  const auto h = std::min(static_cast<std::size_t>(position), n - 1);
  const double share = position - double(h);
  return (1 - share) * values[h] + share * values[(h + 1) % n];
}

Ambient Weather::at(double t) const {
  const double position = wrapped(t) / seconds_an_hour;
  const auto h = std::min(static_cast<std::size_t>(position), hours_.dni.size() - 1);
  Ambient ambient;
  ambient.dni = hours_.dni[h] + slope_[h] * (position - double(h) - 0.5);
  ambient.temperature = kelvin(state(hours_.temperature, t));
  ambient.wind = state(hours_.wind, t);
  ambient.pressure = state(hours_.pressure, t);
  return ambient;
}

/// Within the first period: integral of the line mean + slope (x - 1/2), x the elapsed share of the hour.
double Weather::irradiation_since_start(double t) const {
  const double position = t / seconds_an_hour;
  const auto h = std::min(static_cast<std::size_t>(position), hours_.dni.size() - 1);
  const double x = position - double(h);
  return cumulated_[h] + seconds_an_hour * x * (hours_.dni[h] + slope_[h] * (x - 1) / 2);
}

double Weather::irradiation(double from, double to) const {
  const double length = period_length();
  const double rounds = std::floor(to / length) - std::floor(from / length);
  return rounds * cumulated_.back() + irradiation_since_start(wrapped(to)) -
         irradiation_since_start(wrapped(from));
}

std::string Weather::date(double t) const {
  return date_of_day(first_day_ + static_cast<int>(std::floor(wrapped(t) / (hours_a_day * seconds_an_hour))));
}

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
          "default: the year (or the file) repeats");
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
  declare_period(s, p);
}

void declare_air(config::Section& s, ClearSky& sky) {
  s.value("altitude", sky.altitude).unit("m").range(0, 2500).doc("altitude of the site");
  s.value("temperature", sky.temperature)
      .unit("K")
      .range(200, 340)
      .doc("mean temperature of the air, which is 8 K warmer at 15:00 and colder at 03:00");
  s.value("wind", sky.wind).unit("m/s").range(0, 80).doc("wind speed");
}

void declare_smooth_days(config::Section& s, WeatherParameters& p) {
  SmoothDays& d = p.smooth;
  s.value("latitude", d.latitude)
      .unit("deg")
      .range(-90, 90)
      .required()
      .doc("latitude of the site, north positive; it determines the length of the days");
  s.value("daily-sums", d.daily_sums)
      .unit("J/m^2", 1e5, 5e7)
      .required()
      .doc("mean daily direct normal irradiation of the 12 months, for example 7.2 kWh/m^2");
  s.value("form-n", d.n).doc("n of (1 - |2 t/T|^n)^p, one value or 12: 1 is a peak, 2 is round, 9 is a box");
  s.value("form-p", d.p).doc("p of the same expression: the sides are steep if it is small");
  s.value("day-length", d.length).doc("T divided by the time from sunrise to sunset, one value or 12");
  for (const char* name : {"daily-sums", "form-n", "form-p", "day-length"})
    s.check(
        [&d, name] {
          std::string about;
          const std::string problem = problem_of(d, about);
          return about == name ? problem : "";
        },
        name);
  s.value("air", p.file).doc("a weather file for air, wind and pressure; default: the following keys");
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
  year.pressure.assign(n, p.constant.pressure);
  return year;
}

WeatherHours record_of(const WeatherParameters& p, const std::filesystem::path& case_folder) {
  if (p.kind == WeatherKind::file) {
    WeatherHours record = read_weather(case_folder / p.file);
    for (const std::string& doubt : check_sun(record)) record.doubts.push_back(doubt);
    return record;
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

void declare(config::Section& section, WeatherParameters& p) {
  section.variant<WeatherKind>(
      "type", p.kind,
      {{"constant", WeatherKind::constant, [&](config::Section& s) { declare_constant(s, p); }},
       {"file", WeatherKind::file, [&](config::Section& s) { declare_file(s, p); }},
       {"clear-sky", WeatherKind::clear_sky, [&](config::Section& s) { declare_clear_sky(s, p); }},
       {"smooth-days", WeatherKind::smooth_days, [&](config::Section& s) { declare_smooth_days(s, p); }}},
      "source of the sun and air data");
}

std::unique_ptr<Weather> make_weather(const WeatherParameters& p, const std::filesystem::path& case_folder) {
  WeatherPeriod period{day_of_year(p.from), {}};
  if (!p.to.empty()) period.to = day_of_year(p.to);
  return std::make_unique<Weather>(record_of(p, case_folder), period);
}

}  // namespace couplet::thermocline
