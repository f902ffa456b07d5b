// SPDX-License-Identifier: Apache-2.0
// Broken, ambiguous and hostile text data through every reader of them: see README.md.

#include "common/base/text.hpp"
#include "common/fv/grid_table.hpp"
#include "common/fv/table.hpp"
#include "common/io/series.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/support/gzip.hpp"
#include "thermocline/plant/flow.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::fuzz::table_fuzz {

/// Numbers, and one way of writing them.
struct WrittenTable {
  std::string bytes;
  std::vector<double> at, values;
  bool is_plain = false;  ///< decimal points, one separator: it must be read
};

/// A small file whose text is large.
struct Bomb {
  std::string what, bytes;
};

constexpr int hours = 48;

std::string weather_csv() {
  std::string text = "# two days\nhour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n";
  for (int h = 0; h < hours; ++h)
    text += fmt::format("{},{},{}.5,3,40,99000\n", h, h % 24 == 12 ? 800 : 0, 10 + h % 24);
  return text;
}

const std::vector<std::string>& odd_cells() {
  static const std::vector<std::string> list{
      "",         "nan",      "inf",   "-inf",  "0,5",   "1.000,5", "1e999", "1e-999",     "x",
      "-",        "+",        "1.2.3", "0x10",  "1d5",   "\"1\"",   "\"",    "\"1,5\"",    "1 m",
      "#",        "1#2",      "05",    "-0",    "1e308", "1;2",     "1\t2",  "t",          "[s]",
      "p [",      "t [s]",    "9999",  "-9999", "99.9",  "8760",    "1/0",   "2147483648", "\xff\xfe",
      "\xc2\xb0", "\x1f\x8b", "2005",  "u",     "1e5e5", "..",      "NaN",   "Infinity",   "1 000",
      "1'000",    "100000",   "0.1",   "1e-320"};
  return list;
}

/// Pieces of a gzip stream whose text is `block` again and again: deflate's full flush ends a piece at a whole byte and forgets
/// what was before, so that one piece may stand any number of times.
std::string endless_stream(const std::string& block, std::size_t times) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 9, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, block.size()) + 100, '\0');
  const auto piece = [&] {
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(block.data()));
    stream.avail_in = uInt(block.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = uInt(packed.size());
    deflate(&stream, Z_FULL_FLUSH);
    return packed.substr(0, packed.size() - stream.avail_out);
  };
  std::string all = piece();  // with the head
  const std::string again = piece();
  deflateEnd(&stream);
  for (std::size_t i = 1; i < times; ++i) all += again;
  return all;
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  all.reserve(text.size() * times);
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

/// Rows that grow and compress as measured data do.
std::string rows_of_numbers(std::size_t bytes) {
  std::string text;
  std::uint64_t state = 1;
  for (int i = 0; text.size() < bytes; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    text += fmt::format("{},{}\n", i, double(state >> 40) / 1000);
  }
  return text;
}

/// One right file of each kind: tables, grids, flows, weather, a series.
std::vector<std::string> samples() {
  return {
      "t [s],p [Pa]\n0,0.5\n1,20.25\n2.5,1e3\n",
      "# table\n0 1\n1 2 # two\n2 3.5\n",
      "t;p\n0;1000.5\n1;2000.5\n2;3000.5\n",
      "t\tp\n0\t1000.5\n1\t2000.5\n",
      "y [m],t,u,v\n0,0,1.5,0\n0,1,1,0\n1,0,1,0\n1,1,2,0\n",
      "time [h],mass-flow [kg/s],inlet-temperature [degC],stop-above [degC]\n0,-100,390,\n1.5,0,,\n2,50,290,300\n",
      "time [s],p [Pa]\n0.5,1\n1,2.5\n1.5,3\n2,4\n",
      weather_csv()};
}

/// Files that nobody would write: no end of one thing, other formats.
std::vector<std::string> odd_files() {
  std::vector<std::string> files{"",
                                 "\n",
                                 "\xEF\xBB\xBF",
                                 "\xFF\xFEt\0,\0p\0",
                                 std::string(100, '\0'),
                                 "PK\x03\x04rest",
                                 "\x1f\x8b",
                                 "\x1f\x8b\x08",
                                 "#",
                                 ",",
                                 ";;;;",
                                 "\"",
                                 "{\"a\": 1}",
                                 "<html>",
                                 "%PDF-1.4",
                                 "t,p",
                                 "t,p\n",
                                 "LOCATION,",
                                 "Latitude (",
                                 "a\nDate (MM/DD/YYYY)",
                                 "Month,Hour\n",
                                 "\r\r\r"};
  for (const char c : {',', ';', '"', '0', ' ', '#', '\t', '\n', '-'}) {
    files.push_back(std::string(300000, c));
    files.push_back("t,p\n0,1\n" + std::string(60000, c) + "\n");
  }
  std::string wide = "t", row = "0";
  for (int i = 0; i < 15000; ++i) wide += ",p", row += ",1";
  files.push_back(wide + "\n" + row + "\n");
  files.push_back(row + "\n" + row + "\n");
  return files;
}

