// SPDX-License-Identifier: Apache-2.0
#include "common/fv/table.hpp"

#include <sys/stat.h>

#include "common/config/load.hpp"
#include "common/fv/expression.hpp"
#include "tests/support/test.hpp"

namespace couplet::table_test {
using namespace fv;

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Outside = Table::Outside;

double value_of(const std::string& text, const Vec3& x, double t) {
  return Expression(config::ExpressionText{text}, "value")(x, t);
}

/// A CSV file of the test's own.
class CsvFile {
 public:
  explicit CsvFile(const std::string& text)
      : path_(std::filesystem::temp_directory_path() / fmt::format("couplet-table-{}.csv", getpid())) {
    std::ofstream(path_) << text;
  }
  ~CsvFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }
  std::string name() const { return path_.filename().string(); }
  std::filesystem::path folder() const { return path_.parent_path(); }

 private:
  std::filesystem::path path_;
};

TEST(Table, is_linear_between_its_places_and_holds_its_ends) {
  const Table table({1, 2, 4}, {10, 20, -20}, Outside::clamp, "");
  EXPECT_EQ(table(1.5), 15);
  EXPECT_EQ(table(2), 20);
  EXPECT_EQ(table(3), 0);
  EXPECT_EQ(table(-5), 10);
  EXPECT_EQ(table(9), -20);
}

TEST(Table, integral_is_exact_inside_and_beyond_the_ends) {
  const Table table({0, 2, 4}, {0, 4, 0}, Outside::clamp, "");
  EXPECT_DOUBLE_EQ(table.integral(0, 4), 8);
  EXPECT_DOUBLE_EQ(table.integral(1, 3), 6);
  EXPECT_DOUBLE_EQ(table.integral(3, 1), -6);
  const Table ends({1, 2}, {3, 5}, Outside::clamp, "");
  EXPECT_DOUBLE_EQ(ends.integral(-1, 4), 6 + 4 + 10);
}

TEST(Table, refuses_values_outside_when_told_so_and_places_that_do_not_grow) {
  const Table table({0, 1}, {0, 1}, Outside::error, "inlet");
  EXPECT_THAT([&] { table(1.5); }, ThrowsMessage<Error>(HasSubstr("inlet: the table covers 0 to 1")));
  EXPECT_THAT(
      [] {
        Table({0, 1, 1}, {0, 0, 0}, Outside::clamp, "");
      },
      ThrowsMessage<Error>(HasSubstr("must increase, but 1 is followed by 1")));
}

TEST(Table, is_a_function_in_expressions) {
  EXPECT_DOUBLE_EQ(value_of("2*table(t, 0, 1, 10, 2) + x", Vec3(3, 0, 0), 5), 6);
  EXPECT_DOUBLE_EQ(value_of("table(sqrt(x^2 + y^2), 0, 0, 10, 100)", Vec3(3, 4, 0), 0), 50);
  EXPECT_DOUBLE_EQ(value_of("table(table(t, 0, 0, 1, 10), 0, 1, 10, 2)", Vec3::Zero(), 0.5), 1.5);
  const Expression f(config::ExpressionText{"table(z, clamp, 0, 1, 2, 3)"});
  EXPECT_TRUE(f.uses_space());
  EXPECT_FALSE(f.uses_time());
  EXPECT_FALSE(f.is_zero());
}

TEST(Table, mistakes_in_expressions_are_reported_with_their_column) {
  EXPECT_THAT([] { value_of("3 + table(t, 0, 1, 2)", Vec3::Zero(), 0); },
              ThrowsMessage<Error>(HasSubstr("a table needs pairs")));
  EXPECT_THAT([] { value_of("table(t, 0, q)", Vec3::Zero(), 0); },
              ThrowsMessage<Error>(HasSubstr("at column 13: a table contains numbers, not 'q'")));
  EXPECT_THAT([] { value_of("table(t, 0, 1, 5, 2) + u", Vec3::Zero(), 0); },
              ThrowsMessage<Error>(HasSubstr("column 24: unknown name 'u'")));
  EXPECT_THAT([] { value_of("table(t, error, 0, 1, 5, 2)", Vec3::Zero(), 6); },
              ThrowsMessage<Error>(HasSubstr("its value at 6 is needed")));
}

