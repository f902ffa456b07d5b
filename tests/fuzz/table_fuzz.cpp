// SPDX-License-Identifier: Apache-2.0
// Broken, ambiguous and hostile text data through every reader of them: see README.md.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/fv/grid_table.hpp"
#include "common/fv/table.hpp"
#include "common/io/series.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/table_samples.hpp"
#include "tests/support/gzip.hpp"
#include "thermocline/plant/flow.hpp"
#include "thermocline/weather/weather_file.hpp"

namespace couplet::fuzz::table_fuzz {
using namespace fv;
namespace {

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

}  // namespace
}  // namespace couplet::fuzz::table_fuzz