/// Some cells, separators, line ends replaced, rows made longer or shorter.
std::string mutate_cells(const std::string& text, Dice& dice) {
  std::vector<std::string> lines = base::split(text, '\n');
  const std::string separators = ",;\t ";
  for (std::size_t n = dice.below(4); n > 0; --n) {
    std::string& line = lines[dice.below(lines.size())];
    const std::size_t at = std::min(line.find_first_of(separators, dice.below(line.size() + 1)), line.size()),
                      end = std::min(line.find_first_of(separators, std::min(at + 1, line.size())),
                                     line.size());
    switch (dice.below(7)) {
      case 0:
        line += ",;\t "[dice.below(4)] + dice.of(odd_cells());
        break;
      case 1:
        line.erase(at);
        break;
      case 2:
        std::ranges::replace(line, '.', ',');
        break;
      case 3:
        if (at < line.size()) line[at] = separators[dice.below(separators.size())];
        break;
      default:
        if (at < line.size()) line.replace(at + 1, end - at - 1, dice.of(odd_cells()));
    }
  }
  std::string result = base::join(lines, dice.one_in(8) ? "\r\n" : dice.one_in(20) ? "\r" : "\n");
  if (dice.one_in(10)) std::ranges::replace(result, ',', dice.one_in(2) ? ';' : '\t');
  if (dice.one_in(10)) std::ranges::replace(result, '.', ',');
  if (dice.one_in(20)) result.insert(0, "\xEF\xBB\xBF");
  return result;
}

WrittenTable random_table(Dice& dice) {
  WrittenTable table;
  static const std::vector<std::string> separators{",", ";", "\t", " ", ", ", " ; "};
  const std::string separator = dice.of(separators), end = dice.one_in(3) ? "\r\n" : "\n";
  const bool comma = dice.one_in(3), named = dice.one_in(2), quoted = dice.one_in(6);
  const std::size_t rows = 1 + dice.below(6), columns = 2 + dice.below(3);
  bool any_comma = false;
  if (dice.one_in(5)) table.bytes += "\xEF\xBB\xBF";
  if (dice.one_in(4)) table.bytes += "# one of many" + end;
  const auto add_row = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::string cell = quoted ? '"' + cells[i] + '"' : cells[i];
      table.bytes += (i > 0 ? separator : "") + cell;
    }
    table.bytes += end;
  };
  if (named) add_row({"t", "p", "q", "r"});
  for (std::size_t r = 0; r < rows; ++r) {
    std::vector<std::string> cells;
    for (std::size_t c = 0; c < columns; ++c) {
      // The axis grows by 10; one digit after the point at least, so that a comma always shows.
      const double value = (c == 0 ? 10.0 * double(r) : 0.0) + double(dice.below(90) + 1) / 10 + 0.05;
      cells.push_back(fmt::format("{:.2f}", value));
      if (c < 2) (c == 0 ? table.at : table.values).push_back(std::stod(cells.back()));
      if (comma) std::ranges::replace(cells.back(), '.', ','), any_comma = true;
    }
    add_row(cells);
  }
  if (dice.one_in(6)) table.bytes = support::gzip(table.bytes);
  table.is_plain = !any_comma;
  return table;
}

std::vector<Bomb> bombs() {
  std::vector<Bomb> all;
  constexpr std::size_t mega = 1 << 20;
  const std::string row = "0,20,0,50,101325,1\n", zeros(mega, '\0'), lines(mega, '\n'), digits(mega, '1'),
                    blanks(mega, ' ');
  const std::string rows = repeated(row, mega / row.size());
  for (const auto& [what, block] : {std::pair<std::string, const std::string&>{"zeros", zeros},
                                    {"line ends", lines},
                                    {"one line of digits", digits},
                                    {"blanks", blanks},
                                    {"rows", rows}}) {
    all.push_back({"one stream of " + what, endless_stream(block, 3000)});
    all.push_back({"members of " + what, repeated(support::gzip(block), 3000)});
    all.push_back(
        {"a table and then " + what, support::gzip("t,p\n0,1\n") + repeated(support::gzip(block), 3000)});
  }
  const std::string measured = rows_of_numbers(mega);
  all.push_back({"many members that compress as data do", repeated(support::gzip(measured), 80)});
  all.push_back({"one stream that compresses as data do", endless_stream(measured, 80)});
  all.push_back({"more rows than are read", support::gzip(rows_of_numbers(70 * mega), 1)});
  all.push_back({"a million empty members", repeated(support::gzip(""), 1000000)});
  const std::string whole = support::gzip(measured);
  for (const double part : {0.0002, 0.01, 0.5, 0.9999})
    all.push_back({"truncated", whole.substr(0, std::size_t(part * double(whole.size())))});
  all.push_back({"rubbish behind", whole + "rubbish"});
  std::string other = whole;
  other[other.size() - 6] = char(other[other.size() - 6] ^ 1);
  all.push_back({"another digest", other});
  return all;
}

using namespace fv;
namespace fs = std::filesystem;

