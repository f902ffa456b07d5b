// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/roll_call.hpp"
#include "tests/support/test.hpp"

namespace couplet::roll_call_test {
using namespace app;

using testing::HasSubstr;

const std::vector<Expected> expected{
    {"coupler", "coupler"}, {"fluid", "fluid_solver"}, {"solid", "solid_solver"}};

/// One process of each participant, in the order of `names`, each its own part of the launch line.
std::vector<Attendant> come(const std::vector<std::string>& names) {
  std::vector<Attendant> list;
  for (const std::string& name : names) {
    Attendant a;
    a.participant = name;
    a.program = name == coupler_name ? name : name + "_solver";
    a.case_file = "case.yaml";
    a.case_hash = 7;
    a.application = a.world_rank = int(list.size());
    list.push_back(a);
  }
  return list;
}

TEST(RollCall, passes_when_all_are_there_in_any_order) {
  const Attendance attendance = attendance_of(come({"solid", "coupler", "fluid"}), expected, true);
  EXPECT_EQ(attendance.problem, "");
  EXPECT_FALSE(attendance.alone);
}

TEST(RollCall, names_who_is_missing_and_how_to_start) {
  EXPECT_EQ(attendance_of(come({"coupler", "fluid"}), expected, true).problem,
            "The job cannot start:\n"
            "  participant 'solid' (solid_solver) is missing: it was not started.\n"
            "  Start it with: couplet run case.yaml");
}

TEST(RollCall, launch_line_has_a_placeholder_for_a_program_that_is_not_there) {
  std::vector<Expected> foreign = expected;
  foreign[1].program = "no-such-program";
  std::vector<Attendant> list = come({"fluid", "coupler"});
  list.front().case_file = "(guest)", list.front().case_hash = 0;
  EXPECT_THAT(attendance_of(list, foreign, true).problem,
              HasSubstr("couplet run case.yaml --with fluid='COMMAND ...'"));
}

TEST(RollCall, launch_line_keeps_the_ranks_that_have_come) {
  std::vector<Attendant> list = come({"coupler", "fluid"});
  list.push_back(list.back());
  EXPECT_THAT(attendance_of(list, expected, true).problem, HasSubstr("couplet run case.yaml -n fluid=2"));
}

TEST(RollCall, ranks_of_one_part_are_one_participant_and_two_parts_are_two) {
  std::vector<Attendant> list = come({"coupler", "fluid", "solid", "solid"});
  EXPECT_THAT(attendance_of(list, expected, true).problem,
              HasSubstr("2 programs were started as participant 'solid' (solid_solver)"));
  list[3].application = list[2].application;
  EXPECT_EQ(attendance_of(list, expected, true).problem, "");
}

TEST(RollCall, other_file_contents_are_named_with_both_sides) {
  std::vector<Attendant> list = come({"coupler", "fluid", "solid"});
  list[2].case_file = "old.yaml";
  list[2].case_hash = 8;
  EXPECT_THAT(attendance_of(list, expected, true).problem,
              HasSubstr("'coupler' reads case.yaml and 'solid' reads old.yaml, and the contents differ."));
}

TEST(RollCall, configuration_errors_come_once_with_their_senders) {
  std::vector<Attendant> list = come({"coupler", "fluid", "solid", "solid"});
  for (Attendant& a : list) a.errors = {"case.yaml:1:1: of all"};
  list[2].errors.push_back("case.yaml:9:3: of one");
  list[3].errors.push_back("case.yaml:9:3: of one");
  EXPECT_EQ(attendance_of(list, expected, true).problem,
            "The job cannot start:\n  case.yaml:1:1: of all\n  [solid] case.yaml:9:3: of one");
}

TEST(RollCall, one_program_runs_alone_if_nothing_else_is_asked_for) {
  std::vector<Attendant> list = come({"solid"});
  EXPECT_TRUE(attendance_of(list, {{"solid", "solid_solver"}}, false).alone);
  EXPECT_THAT(attendance_of(list, expected, true).problem,
              HasSubstr("To run 'solid' alone: solid_solver case.yaml --participant solid"));
  list[0].named = true;
  EXPECT_TRUE(attendance_of(list, expected, true).alone);
}

TEST(RollCall, all_processes_hear_all_answers) {
  Attendant self;
  self.program = "solid_solver";
  self.participant = "solid";
  self.case_file = "case with blanks.yaml";
  self.case_hash = std::size_t(-1);
  self.world_rank = parallel::comm_rank(MPI_COMM_WORLD);
  self.errors = std::vector<std::string>(std::size_t(self.world_rank), "a line\nand another");
  const std::vector<Attendant> all = roll_call(MPI_COMM_WORLD, self);
  ASSERT_EQ(int(all.size()), parallel::comm_size(MPI_COMM_WORLD));
  for (int r = 0; r < int(all.size()); ++r) {
    EXPECT_EQ(all[r].world_rank, r);
    EXPECT_EQ(all[r].case_file, self.case_file);
    EXPECT_EQ(all[r].case_hash, self.case_hash);
    EXPECT_EQ(all[r].restart, "");
    EXPECT_EQ(all[r].errors, std::vector<std::string>(std::size_t(r), "a line\nand another"));
  }
  ASSERT_EQ(members(all).size(), 1u);
  EXPECT_EQ(members(all)[0].ranks, parallel::comm_size(MPI_COMM_WORLD));
}

}  // namespace couplet::roll_call_test
