// SPDX-License-Identifier: Apache-2.0
#include "common/io/rehearse.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <vector>

#include "common/base/error.hpp"

namespace couplet::rehearse_test {
namespace {

namespace fs = std::filesystem;

/// What rehearse() says of reading so; empty: nothing.
std::string said_of(const std::function<void()>& read) {
  try {
    io::rehearse("a.h5", "file", read);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Rehearse, what_reads_well_passes_and_leaves_nothing_here) {
  int times = 0;
  EXPECT_EQ(said_of([&] { ++times; }), "");
  EXPECT_EQ(times, 0);
}

TEST(Rehearse, an_error_comes_back_as_it_was) {
  EXPECT_EQ(said_of([] { throw Error("'a.h5' has 6 values; 1 is expected."); }),
            "'a.h5' has 6 values; 1 is expected.");
}

TEST(Rehearse, a_crash_is_an_error_that_names_the_file) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE})
    EXPECT_EQ(
        said_of([&] { std::raise(signal); }),
        "The file 'a.h5' cannot be used: it is damaged or malicious (a trial read crashed). Create it again.");
}

TEST(Rehearse, what_takes_more_memory_than_the_file_can_need_is_refused) {
  std::size_t sum = 0;
  const auto takes = [&](std::size_t megabytes) {
    return said_of([&] { sum += std::vector<char>(megabytes << 20, 'x').size(); });
  };
  EXPECT_EQ(takes(100), "");
  EXPECT_NE(takes(2000).find("more memory"), std::string::npos);
}

TEST(Rehearse, what_never_ends_is_refused) {
  volatile bool on = true;
  EXPECT_NE(said_of([&] {
              while (on) continue;
            }).find("takes longer"),
            std::string::npos);
}

TEST(Rehearse, nothing_is_written) {
  const fs::path file = fs::temp_directory_path() / ("couplet-rehearse-" + std::to_string(::getpid()));
  said_of([&] {
    std::ofstream out(file);
    out << "text" << std::flush;
  });
  std::error_code none;
  EXPECT_FALSE(fs::exists(file) && fs::file_size(file, none) > 0);
  fs::remove(file);
}

}  // namespace
}  // namespace couplet::rehearse_test
