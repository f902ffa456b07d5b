// SPDX-License-Identifier: Apache-2.0
#include "common/app/loop/step_loop.hpp"

#include "common/base/own_file.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_set.hpp"
#include "tests/support/test.hpp"

namespace couplet::step_loop_test {
using namespace app;
using namespace io;

namespace fs = std::filesystem;
using testing::HasSubstr;

class Checkpoints : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  /// A run to this time in steps of 1 s that saves its time after each.
  void run_to(double end, int keep = 2, const fs::path& restart = {}, bool takes_over = false) {
    SimulationParameters simulation;
    simulation.end_time = end;
    simulation.time_step = 1;
    simulation.checkpoint_interval = 1;
    simulation.checkpoints_kept = keep;
    StepLoop loop(MPI_COMM_SELF, simulation, coupling::Scheme::standalone, folder);
    double time = 0;
    if (!restart.empty()) {
      loop.restart(read_run_state(restart), takes_over ? restart : fs::path());
      time = read_run_state(restart).time;
    }
    StepActions actions;
    steps.clear();
    actions.attempt = [&](const coupling::Step& step) {
      steps.push_back(step);
      return std::nullopt;
    };
    actions.accept = [&](double t, int) { time = t; };
    actions.write_start = [](int) {};
    actions.report = [](const coupling::Step&, double) {};
    actions.save = [&](const fs::path& place) {
      CheckpointWriter file(MPI_COMM_SELF, place / "one.h5");
      file.write_common("time", std::array<double, 1>{time});
      file.close();
    };
    ASSERT_EQ(loop.run(actions), "");
  }
  double saved_time(const fs::path& place) {
    return CheckpointReader(MPI_COMM_SELF, place / "one.h5").read_common("time").front();
  }
  static std::string error_of(const std::function<void()>& action) {
    return support::error_of([&] { action(); });
  }
  static std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  fs::path folder = fs::temp_directory_path() / fmt::format("couplet-app-{}", ::getpid());
  std::vector<coupling::Step> steps;  ///< tried in the last run
};

TEST_F(Checkpoints, a_participant_is_told_the_last_step_and_takes_one_step_of_its_own_in_each) {
  run_to(3);
  ASSERT_EQ(steps.size(), 3u);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i].is_last, i == 2) << i;
    EXPECT_EQ(steps[i].sub_steps, 1) << i;
    EXPECT_EQ(steps[i].number, GlobalIndex(i));
  }
}

TEST_F(Checkpoints, the_one_that_has_gone_furthest_is_taken_not_the_newest_file) {
  run_to(4, 9);
  const auto long_ago = fs::last_write_time(folder / "step-00000004/set.txt") - std::chrono::hours(5);
  for (const auto& entry : fs::directory_iterator(folder / "step-00000004"))
    fs::last_write_time(entry.path(), long_ago);
  EXPECT_EQ(find_checkpoint(folder), folder / "step-00000004");
  EXPECT_EQ(find_checkpoint(folder / "step-00000002"), folder / "step-00000002");
  // A folder's name is a name: what is in it counts.
  fs::rename(folder / "step-00000004", folder / "step-00000001-kept");
  EXPECT_EQ(saved_time(find_checkpoint(folder)), 4);
}

TEST_F(Checkpoints, the_last_one_of_the_latest_run_is_taken_not_a_later_time_of_an_earlier_run) {
  run_to(4, 9);
  run_to(2, 9);
  EXPECT_TRUE(fs::exists(folder / "step-00000004/set.txt"));
  EXPECT_EQ(find_checkpoint(folder), folder / "step-00000002");
  EXPECT_EQ(find_checkpoint(folder / "step-00000004"), folder / "step-00000004");
  run_to(3, 9, folder / "step-00000002");
  EXPECT_EQ(find_checkpoint(folder), folder / "step-00000003");
}

