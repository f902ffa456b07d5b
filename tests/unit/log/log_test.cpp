// SPDX-License-Identifier: Apache-2.0
#include "common/log/log.hpp"

#include <thread>

#include "common/log/progress.hpp"
#include "tests/support/test.hpp"

namespace couplet::log_test {

/// What a logger set up like this writes to standard output and standard error.
struct Written {
  std::string out, err;
};
Written speak(int rank, log::Verbosity verbosity) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  log::setup("fl%d", rank, verbosity);
  log::debug("d");
  log::info("i {}", 1);
  log::warn("w");
  log::error("e");
  return {testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

TEST(Log, every_line_names_participant_and_rank_and_errors_go_to_stderr_alone) {
  const Written root = speak(0, log::Verbosity::normal);
  EXPECT_EQ(root.out, "[fl%d 0] i 1\n[fl%d 0] warning: w\n");
  EXPECT_EQ(root.err, "[fl%d 0] error: e\n");
}

TEST(Log, below_verbose_only_rank_0_tells_more_than_errors) {
  EXPECT_EQ(speak(2, log::Verbosity::normal).out, "");
  EXPECT_EQ(speak(2, log::Verbosity::quiet).err, "[fl%d 2] error: e\n");
  EXPECT_EQ(speak(0, log::Verbosity::quiet).out, "[fl%d 0] warning: w\n");
  EXPECT_EQ(speak(1, log::Verbosity::verbose).out, "[fl%d 1] d\n[fl%d 1] i 1\n[fl%d 1] warning: w\n");
}

TEST(Log, the_file_of_rank_0_has_everything) {
  const auto file = std::filesystem::temp_directory_path() / "couplet_log_test.log";
  std::filesystem::remove(file);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  log::setup("solid", 0, log::Verbosity::normal, file.string());
  log::info("one");
  log::error("two");
  log::setup("solid", 1, log::Verbosity::normal, file.string());
  log::warn("not this one");
  testing::internal::GetCapturedStdout();
  testing::internal::GetCapturedStderr();
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  EXPECT_EQ(text.str(), "[solid 0] one\n[solid 0] error: two\n");
  std::filesystem::remove(file);
  EXPECT_THROW(log::setup("solid", 0, log::Verbosity::normal, "/proc/no/such.log"), Error);
}

TEST(Timers, the_table_has_the_largest_first_with_its_share) {
  log::Timers timers;
  timers.add("assembly", 1);
  timers.add("solve", 2);
  timers.add("solve", 4);
  EXPECT_EQ(timers.table("fluid", 8),
            "fluid        seconds    share      calls\n"
            "solve          6.000   75.0 %          2\n"
            "assembly       1.000   12.5 %          1\n"
            "total          8.000  100.0 %\n");
}

TEST(Timers, a_scope_adds_its_own_duration) {
  log::Timers timers;
  {
    log::ScopedTimer timer(timers, "sleep");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(timers.entries().at("sleep").calls, 1);
  EXPECT_GE(timers.entries().at("sleep").seconds, 5e-3);
}

TEST(Progress, time_to_go_is_in_proportion_to_what_was_done) {
  EXPECT_EQ(log::eta(0, 10, 5), "");
  EXPECT_EQ(log::eta(2.5, 10, 3840), "ETA 3 h 12 min");
  EXPECT_EQ(log::eta(10, 10, 100), "ETA 0.0 s");
}

TEST(Progress, durations_have_two_digits_of_use) {
  EXPECT_EQ(log::format_duration(0.42), "0.4 s");
  EXPECT_EQ(log::format_duration(9.97), "10 s");
  EXPECT_EQ(log::format_duration(59.6), "1 min 0 s");
  EXPECT_EQ(log::format_duration(200), "3 min 20 s");
  EXPECT_EQ(log::format_duration(3599.7), "1 h 0 min");
  EXPECT_EQ(log::format_duration(190800), "2 d 5 h");
}

}  // namespace couplet::log_test