TEST(Table, is_read_from_a_file_by_name_or_number_of_its_column) {
  const CsvFile file("# weather\nhour, dni, temperature\n0, 0, 10\n12, 800, 30 # noon\n24, 0, 10\n");
  const std::string path = file.path();
  EXPECT_DOUBLE_EQ(value_of("table(t/3600, \"" + path + "\", \"temperature\")", Vec3::Zero(), 6 * 3600), 20);
  EXPECT_DOUBLE_EQ(value_of("table(t, \"" + path + "\")", Vec3::Zero(), 18), 400);
  EXPECT_DOUBLE_EQ(value_of("table(t, \"" + path + "\", 3)", Vec3::Zero(), 18), 20);
  EXPECT_THAT([&] { read_table(path, "temprature", Outside::clamp); },
              ThrowsMessage<Error>(HasSubstr("Did you mean 'temperature'?")));
  EXPECT_THAT([] { read_table("nowhere.csv", "2", Outside::clamp); },
              ThrowsMessage<Error>(HasSubstr("nowhere.csv: this table does not exist")));
}

/// A load of 5 in place of 2000.5 Pa.
TEST(Table, with_decimal_commas_is_refused_with_its_line) {
  const CsvFile file("t;p\n0,0;1000,5\n1,5;2000,5\n");
  EXPECT_THAT([&] { value_of("table(t, \"" + file.path() + "\", \"p\")", Vec3::Zero(), 1); },
              ThrowsMessage<Error>(
                  HasSubstr(file.name() + ":2: '0,0' has a decimal comma; write 0.0; expected t here")));
}

TEST(Table, columns_that_may_be_meant_otherwise_are_refused) {
  const auto refused = [](const std::string& text, const std::string& column, const std::string& why) {
    const CsvFile file(text);
    EXPECT_THAT([&] { read_table(file.path(), column, Outside::clamp); },
                ThrowsMessage<Error>(HasSubstr(why)));
  };
  refused("x (m),p (kPa)\n0,1\n1,2\n", "p (kPa)", "'x (m)' has its unit in round brackets");
  refused("x,p (kPa)\n0,1\n1,2\n", "2", "Write 'p [kPa]'");
  refused("x,p,p\n0,1,2\n1,2,3\n", "p", "more than one column is called 'p'");
  refused("p,x\n0,1\n1,2\n", "p", "'p' is the first column, which contains the table's points");
  for (const char* name : {"p [kPa]", "p(x)", "p (upper side)", "p (2)"}) {
    const CsvFile file(std::string("x,") + name + "\n0,1\n1,2\n");
    EXPECT_NO_THROW(read_table(file.path(), "2", Outside::clamp)) << name;
  }
}

TEST(Table, places_in_a_file_that_do_not_grow_are_refused_with_their_line) {
  const CsvFile file("t,p\n0,1\n2,2\n1,3\n");
  EXPECT_THAT([&] { read_table(file.path(), "2", Outside::clamp); },
              ThrowsMessage<Error>(HasSubstr(
                  file.name() + ":4: the first column of a table must increase, but 2 is followed by 1")));
  const CsvFile names("t,p\n");
  EXPECT_THAT([&] { read_table(names.path(), "2", Outside::clamp); },
              ThrowsMessage<Error>(HasSubstr("contains no rows of numbers")));
}

/// Nothing ever writes into it: a reader would wait for ever.
TEST(Table, from_a_fifo_is_refused_at_once) {
  const auto fifo = std::filesystem::temp_directory_path() / fmt::format("couplet-fifo-{}.csv", getpid());
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THAT([&] { read_table(fifo, "2", Outside::clamp); },
              ThrowsMessage<Error>(HasSubstr("not a regular file")));
  std::filesystem::remove(fifo);
}

