// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "thermocline/weather/weather_hours.hpp"

namespace couplet::thermocline {

/// Which columns of a foreign file hold the quantities, by the names they are known under (without regard to
/// case). Humidity may be missing where there is a dew point.
class WeatherColumns {
 public:
  struct Names {
    std::array<std::vector<std::string_view>, 5> of;  ///< in the order of weather_quantities
    std::vector<std::string_view> dew_point;          ///< [degC]
    double pressure_factor = 1;                       ///< to Pa
    double missing_below = -90;  ///< codes for "missing", as -9999 or -9900 [file's unit]
  };
  /// Throws Error naming `place` for a head without one of the quantities.
  WeatherColumns(const std::vector<std::string>& head, const Names& names, const std::string& place);

  /// Values of a record in the units of weather_quantities; NaN for missing ones.
  std::array<double, 5> values(const std::vector<std::string>& fields, const std::string& place) const;

 private:
  Names names_;
  std::array<std::optional<std::size_t>, 5> column_;
  std::optional<std::size_t> dew_point_;
  std::size_t n_;
};

/// Where `name` stands in a head, without regard to case and surrounding blanks.
std::optional<std::size_t> column_of(const std::vector<std::string>& head, std::string_view name);

/// A whole number in a field of a record; throws Error naming `place` and `name`.
int whole_number(const std::vector<std::string>& fields, std::size_t column, std::string_view name,
                 const std::string& place);

/// Hour of a year of 365 days from month, day and hour (0 to 23); nothing for 29 February, which a reference
/// year has not. Throws Error naming `place`.
std::optional<int> hour_of_year(int month, int day, int hour, const std::string& place);

/// Site from latitude and longitude [deg] and hours ahead of Greenwich; throws Error for what is no place on
/// earth.
WeatherHours::Site site_of(double latitude, double longitude, double time_zone, const std::string& place);

}  // namespace couplet::thermocline
