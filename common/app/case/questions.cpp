// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/questions.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <sstream>

#include "common/app/case/check_files.hpp"
#include "common/base/error.hpp"

namespace couplet::app {
namespace {

/// What is missing or broken among the files of a participant: what every program's --check sees, then its own.
std::vector<std::string> problems(const CaseFile& file, const ProgramKind& kind,
                                  const std::filesystem::path& case_folder) {
  std::vector<std::string> all = problems_of_files(*file.document, file.participant, case_folder);
  if (!all.empty() || !kind.problems_of_files) return all;
  for (const ProblemOfKey& problem : kind.problems_of_files(case_folder))
    all.push_back(fmt::format(
        "{}: {}", config::where(*file.document, "participants." + file.participant + "." + problem.key),
        problem.what));
  return all;
}

int check(const CommandLine& command_line, const ProgramKind& kind, bool print) {
  CaseFile file = read_case(command_line, kind);
  if (!print && file.errors.empty() && !kind.is_coupler)
    file.errors = problems(file, kind, command_line.case_file.parent_path());
  if (!print && file.errors.empty())
    if (std::string problem = problem_of_restart(command_line, file, kind.is_coupler); !problem.empty())
      file.errors.push_back(std::move(problem));
  if (!file.errors.empty()) {
    for (const std::string& error : file.errors) fmt::print(stderr, "{}\n", error);
    return 2;
  }
  for (const std::string& doubt : file.doubts) fmt::print(stderr, "warning: {}\n", doubt);
  if (!print) {
    fmt::print("{}: valid\n", command_line.case_file.string());
    return 0;
  }
  const auto section = [](const std::string& title, const std::string& text, int depth) {
    fmt::print("{:{}}{}:\n", "", 2 * (depth - 1), title);
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) fmt::print("{:{}}{}\n", "", 2 * depth, line);
  };
  section("simulation", config::effective([&](config::Section& s) { declare(s, file.simulation); }), 1);
  const std::string own = config::effective(section_of(kind));
  if (kind.is_coupler) {
    section("coupling", own, 1);
  } else {
    fmt::print("participants:\n");
    section(file.participant, own, 2);
  }
  return 0;
}

}  // namespace

namespace {

/// Without its mesh nothing can be expected; what is wrong with it a run will say.
void print_expected(const CommandLine& command_line, const ProgramKind& kind) {
  diagnostics::CaseScene scene;
  scene.folder = command_line.case_file.parent_path();
  try {
    fmt::print("expected:         {}\n", diagnostics::text(kind.expected(scene)));
  } catch (const Error& error) {
    fmt::print("expected:         unknown: {}\n", error.what());
  }
}

/// The effects of the scene and the launch line, without running anything.
int explain(const CommandLine& command_line, const ProgramKind& kind) {
  const CaseFile file = read_case(command_line, kind);
  if (!file.errors.empty()) {
    for (const std::string& error : file.errors) fmt::print(stderr, "{}\n", error);
    return 2;
  }
  const bool has_mover = config::text_of(*file.document, "coupling.mesh.participant").has_value();
  fmt::print("{} as '{}' of {}:\n", kind.name, kind.is_coupler ? "coupler" : file.participant,
             command_line.case_file.string());
  for (const diagnostics::EffectChoice& choice : file.choices) fmt::print("  {}\n", diagnostics::text(choice));
  if (kind.effects)
    fmt::print("{}", diagnostics::explanation(
                         kind.effects({file.coupled, file.coupled && has_mover, file.simulation.time_step})));
  if (kind.expected) print_expected(command_line, kind);
  std::string job;
  for (const Expected& e : file.expected)
    job += fmt::format("{} -n 1 {} {}", job.empty() ? "mpirun" : " :", e.program,
                       command_line.case_file.string());
  if (file.coupled)
    fmt::print("whole case:       {}\n", job);
  else
    fmt::print("launch:           {} {}\n", kind.name, command_line.case_file.string());
  return 0;
}

}  // namespace

int answer(const CommandLine& command_line, const ProgramKind& kind) {
  using Task = CommandLine::Task;
  SimulationParameters simulation;
  switch (command_line.task) {
    case Task::check:
    case Task::print_config:
      return check(command_line, kind, command_line.task == Task::print_config);
    case Task::docs:
      fmt::print("{}", config::markdown(kind.name, section_of(kind)));
      if (kind.is_coupler)
        fmt::print("\n{}",
                   config::markdown("simulation", [&](config::Section& s) { declare(s, simulation); }));
      return 0;
    case Task::schema:
      fmt::print("{}\n", config::json_schema(kind.name, section_of(kind)));
      return 0;
    case Task::explain:
      return explain(command_line, kind);
    case Task::effects:
      if (kind.effects) fmt::print("{}", diagnostics::markdown(kind.name, kind.effects({})));
      return 0;
    case Task::run:
      break;
  }
  return 0;
}

}  // namespace couplet::app