TEST(Table, a_header_in_other_units_is_not_read_as_si) {
  const CsvFile file("time [ms], p [bar], u [m], n [cells]\n0, 0, 0, 1\n10, 8, 3, 1\n");
  const auto of = [&](const std::string& variable, const std::string& column) {
    return fmt::format("table({}, \"{}\", \"{}\")", variable, file.path(), column);
  };
  EXPECT_THAT([&] { value_of(of("t", "u"), Vec3::Zero(), 5e-3); },
              ThrowsMessage<Error>(HasSubstr("the first column is in 'ms', but 't' is in s")));
  EXPECT_THAT([&] { value_of(of("1000*t", "p [bar]"), Vec3::Zero(), 5e-3); },
              ThrowsMessage<Error>(HasSubstr("the values are in 'bar'")));
  EXPECT_THAT([&] { value_of(fmt::format("({})", of("1000*t", "p")), Vec3::Zero(), 5e-3); },
              ThrowsMessage<Error>(HasSubstr("the values are in 'bar'")));
  EXPECT_DOUBLE_EQ(value_of(fmt::format("1e5*{}", of("1000*t", "p")), Vec3::Zero(), 5e-3), 4e5);
  EXPECT_DOUBLE_EQ(value_of(of("1000*t", "u"), Vec3::Zero(), 5e-3), 1.5);
  EXPECT_THAT([&] { value_of(of("1000*t", "n"), Vec3::Zero(), 5e-3); },
              ThrowsMessage<Error>(HasSubstr("the values are in 'cells'")));
  EXPECT_THAT([&] { value_of("1 + 0*t + " + of("1000*t", "n"), Vec3::Zero(), 5e-3); },
              ThrowsMessage<Error>(HasSubstr("the values are in 'cells'")));
}

TEST(Table, a_heading_is_in_the_unit_that_is_read_or_refused) {
  struct Case {
    const char *axis, *heading, *unit;
    bool is_taken;
  };
  for (const Case& c : {
           Case{"t", "t,p", "Pa", true},
           {"t", "t [s],p [Pa]", "Pa", true},
           {"t", "t [s],p [N/m^2]", "Pa", true},
           {"t", "t [s],p [-]", "Pa", true},
           {"t", "t [s],p [psi]", "Pa", false},
           {"t", "t [s],p [mmHg]", "Pa", false},
           {"t", "t [s],p [Mpa]", "Pa", false},
           {"t", "t [s],p [Bar]", "Pa", false},
           {"t", "t [s],p [kPa]", "Pa", false},
           {"t", "t [s],p [m]", "Pa", false},
           {"t", "t [s],p [m]", "", true},
           {"t", "t [s],p [1]", "1", true},
           {"t", "t [s],T [degC]", "K", false},
           {"t", "t [s],n [1/min]", "rad/s", false},
           {"t", "t [msec],p [Pa]", "Pa", false},
           {"t", "t [sec],p [Pa]", "Pa", false},
           {"t", "t [hours],p [Pa]", "Pa", false},
           {"t/1000", "t [msec],p [Pa]", "Pa", false},
           {"sqrt(x^2 + y^2)", "r [mm],p [Pa]", "Pa", false},
           {"z", "z [inch],p [Pa]", "Pa", false},
           {"t", "t [s],p (psi)", "Pa", false},
           {"t", "t (msec),p", "Pa", false},
       }) {
    const CsvFile file(std::string(c.heading) + "\n0,1\n10,2\n");
    const config::ExpressionText text{fmt::format("table({}, \"{}\")", c.axis, file.path()),
                                      {.unit = c.unit}};
    EXPECT_EQ(problem_of(text).empty(), c.is_taken)
        << c.heading << " of " << c.axis << ": " << problem_of(text);
  }
}

TEST(Table, a_header_of_another_quantity_is_no_axis) {
  const CsvFile file("z [s], p [Pa]\n0, 0\n10, 8\n");
  EXPECT_THAT([&] { value_of(fmt::format("table(z, \"{}\")", file.path()), Vec3::Zero(), 0); },
              ThrowsMessage<Error>(HasSubstr("the first column is in 's', but 'z' is in m")));
  EXPECT_DOUBLE_EQ(value_of(fmt::format("table(t, \"{}\")", file.path()), Vec3::Zero(), 5), 4);
}