struct Reader {
  std::string name;
  std::function<void(const fs::path&)> read;
};

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all{
      {"table", [](const fs::path& f) { read_table(f, "2", Table::Outside::clamp); }},
      {"named table", [](const fs::path& f) { read_table(f, "p", Table::Outside::error); }},
      {"grid",
       [](const fs::path& f) {
         GridTable::read(f, {"u", "v"}, GridTable::Outside::error);
       }},
      {"flows", [](const fs::path& f) { thermocline::read_flow_file(f); }},
      {"weather", [](const fs::path& f) { thermocline::read_weather(f); }},
      {"series", [](const fs::path& f) {
         io::Series(f, {"time [s]", "p [Pa]"}, 1.5);
       }}};
  return all;
}

/// Tries files one after the other and watches over what must hold for each.
class Trial {
 public:
  Trial() : folder_(fs::temp_directory_path() / fmt::format("couplet-fuzz-tables-{}", ::getpid())) {
    fs::create_directories(folder_);
  }
  ~Trial() { fs::remove_all(folder_); }

  /// What was said; empty: it was read.
  std::string attempt(const Reader& reader, const std::string& bytes, const std::string& name = "last.csv") {
    const fs::path file = folder_ / name;
    write_file(file, bytes);
    std::string said;
    const auto start = std::chrono::steady_clock::now();
    try {
      reader.read(file);
      ++read;
    } catch (const Error& error) {
      ++refused;
      said = error.what();
      EXPECT_NE(said.find(name), std::string::npos)
          << reader.name << ": names no file: " << said.substr(0, 300);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    slowest = std::max(slowest, seconds);
    EXPECT_LT(seconds, longest()) << reader.name << ": " << file;
    return said;
  }
  void record() {
    EXPECT_LT(peak_memory(), 1000);
    testing::Test::RecordProperty("tried", int(read + refused));
    testing::Test::RecordProperty("refused", int(refused));
    testing::Test::RecordProperty("slowest", fmt::format("{:.3f}", slowest));
    testing::Test::RecordProperty("megabytes", fmt::format("{:.0f}", peak_memory()));
  }
  std::size_t read = 0, refused = 0;
  double slowest = 0;

 private:
  fs::path folder_;
};

TEST(Tables, broken_ones_are_read_or_refused_by_name) {
  const std::vector<std::string> texts = samples();
  Trial trial;
  Dice dice(seed());
  for (const std::string& text : texts) {
    std::size_t good = 0;
    for (const Reader& reader : readers()) good += trial.attempt(reader, text).empty();
    EXPECT_GE(good, 1u) << "a sample that nobody reads shows nothing:\n" << text.substr(0, 200);
  }
  for (const std::string& text : odd_files())
    for (const Reader& reader : readers()) trial.attempt(reader, text);
  for (std::size_t i = 0; i < count(); ++i) {
    std::string text = mutate_cells(dice.of(texts), dice);
    if (dice.one_in(3)) text = mutate_bytes(text, dice);
    if (dice.one_in(6)) text = mutate_bytes(support::gzip(text, 1), dice);
    for (const Reader& reader : readers()) trial.attempt(reader, text);
  }
  EXPECT_GT(trial.refused, trial.read);
  testing::Test::RecordProperty("files", int(count()));
  trial.record();
}

/// The same numbers in every way of writing them: read as they are, or refused with their line, never as others.
TEST(Tables, every_way_of_writing_numbers_is_read_as_it_is_or_refused) {
  Trial trial;
  Dice dice(seed());
  std::size_t n_read = 0, n_refused = 0;
  const fs::path file = fs::temp_directory_path() / fmt::format("couplet-fuzz-ways-{}.csv", ::getpid());
  for (std::size_t i = 0; i < std::max<std::size_t>(count(), 100); ++i) {
    const WrittenTable table = random_table(dice);
    write_file(file, table.bytes);
    std::string said;
    try {
      const Table read = read_table(file, "2", Table::Outside::clamp);
      ASSERT_EQ(read.at(), table.at) << table.bytes;
      ASSERT_EQ(read.values(), table.values) << table.bytes;
      ++n_read;
    } catch (const Error& error) {
      ++n_refused;
      ASSERT_FALSE(table.is_plain) << error.what() << "\n" << table.bytes;
      ASSERT_NE(std::string(error.what()).find(".csv:"), std::string::npos) << "no line: " << error.what();
    }
  }
  fs::remove(file);
  EXPECT_GT(n_read, count() / 4);
  EXPECT_GT(n_refused, count() / 8);
  testing::Test::RecordProperty("tried", int(n_read + n_refused));
  testing::Test::RecordProperty("refused", int(n_refused));
}

TEST(Tables, gzip_bombs_end_with_a_sentence_in_time_and_memory) {
  Trial trial;
  for (const Bomb& bomb : bombs())
    for (const Reader& reader : readers()) {
      if (reader.name == "series") continue;  // a run's own file
      EXPECT_NE(trial.attempt(reader, bomb.bytes, "bomb.csv.gz"), "")
          << bomb.what << " was read as " << reader.name;
    }
  trial.record();
}

}  // namespace couplet::fuzz::table_fuzz