TEST_F(Checkpoints, only_those_of_this_run_are_deleted) {
  run_to(3, 9);
  fs::create_directories(folder / "step-by-step/notes");
  std::ofstream(folder / "step-by-step/notes/mine.txt") << "precious";
  std::ofstream(folder / "step-notes.txt") << "precious";
  run_to(6, 1, folder / "step-00000003");
  EXPECT_TRUE(fs::exists(folder / "step-by-step/notes/mine.txt"));
  EXPECT_TRUE(fs::exists(folder / "step-notes.txt"));
  for (const char* kept : {"step-00000001", "step-00000002", "step-00000003", "step-00000006"})
    EXPECT_TRUE(fs::exists(folder / kept / "set.txt")) << kept;
  for (const char* gone : {"step-00000004", "step-00000005"}) EXPECT_FALSE(fs::exists(folder / gone)) << gone;
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename());
  return names;
}

// However often a run is continued: as many are kept as are wanted.
TEST_F(Checkpoints, of_the_runs_that_it_continues_are_deleted_as_its_own) {
  run_to(3, 2);
  for (const int from : {3, 4, 5, 6}) run_to(from + 1, 2, folder / fmt::format("step-{:08d}", from), true);
  EXPECT_EQ(names_in(folder), (std::set<std::string>{"step-00000006", "step-00000007"}));
}

TEST_F(Checkpoints, of_a_run_behind_the_time_it_is_continued_at_stay) {
  run_to(5, 9);
  run_to(3, 1, folder / "step-00000002", true);
  for (const char* gone : {"step-00000001", "step-00000002"}) EXPECT_FALSE(fs::exists(folder / gone)) << gone;
  for (const char* kept : {"step-00000003", "step-00000004", "step-00000005"})
    EXPECT_TRUE(fs::exists(folder / kept)) << kept;
}

TEST_F(Checkpoints, of_external_programs_go_with_them_and_what_came_later_stays) {
  fs::create_directories(folder);
  const CheckpointStamp stamp{"0001-a", 7, 0.7};
  const fs::path place = begin_checkpoint_set(folder, stamp);
  fs::create_directories(place / "partner/0.7");
  std::ofstream(place / "partner/0.7/U") << "velocity";
  std::ofstream(place / "partner.bin") << "state";
  finish_checkpoint_set(place, stamp);
  EXPECT_EQ(read_checkpoint_set(place)->files.size(), 2u);
  std::ofstream(place / "notes.txt") << "precious";
  remove_checkpoint_set(place);
  EXPECT_EQ(names_in(place), (std::set<std::string>{"notes.txt"}));
}

TEST_F(Checkpoints, a_folder_or_a_link_of_the_user_in_the_way_stays_as_it_is) {
  fs::create_directories(folder / "step-00000001");
  std::ofstream(folder / "step-00000001/mine.txt") << "precious";
  fs::create_directories(folder / "elsewhere");
  std::ofstream(folder / "elsewhere/one.h5") << "precious";
  fs::create_directory_symlink(folder / "elsewhere", folder / "step-00000002");
  run_to(2, 9);
  EXPECT_EQ(text_of(folder / "step-00000001/mine.txt"), "precious");
  EXPECT_FALSE(fs::exists(folder / "step-00000001/one.h5"));
  EXPECT_EQ(text_of(folder / "elsewhere/one.h5"), "precious");
  EXPECT_EQ(saved_time(find_checkpoint(folder)), 2) << "written beside them";
}

TEST_F(Checkpoints, a_file_is_not_written_through_a_link) {
  std::ofstream(folder / "precious") << "precious";
  fs::create_symlink(folder / "precious", folder / "link");
  EXPECT_THAT(error_of([&] { base::own_file(folder / "link"); }), HasSubstr("is a symbolic link"));
  EXPECT_EQ(base::own_file(folder / "precious"), folder / "precious");
  EXPECT_EQ(base::own_file(folder / "new"), folder / "new");
  EXPECT_THAT(error_of([&] { CheckpointWriter(MPI_COMM_SELF, folder / "a.h5"); }), "");
  fs::create_symlink(folder / "precious", folder / "a.h5.part");
  EXPECT_THAT(error_of([&] { CheckpointWriter(MPI_COMM_SELF, folder / "a.h5"); }),
              HasSubstr("is a symbolic link"));
  EXPECT_EQ(text_of(folder / "precious"), "precious");
}

