// SPDX-License-Identifier: Apache-2.0
// Bytes and lines: gzip and its limits, what is no text.
#include "common/csv/csv_reader.hpp"

#include <sys/stat.h>

#include "tests/support/gzip.hpp"
#include "tests/support/own_folder.hpp"
#include "tests/support/test.hpp"

namespace couplet::csv::line_reader_test {
using support::gzip;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

std::filesystem::path file_of(const std::string& bytes) {
  const auto file = support::own_folder() / "a.csv";
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

std::vector<std::string> lines_of(const std::string& bytes, const Limits& limits = {}) {
  return read_lines(file_of(bytes), "table", limits);
}

std::string said_of_lines(const std::string& bytes, const Limits& limits = {}) {
  return support::error_of([&] { lines_of(bytes, limits); });
}

TEST(LineReader, takes_line_ends_and_the_mark_of_utf8_away) {
  EXPECT_THAT(lines_of("a,b\n1,2\n"), ElementsAre("a,b", "1,2"));
  EXPECT_THAT(lines_of("\xEF\xBB\xBF"
                       "a,b\r\n1,2\r\n\r\n"),
              ElementsAre("a,b", "1,2"));
  EXPECT_THAT(lines_of("a\n\n1"), ElementsAre("a", "", "1"));
  EXPECT_THAT(lines_of(""), ElementsAre());
}

TEST(LineReader, lines_longer_than_its_buffer_s_pieces_are_whole) {
  const std::string first(60000, 'a'), second(65536, 'b'), third(3, 'c');
  EXPECT_THAT(lines_of(first + "\n" + second + "\n" + third), ElementsAre(first, second, third));
}

TEST(LineReader, tells_whether_the_last_line_is_whole) {
  const auto file = file_of("1\n2");
  LineReader reader(file, "table");
  std::string_view line;
  ASSERT_TRUE(reader.next(line));
  EXPECT_TRUE(reader.has_end());
  ASSERT_TRUE(reader.next(line));
  EXPECT_EQ(line, "2");
  EXPECT_FALSE(reader.has_end());
  EXPECT_FALSE(reader.next(line));
}

TEST(LineReader, what_is_no_text_is_refused_with_its_line) {
  EXPECT_THAT(said_of_lines(std::string("1,2\n3,\0\n", 8)),
              HasSubstr("a.csv:2: this table is not plain text: it contains zero bytes"));
  EXPECT_THAT(said_of_lines("1,2\n3,\x01\n"),
              HasSubstr("a.csv:2: this table is not plain text: it contains the control character 0x01"));
  EXPECT_THAT(said_of_lines("1,2\r3,4\r5,6\r"), HasSubstr("a.csv:1: carriage return within this line"));
  EXPECT_THAT(said_of_lines("1\n" + std::string(70000, '1') + "\n"),
              HasSubstr("a.csv:2: this line has more than 65536 bytes"));
  EXPECT_THAT(said_of_lines("1\n" + std::string(70000, '1')),
              HasSubstr("a.csv:2: this line has more than 65536 bytes"));
}

TEST(LineReader, what_is_no_regular_file_is_refused_at_once) {
  const auto fifo = support::own_folder() / "fifo.csv";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_THAT([&] { read_lines(fifo, "table"); },
              testing::ThrowsMessage<Error>(HasSubstr("is not a regular file, but a folder, pipe")));
  EXPECT_THAT([] { read_lines("/dev/zero", "table"); },
              testing::ThrowsMessage<Error>(HasSubstr("not a regular file")));
  EXPECT_THAT([] { read_lines("/nowhere/a.csv", "table"); },
              testing::ThrowsMessage<Error>(HasSubstr("this table does not exist")));
}

TEST(LineReader, limits_of_size_and_of_lines_hold) {
  EXPECT_THAT(said_of_lines(std::string(3 << 20, '\n'), {.bytes = 2 << 20}),
              EndsWith("this table has 3 MB; at most 2 MB are read. Reduce its rows or columns."));
  EXPECT_EQ(said_of_lines("1\n2\n3\n", {.lines = 3}), "");
  EXPECT_THAT(said_of_lines("1\n2\n3\n4\n", {.lines = 3}), HasSubstr("more than 3 lines"));
}

TEST(Gzip, is_known_by_its_first_bytes_and_may_have_several_members) {
  EXPECT_THAT(lines_of(gzip("a,b\n1,2\n")), ElementsAre("a,b", "1,2"));
  EXPECT_THAT(lines_of(gzip("a,b\n1,") + gzip("") + gzip("2\n")), ElementsAre("a,b", "1,2"));
}

TEST(Gzip, that_is_cut_or_damaged_anywhere_is_refused) {
  std::string text = "hour,value\n";
  for (int i = 0; i < 5000; ++i) text += std::to_string(i) + "," + std::to_string((i * 7919) % 1000) + "\n";
  const std::string whole = gzip(text);
  ASSERT_EQ(said_of_lines(whole), "");
  for (std::size_t n = 3; n < whole.size(); n += 1 + n / 7)
    EXPECT_THAT(said_of_lines(whole.substr(0, n)), HasSubstr("damaged or truncated")) << n;
  for (std::size_t at = whole.size() / 2; at < whole.size(); at += 97) {
    std::string bad = whole;
    bad[at] = char(bad[at] ^ 16);
    EXPECT_THAT(said_of_lines(bad), HasSubstr("damaged or truncated")) << at;
  }
  EXPECT_THAT(said_of_lines(whole + "x"), HasSubstr("its last bytes are not part of any member"));
  EXPECT_THAT(said_of_lines(whole + "rubbish"), HasSubstr("the compressed data are followed by other bytes"));
  EXPECT_THAT(said_of_lines(whole + "\x1f\x8b rubbish"), HasSubstr("damaged or truncated"));
}

/// 3 MB that would be 3 GB: stopped at the first megabyte.
TEST(Gzip, that_expands_beyond_what_measured_data_do_is_refused) {
  std::string row = "0,20,0,50,101325\n", text;
  while (text.size() < (4 << 20)) text += row;
  EXPECT_THAT(said_of_lines(gzip(text)), HasSubstr("expands to more than 100 times its size"));
  EXPECT_EQ(said_of_lines(text), "") << "the same text, not compressed";
  // Small files may be as regular as they like, and a level of compression as files have it passes.
  EXPECT_EQ(said_of_lines(gzip(text.substr(0, 900000))), "");
  std::string years;
  for (int i = 0; i < 150000; ++i)
    years += std::to_string(i) + ",20.5,3," + std::to_string(i % 40) + ",99000\n";
  EXPECT_EQ(said_of_lines(gzip(years)), "");
}

TEST(Gzip, the_size_of_the_text_is_limited_whatever_the_ratio) {
  std::string text;
  for (unsigned i = 1; text.size() < (3 << 20); i = i * 1664525u + 1013904223u)
    text += std::to_string(i) + "\n";
  EXPECT_EQ(said_of_lines(gzip(text)), "");
  EXPECT_THAT(said_of_lines(gzip(text), {.bytes = 2 << 20}), HasSubstr("more than 2 MB when decompressed"));
}

}  // namespace couplet::csv::line_reader_test