struct Loads {
  config::ExpressionText pressure;
};

Loads read_loads(const std::string& text, const std::string& name = "case.yaml") {
  Loads loads;
  config::load_or_throw(config::Document::parse(text, name), "",
                        [&](config::Section& s) { s.value("pressure", loads.pressure).unit("Pa"); });
  return loads;
}

TEST(Table, may_be_a_mapping_in_the_yaml_with_units) {
  const Expression ramp(
      read_loads("pressure: {of: t, at: [0, 2 s, 1 min], values: [0, 3 bar, 100 kPa]}").pressure);
  EXPECT_DOUBLE_EQ(ramp(Vec3::Zero(), 1), 150e3);
  EXPECT_DOUBLE_EQ(ramp(Vec3::Zero(), 100), 100e3);
  const Expression radial(read_loads("pressure: {of: r, at: [0, 10], values: [0, 10]}").pressure);
  EXPECT_DOUBLE_EQ(radial(Vec3(3, 4, 7), 0), 5);
  EXPECT_THAT([] { read_loads("pressure: {of: t, at: [0, 1], values: [0]}"); },
              ThrowsMessage<Error>(HasSubstr("2 points and 1 values are given")));
  EXPECT_THAT([] { read_loads("pressure: {of: s, at: [0, 1], values: [0, 1]}"); },
              ThrowsMessage<Error>(HasSubstr("'of' of a table must be one of: x, y, z, r, t, T")));
  EXPECT_THAT([] { read_loads("pressure: {of: t, at: [0, 1], valus: [0, 1]}"); },
              ThrowsMessage<Error>(HasSubstr("Did you mean 'values'?")));
}

TEST(Table, files_are_sought_beside_the_yaml) {
  const CsvFile file("0 1\n10 2\n");
  const std::string yaml = (file.folder() / "case.yaml").string();
  EXPECT_DOUBLE_EQ(
      Expression(read_loads("pressure: {of: t, file: " + file.name() + "}", yaml).pressure)(Vec3::Zero(), 5),
      1.5);
  EXPECT_DOUBLE_EQ(Expression(read_loads("pressure: '2*table(t, \"" + file.name() + "\")'", yaml).pressure)(
                       Vec3::Zero(), 5),
                   3);
}

TEST(Table, repeats_with_its_period) {
  // Linear from the last value to the first one, also before the first point.
  const Table wave({1, 2, 4}, {10, 20, -20}, Outside::error, "", 5);
  EXPECT_DOUBLE_EQ(wave(1.5), 15);
  EXPECT_DOUBLE_EQ(wave(5), -5);
  for (const double t : {1., 1.5, 2., 3., 4., 4.5, 5.5})
    for (const int n : {-3, 1, 1000}) EXPECT_NEAR(wave(t + 5 * n), wave(t), 1e-10) << t << " " << n;
  EXPECT_NEAR(wave(6 - 1e-12), wave(6 + 1e-12), 1e-9);
  EXPECT_DOUBLE_EQ(wave.integral(1, 6), 15 - 10);
  EXPECT_NEAR(wave.integral(1.5, 16.5), 3 * (15 - 10), 1e-12);
  EXPECT_NEAR(wave.integral(-4, 6), 2 * (15 - 10), 1e-12);
  const Table whole({0, 1, 2}, {3, 4, 3}, Outside::clamp, "", 2);
  EXPECT_DOUBLE_EQ(whole(5), 4);
  EXPECT_DOUBLE_EQ(whole(-0.5), 3.5);
  EXPECT_DOUBLE_EQ(Table({0}, {3}, Outside::clamp, "", 2)(7), 3);
}

TEST(Table, that_is_longer_than_its_period_or_jumps_at_its_end_is_refused) {
  EXPECT_THAT(
      [] {
        Table({0, 1, 3}, {1, 2, 1}, Outside::clamp, "inlet", 2);
      },
      ThrowsMessage<Error>(HasSubstr("inlet: the table covers 3, which is longer than the period of 2")));
  EXPECT_THAT(
      [] {
        Table({0, 1, 2}, {1, 2, 1.5}, Outside::clamp, "", 2);
      },
      ThrowsMessage<Error>(HasSubstr("its values at both ends of the period differ: 1 and 1.5")));
}

