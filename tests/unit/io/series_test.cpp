// SPDX-License-Identifier: Apache-2.0
#include "common/io/series.hpp"
#include "common/io/checkpoint_set.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"

namespace couplet::series_test {
using namespace io;

using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A series lives on one rank: each rank has its own file here.
std::filesystem::path own_file(const support::SharedFolder& scratch) {
  return scratch / fmt::format("tip{}.csv", parallel::comm_rank(MPI_COMM_WORLD));
}

const std::vector<std::string> columns{"time [s]", "tip x [m]"};

void write_three(const std::filesystem::path& file) {
  Series series(file, columns);
  for (int i = 1; i <= 3; ++i) series.row(std::vector<double>{0.1 * i, 1.0 / i});
}

TEST(Series, a_row_is_on_disk_at_once_with_all_its_digits) {
  const support::SharedFolder scratch;
  Series series(own_file(scratch), columns);
  series.row(std::vector<double>{0.1 + 0.2, 1.0 / 3});
  EXPECT_EQ(text_of(own_file(scratch)), "time [s],tip x [m]\n0.30000000000000004,0.3333333333333333\n");
}

TEST(Series, a_fresh_start_forgets_the_old_rows) {
  const support::SharedFolder scratch;
  write_three(own_file(scratch));
  Series series(own_file(scratch), columns);
  EXPECT_EQ(text_of(own_file(scratch)), "time [s],tip x [m]\n");
}

TEST(Series, a_restart_drops_the_later_rows_and_keeps_the_others) {
  const support::SharedFolder scratch;
  write_three(own_file(scratch));
  {
    Series series(own_file(scratch), columns, 0.2);
    series.row(std::vector<double>{0.25, 7});
  }
  EXPECT_EQ(text_of(own_file(scratch)), "time [s],tip x [m]\n0.1,1\n0.2,0.5\n0.25,7\n");
}

std::string said(const std::function<void()>& action) {
  testing::internal::CaptureStdout();
  action();
  return testing::internal::GetCapturedStdout();
}

TEST(Series, a_lost_file_is_named) {
  const support::SharedFolder scratch;
  const std::string rank = std::to_string(parallel::comm_rank(MPI_COMM_WORLD));
  const std::filesystem::path out = scratch / rank, file = out / "solid/tip.csv";
  const CheckpointStamp stamp{.run = "1", .step = 2, .time = 0.2};
  finish_checkpoint_set(begin_checkpoint_set(out / "checkpoints", stamp), stamp);
  EXPECT_THAT(said([&] { Series(file, columns, 0.2); }),
              HasSubstr("tip.csv' did not exist at the restart: it begins at t = 0.2 s"));
  EXPECT_EQ(said([&] { Series(file, columns, 0.2); }), "");
  EXPECT_EQ(said([&] { Series(scratch / rank / "elsewhere/solid/tip.csv", columns, 0.2); }), "");
  EXPECT_EQ(said([&] { write_three(file); }), "");
  EXPECT_THAT(said([&] {
                Series series(file, columns);
                series.row(std::vector<double>{1, 1});
                std::filesystem::remove(file);
              }),
              HasSubstr("tip.csv' was removed during the run"));
}

TEST(Series, a_row_cut_by_a_crash_is_dropped) {
  const support::SharedFolder scratch;
  write_three(own_file(scratch));
  std::ofstream(own_file(scratch), std::ios::app) << "0.4,0.2";
  Series(own_file(scratch), columns, 5.0);
  EXPECT_EQ(text_of(own_file(scratch)),
            "time [s],tip x [m]\n0.1,1\n0.2,0.5\n0.30000000000000004,0.3333333333333333\n");
}

TEST(Series, a_restart_without_an_old_file_begins_one) {
  const support::SharedFolder scratch;
  Series(own_file(scratch), columns, 0.2);
  EXPECT_EQ(text_of(own_file(scratch)), "time [s],tip x [m]\n");
}

TEST(Series, other_columns_are_not_mixed_into_an_old_file) {
  const support::SharedFolder scratch;
  write_three(own_file(scratch));
  EXPECT_THAT(support::error_of([&] {
                Series(own_file(scratch), {"time [s]", "force [N]"}, 0.2);
              }),
              HasSubstr("its columns are 'time [s],tip x [m]', but those of this run are"));
}

TEST(Series, a_row_of_another_length_is_refused) {
  const support::SharedFolder scratch;
  Series series(own_file(scratch), columns);
  EXPECT_THAT(support::error_of([&] { series.row(std::vector<double>{1.0}); }),
              HasSubstr("has 1 values, but its header has 2 columns"));
}

}  // namespace couplet::series_test
