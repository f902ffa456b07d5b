// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/command_line.hpp"
#include "tests/support/test.hpp"

namespace couplet::command_line_test {
using testing::ElementsAre;
using testing::HasSubstr;
using Task = app::CommandLine::Task;

app::ParsedCommandLine parse(std::vector<const char*> arguments) {
  static double density = 1000;
  static std::string name;
  arguments.insert(arguments.begin(), "solid_solver");
  return app::parse_command_line(
      static_cast<int>(arguments.size()), arguments.data(),
      {"solid_solver", "Elastic solids.", [](config::Section& s) {
         s.value("program", name);
         s.value("density", density).unit("kg/m^3").required().doc("mass per volume");
       }});
}

TEST(CommandLine, everything_that_can_be_asked_for_arrives) {
  const auto [line, exit_code, output] = parse({"a/case.yaml", "--participant", "flap", "--set", "a.b=1 m",
                                                "--set", "c=[1, 2]", "--restart", "old", "-v"});
  ASSERT_FALSE(exit_code.has_value()) << output;
  EXPECT_EQ(line.task, Task::run);
  EXPECT_EQ(line.case_file, "a/case.yaml");
  EXPECT_EQ(line.participant, "flap");
  EXPECT_THAT(line.overrides, ElementsAre("a.b=1 m", "c=[1, 2]"));
  EXPECT_EQ(line.restart_folder, "old");
  EXPECT_EQ(line.verbosity, log::Verbosity::verbose);
}

TEST(CommandLine, options_may_stand_before_the_case) {
  const auto parsed = parse({"--set", "a=1", "-q", "case.yaml"});
  EXPECT_EQ(parsed.command_line.case_file, "case.yaml");
  EXPECT_THAT(parsed.command_line.overrides, ElementsAre("a=1"));
  EXPECT_EQ(parsed.command_line.verbosity, log::Verbosity::quiet);
}

TEST(CommandLine, each_task_has_its_flag_and_documentation_needs_no_case) {
  EXPECT_EQ(parse({"c.yaml", "--check"}).command_line.task, Task::check);
  EXPECT_EQ(parse({"c.yaml", "--print-config"}).command_line.task, Task::print_config);
  EXPECT_EQ(parse({"--docs"}).command_line.task, Task::docs);
  EXPECT_EQ(parse({"--schema"}).command_line.task, Task::schema);
  EXPECT_FALSE(parse({"--docs"}).exit_code.has_value());
}

TEST(CommandLine, help_tells_options_keys_and_how_to_launch) {
  const auto parsed = parse({"--help"});
  EXPECT_EQ(parsed.exit_code, 0);
  for (const char* text :
       {"Elastic solids.", "--participant NAME", "--set a.b=v", "--restart FOLDER", "--check",
        "  density  mass per volume [kg/m^3] (required)", "mpirun -n 4 solid_solver case.yaml",
        "mpirun -n 5 couplet-exec case.yaml -n fluid=2", "Exit codes: 0",
        "Keys of this program's section under 'participants'"})
    EXPECT_THAT(parsed.output, HasSubstr(text));
}

TEST(CommandLine, the_version_is_that_of_the_project) {
  const auto parsed = parse({"--version"});
  EXPECT_EQ(parsed.exit_code, 0);
  EXPECT_EQ(parsed.output, "couplet " COUPLET_PROJECT_VERSION "\n");
}

TEST(CommandLine, a_wrong_command_line_leaves_with_code_2_and_says_why) {
  const auto message = [](const std::vector<const char*>& arguments) {
    const auto parsed = parse(arguments);
    EXPECT_EQ(parsed.exit_code, 2);
    return parsed.output.substr(0, parsed.output.find('\n'));
  };
  EXPECT_EQ(message({}), "Give the YAML file of the case, for example: solid_solver case.yaml");
  EXPECT_EQ(message({"a.yaml", "b.yaml"}), "Unknown option or argument 'b.yaml'.");
  EXPECT_EQ(message({"a.yaml", "--chekc"}), "Unknown option or argument '--chekc'. Did you mean '--check'?");
  EXPECT_EQ(message({"a.yaml", "--set"}), "--set: 1 required a.b=v missing");
  EXPECT_EQ(message({"a.yaml", "-v", "-q"}), "Use either --verbose or --quiet, not both.");
  EXPECT_EQ(message({"a.yaml", "--check", "--docs"}),
            "Use only one of --check, --docs, --schema, --print-config and --explain.");
}

}  // namespace couplet::command_line_test