TEST(Table, repeats_as_a_mapping_in_a_call_and_of_a_file) {
  const Expression beat(
      read_loads("pressure: {of: t, at: [0, 0.3 s], values: [0, 3 bar], repeat: 1000 ms}").pressure);
  EXPECT_DOUBLE_EQ(beat(Vec3::Zero(), 0.1), 1e5);
  EXPECT_DOUBLE_EQ(beat(Vec3::Zero(), 7.3), 3e5);
  EXPECT_NEAR(beat(Vec3::Zero(), 0.65), 1.5e5, 1e-9);
  EXPECT_NEAR(value_of("2*table(t/60, repeat 0.5, 0, 0, 0.25, 1)", Vec3::Zero(), 30 * 5 + 15), 2, 1e-12);
  const CsvFile file("t [s], p [Pa]\n0, 0\n1, 8\n2, 0\n");
  EXPECT_NEAR(value_of(fmt::format("table(t, repeat 2, \"{}\", p)", file.path()), Vec3::Zero(), 11.5), 4,
              1e-12);
  EXPECT_THAT([] { value_of("table(t, repeat 0, 0, 0, 1, 1)", Vec3::Zero(), 0); },
              ThrowsMessage<Error>(HasSubstr("the period of a table must be above 0, not 0")));
  EXPECT_THAT([] { read_loads("pressure: {of: t, at: [0, 1], values: [0, 1], repeat: -1 s}"); },
              ThrowsMessage<Error>(HasSubstr("'repeat' of a table is its period, which must be above 0")));
  EXPECT_THAT([] { read_loads("pressure: {of: t, at: [0, 1], values: [0, 1], repeat: 2 m}"); },
              ThrowsMessage<Error>(HasSubstr("case.yaml:1")));
  EXPECT_THAT(
      [] { read_loads("pressure: {of: t, at: [0, 1], values: [0, 1], repeat: 2 s, outside: clamp}"); },
      ThrowsMessage<Error>(HasSubstr("a table that repeats has no values outside; remove 'outside'")));
  EXPECT_THAT(problem_of_property({"table(T, repeat 200, 300, 1, 400, 2)"}), HasSubstr("does not repeat"));
}

TEST(Property, may_be_a_table_of_another_variable) {
  EXPECT_DOUBLE_EQ(Property({"table(q, clamp, 0, 0, 2, 8)"}, "drop", "q")(0.5), 2);
  EXPECT_THAT(problem_of_property({"table(T, 0, 0, 2, 8)"}, "q"), HasSubstr("is no table of q"));
}

TEST(Property, is_a_number_or_a_table_of_the_temperature) {
  EXPECT_EQ(Property({"5"}, "k")(300), 5);
  const Property alpha({"table(T, clamp, 300, 1e-5, 400, 2e-5)"}, "alpha");
  EXPECT_DOUBLE_EQ(alpha(350), 1.5e-5);
  EXPECT_DOUBLE_EQ(alpha.integral(300, 400), 1.5e-3);
  const config::KeyFacts ratio{.lowest = -0.99, .highest = 0.49999};
  EXPECT_EQ(problem_of_property({"table(T, clamp, 300, 0.3, 400, 0.49)", ratio}), "");
  EXPECT_THAT(problem_of_property({"table(T, clamp, 300, 0.3, 400, 0.7)", ratio}),
              HasSubstr("0.7 is out of range in a table; expected a value from -0.99 to 0.49999"));
  for (const char* wrong : {"2*T", "table(t, 0, 1, 1, 2)", "table(T, 0, 1, 1, 2) + 1", "x"})
    EXPECT_THAT([&] { Property({wrong}, "material.conductivity"); },
                ThrowsMessage<Error>(HasSubstr("neither a number nor a table of the temperature")))
        << wrong;
}

}  // namespace couplet::table_test
