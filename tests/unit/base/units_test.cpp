// SPDX-License-Identifier: Apache-2.0
#include "common/base/units.hpp"
#include "tests/support/test.hpp"

namespace couplet::units_test {
using namespace base;

struct Case {
  const char* text;
  const char* unit;
  double value;
};

TEST(Units, quantities_convert_to_the_unit_of_the_key) {
  const Case cases[] = {
      {"5.6 MPa", "Pa", 5.6e6},
      {"5.6MPa", "Pa", 5.6e6},
      {"2.1e11", "Pa", 2.1e11},
      {"1 N/mm^2", "Pa", 1e6},
      {"1 bar", "Pa", 1e5},
      {"100 mbar", "Pa", 1e4},
      {"0.1 s", "s", 0.1},
      {"10 ms", "s", 0.01},
      {"2 min", "s", 120},
      {"1.5 h", "s", 5400},
      {"1 day", "s", 86400},
      {"1e-3 m^2/s", "m^2/s", 1e-3},
      {"1 cm2/s", "m^2/s", 1e-4},
      {"1 mm²", "m^2", 1e-6},
      {"3 g/cm^3", "kg/m^3", 3000},
      {"1 t/m³", "kg/m^3", 1000},
      {"1 kPa s", "Pa s", 1000},
      {"1 kPa*s", "Pa s", 1000},
      {"1 kPa·s", "Pa s", 1000},
      {"0.5 W/(m K)", "W/(m K)", 0.5},
      {"0.5 W/m/degC", "W/(m K)", 0.5},
      {"20 degC", "K", 293.15},
      {"68 degF", "K", 293.15},
      {"-459.67 degF", "degC", -273.15},
      {"9 W/(m degF)", "W/(m K)", 16.2},
      {"1 mmHg", "Pa", 133.322387415},
      {"2 cmH2O s/m^3", "Pa s/m^3", 196.133},
      {"1 mmH2O^2", "Pa^2", 96.1703842225},
      {"14.5 psi", "kPa", 99.97398075094123},
      {"3 cP", "Pa s", 3e-3},
      {"-10 degC", "K", 263.15},
      {"293.15 K", "degC", 20},
      {"20", "degC", 20},
      {"1 1/K", "1/K", 1},
      {"1 /K", "1/K", 1},
      {"1e-5 degC^-1", "1/K", 1e-5},
      {"3 Hz", "1/s", 3},
      {"2 kHz", "Hz", 2000},
      {"180 deg", "rad", std::numbers::pi},
      {"50 %", "", 0.5},
      {"+4", "", 4},
      {".5 m", "m", 0.5},
      {"3 um", "m", 3e-6},
      {"3 µm", "m", 3e-6},
      {"1 kWh", "J", 3.6e6},
      {"1 l", "m^3", 1e-3},
      {"1 kN/m", "kg/s^2", 1000},
      {"36 km/h", "m/s", 10},
      {"  7   s ", "s", 7},
  };
  for (const Case& c : cases)
    EXPECT_NEAR(parse_quantity(c.text, c.unit), c.value, 1e-12 * std::abs(c.value))
        << c.text << " in " << c.unit;
}

std::string error_of(const char* text, const char* unit) {
  return support::error_of([&] { parse_quantity(text, unit); });
}

TEST(Units, what_does_not_convert_is_refused_with_what_was_expected) {
  EXPECT_EQ(error_of("5 kg", "Pa"),
            "'5 kg': the unit 'kg' is not convertible to Pa. Expected Pa or a unit convertible to it.");
  EXPECT_EQ(error_of("5 MPaa", "Pa"),
            "'5 MPaa': unknown unit 'MPaa'. Did you mean 'MPa'? Expected Pa or a unit convertible to it.");
  EXPECT_EQ(error_of("5 furlong", "m"),
            "'5 furlong': unknown unit 'furlong'. Expected m or a unit convertible to it.");
  EXPECT_EQ(error_of("120 C", "K"),
            "'120 C': unknown unit 'C'. Did you mean 'degC'? Expected K or a unit convertible to it.");
  EXPECT_EQ(error_of("120 mmhg", "Pa"),
            "'120 mmhg': unknown unit 'mmhg'. Did you mean 'mmHg'? Expected Pa or a unit convertible to it.");
  EXPECT_EQ(error_of("18 degF", kelvin_difference.data()),
            "'18 degF' is a temperature, but a temperature difference is expected: write 10 K.");
  EXPECT_EQ(error_of("soft", "Pa"), "'soft' is not a number; expected a number in Pa or with its unit.");
  EXPECT_EQ(error_of("5 s", ""), "'5 s' contains more than a number ('s'); expected a plain number.");
  EXPECT_EQ(error_of("1,5 m", "m"), "'1,5 m' has a decimal comma; use a decimal point.");
  EXPECT_EQ(error_of("5 m?", "m"),
            "'5 m?': cannot parse the unit 'm?' at '?'. Expected m or a unit convertible to it.");
  EXPECT_EQ(error_of("5 m/", "m"),
            "'5 m/': the unit 'm/' is incomplete. Expected m or a unit convertible to it.");
  EXPECT_EQ(error_of("5 W/(m K", "W/(m K)"),
            "'5 W/(m K': the unit 'W/(m K' is incomplete. Expected W/(m K) or a unit convertible to it.");
  for (const char* text : {"nan", "inf", "-inf", "", "0x10", "--5", "1e999"})
    EXPECT_NE(error_of(text, ""), "") << text;
}

TEST(Units, a_formatted_quantity_reads_back_as_the_same_number) {
  for (const double value : {0.1, 1.0 / 3, 5.6e6, -1e-30, 0.0})
    EXPECT_EQ(parse_quantity(format_quantity(value, "Pa"), "Pa"), value);
  EXPECT_EQ(format_quantity(0.25, ""), "0.25");
  EXPECT_EQ(format_quantity(5.6e6, "Pa"), "5600000 Pa");
}

}  // namespace couplet::units_test