TEST_F(Checkpoints, what_a_run_left_half_written_is_no_checkpoint_and_is_cleared) {
  run_to(2, 9);
  const CheckpointStamp stamp{"0123", 3, 3.0};
  const fs::path half = begin_checkpoint_set(folder, stamp);
  {
    CheckpointWriter file(MPI_COMM_SELF, half / "one.h5");
    file.write_common("time", std::array<double, 1>{3});
    file.close();
  }
  EXPECT_EQ(find_checkpoint(folder), folder / "step-00000002");
  EXPECT_THAT(error_of([&] { find_checkpoint(half); }), HasSubstr("no complete checkpoint found"));
  run_to(2, 9);
  EXPECT_FALSE(fs::exists(half));
}

TEST_F(Checkpoints, files_of_two_sets_are_not_read_together) {
  run_to(3, 9);
  const fs::path last = folder / "step-00000003", before = folder / "step-00000002";
  EXPECT_EQ(saved_time(last), 3);
  fs::copy_file(before / "one.h5", last / "one.h5", fs::copy_options::overwrite_existing);
  EXPECT_THAT(error_of([&] { saved_time(last); }), HasSubstr("is not the file written with this checkpoint"));
  fs::copy_file(before / "set.txt", last / "set.txt", fs::copy_options::overwrite_existing);
  EXPECT_EQ(saved_time(last), 2) << "now both are of step 2";
  EXPECT_THAT(error_of([&] { read_run_state(last); }), HasSubstr("is not the file written"));
}

TEST_F(Checkpoints, a_flipped_bit_in_a_scalar_is_noticed) {
  run_to(1);
  const fs::path file = folder / "step-00000001/one.h5";
  std::string bytes = text_of(file);
  const double value = 1;
  const auto at = bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof value));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 6] = char(bytes[at + 6] ^ 1);
  std::ofstream(file, std::ios::binary) << bytes;
  EXPECT_THAT(error_of([&] { saved_time(file.parent_path()); }), HasSubstr("its digest differs"));
}

/// What a run says whose steps of `dt` fail for `reason(dt)`.
std::string end_of_a_run_that_fails(const std::function<std::string(double)>& reason) {
  SimulationParameters simulation;
  simulation.end_time = simulation.time_step = 1;
  simulation.max_step_halvings = 2;
  StepLoop loop(MPI_COMM_SELF, simulation, coupling::Scheme::standalone, fs::temp_directory_path());
  StepActions actions;
  actions.stateless = "nothing to save";
  actions.attempt = [&](const coupling::Step& step) { return StepFailure{reason(step.dt)}; };
  actions.write_start = [](int) {};
  return loop.run(actions);
}

TEST(StepLoop, names_the_first_failure_of_a_step_where_the_last_one_is_another) {
  EXPECT_EQ(
      end_of_a_run_that_fails([](double dt) {
        return dt > 0.3 ? fmt::format("The pressure {} is lost.", dt) : "No solver for it.";
      }),
      "The step from t = 0 s failed, even with dt = 0.25 s after 2 halvings: No solver for it. It failed "
      "first with dt = 1 s: The pressure 1 is lost. No state was saved: nothing to save.");
  EXPECT_EQ(
      end_of_a_run_that_fails([](double dt) { return fmt::format("The pressure {} is lost.", dt); }),
      "The step from t = 0 s failed, even with dt = 0.25 s after 2 halvings: The pressure 0.25 is lost. No "
      "state was saved: nothing to save.");
}

}  // namespace couplet::step_loop_test
