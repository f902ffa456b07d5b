// SPDX-License-Identifier: Apache-2.0
// Rows of tables: what is read, and what could be meant otherwise and is refused.
#include "common/csv/csv_reader.hpp"

#include "tests/support/own_folder.hpp"
#include "tests/support/test.hpp"

namespace couplet::csv::csv_reader_test {
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

using Rows = std::vector<std::vector<double>>;

Rows rows_of(const std::string& text, std::vector<std::string>* names = nullptr) {
  const auto file = support::own_folder() / "a.csv";
  std::ofstream(file, std::ios::binary) << text;
  CsvReader reader(file, "table");
  if (names) *names = reader.names();
  Rows rows;
  while (reader.next()) {
    rows.emplace_back();
    for (std::size_t i = 0; i < reader.cells().size(); ++i) rows.back().push_back(reader.number(i));
  }
  return rows;
}

std::string said(const std::string& text) {
  return support::error_of([&] { rows_of(text); });
}

TEST(CsvReader, reads_each_separator_with_and_without_names) {
  const Rows wanted{{0, 10.5}, {1, -2e3}};
  for (const char* text :
       {"t,p\n0,10.5\n1,-2e3\n", "0 ; 10.5\n 1;-2e3", "t\tp\n0\t10.5\n1\t-2e3\n", "  0   10.5\n1  -2e3 \n",
        "# about\n\n\"t\",\"p [Pa]\"\n\"0\", 10.5 # first\n1,-2e3\n",
        "\xEF\xBB\xBFt;p\r\n0;10.5\r\n1;-2e3\r\n"})
    EXPECT_EQ(rows_of(text), wanted) << text;
  std::vector<std::string> names;
  rows_of("time [s], \"p, mean\"\n0,1\n", &names);
  EXPECT_THAT(names, ElementsAre("time [s]", "p, mean"));
  EXPECT_EQ(rows_of("+1.5,.5\n"), (Rows{{1.5, 0.5}}));
}

TEST(CsvReader, decimal_commas_are_refused_with_their_line) {
  EXPECT_THAT(said("t;p\n0,0;1000,5\n1,0;2000,5\n"),
              EndsWith("a.csv:2: '0,0' has a decimal comma; write 0.0."));
  EXPECT_THAT(said("0,0;1000,5\n"), EndsWith("a.csv:1: '0,0' has a decimal comma; write 0.0."));
  EXPECT_THAT(said("t;p\n0;1.000,5\n"), HasSubstr("a.csv:2: '1.000,5' has a decimal comma"));
  EXPECT_THAT(said("t\tp\n0\t1000,5\n"), EndsWith("a.csv:2: '1000,5' has a decimal comma; write 1000.5."));
  EXPECT_THAT(
      said("t,p\n0,0,1000,5\n"),
      HasSubstr(
          "a.csv:2: 4 values, but the file has 2 columns (separated by commas, as in line 1). If commas"));
  EXPECT_THAT(said("t p\n0,0 1000,5\n"), HasSubstr("a.csv:2: '0,0' has a decimal comma"));
  EXPECT_THAT(said("0,0 1000,5\n"), HasSubstr("a.csv:1"));
  EXPECT_THAT(said("t,p\n0,05\n"),
              HasSubstr("a.csv:2: '05' starts with a zero: are the commas decimal commas?"));
}

TEST(CsvReader, separators_that_could_be_decimal_commas_need_names_or_points) {
  EXPECT_THAT(said("0,0,1000,5\n1,5,2000,5\n"),
              HasSubstr("a.csv:1: ambiguous commas: they may separate 4 whole numbers or be decimal commas"));
  EXPECT_THAT(said("0,5,1000\n"), HasSubstr("3 whole numbers"));
  EXPECT_EQ(said("a,b,c\n0,5,1000\n"), "");
  EXPECT_EQ(said("0,5,1000\n1,5,1000.5\n"), "");
  EXPECT_EQ(said("0,5\n1,6\n"), "");
}

TEST(CsvReader, one_separator_and_one_width_in_the_whole_file) {
  EXPECT_THAT(
      said("t,p\n0,1\n1;2\n"),
      HasSubstr("a.csv:3: 1 values, but the file has 2 columns (separated by commas, as in line 1). Use one "
                "separator"));
  EXPECT_THAT(said("0,1\n1\n"), HasSubstr("a.csv:2: 1 values, but the file has 2 columns"));
  EXPECT_THAT(said("0,1\n1,2,3\n"), HasSubstr("a.csv:2: 3 values"));
  EXPECT_THAT(said("0 1\n1 2 3\n"), HasSubstr("separated by blanks"));
  EXPECT_THAT(said("t,p\n0,1,\n"), HasSubstr("a.csv:2: 3 values"));
}

TEST(CsvReader, cells_that_are_no_finite_numbers_are_refused) {
  for (const char* cell : {"nan", "NaN", "inf", "-inf", "1e999", "x", "1.2.3", "0x10", "1d5", "--1", "+-1",
                           "1 m", "", "1e", "'1'"})
    EXPECT_THAT(said(std::string("t,p\n0,1\n2,") + cell + "\n"), HasSubstr("a.csv:3: ")) << cell;
  EXPECT_THAT(said("t,p\n0,nan\n"), EndsWith("a.csv:2: 'nan' is not a finite number."));
  EXPECT_THAT(said("t,p\n0,1e999\n"), EndsWith("a.csv:2: '1e999' is beyond the range of numbers."));
  EXPECT_THAT(said("t,p\n0,\"1\n"), EndsWith("a.csv:2: a double quote is not closed."));
}

TEST(CsvReader, a_first_row_with_a_slip_is_not_taken_for_names) {
  EXPECT_THAT(said("O.5,1\n1,2\n"),
              HasSubstr("a.csv:1: the first line contains both numbers ('1') and words ('O.5')"));
  EXPECT_THAT(said("0 s,1\n1,2\n"), HasSubstr("a unit belongs in the column name"));
  EXPECT_THAT(said("nan,1\n1,2\n"), HasSubstr("a.csv:1: 'nan' is not a finite number"));
  EXPECT_THAT(said("1.2.3,0\n1,2\n"), HasSubstr("a.csv:1: '1.2.3' is not a number"));
}

}  // namespace couplet::csv::csv_reader_test
