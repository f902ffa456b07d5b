// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermocline/weather/clear_sky.hpp"
#include "thermocline/weather/weather_date.hpp"
#include "thermocline/weather/weather_hours.hpp"

namespace couplet::thermocline {

std::vector<std::string> doubts_about_sun(const WeatherHours& record) {
  constexpr std::size_t fortnight = 14 * hours_a_day;
  if (record.dni.size() >= fortnight && *std::max_element(record.dni.begin(), record.dni.end()) <= 0)
    return {fmt::format("{}: no direct irradiance in any of its {} days", record.source, record.days())};
  if (!record.site) return {};
  constexpr double hour = 3600, day = hours_a_day * hour;  // [s]
  constexpr double farthest_clock = 3;                     // [h]: 45 degrees
  // A degree below the horizon: refraction and the size of the sun's disc.
  constexpr double horizon = -0.02, most_in_the_dark = 0.01;
  std::vector<std::string> all;
  const WeatherHours::Site& site = *record.site;
  const double ahead = site.solar_ahead / hour - record.local_ahead;
  if (std::abs(ahead) > farthest_clock)
    all.push_back(fmt::format(
        "{}: the solar time of its longitude is {:.1f} h {} its time zone: is the sign of longitude or time "
        "zone wrong?",
        record.source, std::abs(ahead), ahead > 0 ? "ahead of" : "behind"));
  double total = 0, dark = 0;
  for (std::size_t h = 0; h < record.dni.size(); ++h) {
    if (record.dni[h] <= 0) continue;
    double highest = -1;
    for (const double part : {0.0, 0.5, 1.0}) {
      const double solar = (double(h) + part) * hour + site.solar_ahead, whole_days = std::floor(solar / day);
      highest = std::max(highest, sine_of_sun_height(site.latitude, record.first_day + int(whole_days),
                                                     (solar - whole_days * day) / hour));
    }
    total += record.dni[h];
    if (highest < horizon) dark += record.dni[h];
  }
  if (dark > most_in_the_dark * total)
    all.push_back(fmt::format(
        "{}: {:.0f} % of the irradiation is in hours with the sun below the horizon at latitude {:g} deg: "
        "latitude, longitude and time zone do not match this record",
        record.source, 100 * dark / total, site.latitude));
  return all;
}

}  // namespace couplet::thermocline
