// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "common/base/text.hpp"
#include "common/config/values.hpp"
#include "common/diagnostics/finding.hpp"

namespace couplet::app {
namespace {

// Equal to the project's version in CMakeLists.txt; a test compares them.
constexpr const char* version = "1.0.0";

using Items = std::vector<config::Item>;

/// First level of the program's parameters, one line each.
std::string list_keys(const Items& items) {
  std::size_t width = 0;
  for (const config::Item& item : items) width = std::max(width, item.facts.name.size());
  std::string out;
  for (const config::Item& item : items) {
    const config::Key::Facts& facts = item.facts;
    out += fmt::format("  {:<{}}  {}{}{}\n", facts.name, width, facts.doc,
                       facts.unit.empty() ? "" : fmt::format(" [{}]", facts.unit),
                       facts.required ? " (required)" : "");
  }
  return out;
}

std::string footer(const ProgramText& program) {
  const Items items = config::describe(program.declare, config::Describe::everything);
  const bool is_participant = std::any_of(
      items.begin(), items.end(), [](const config::Item& item) { return item.facts.name == "program"; });
  const std::string alone =
      fmt::format("Alone:      mpirun -n 4 {} case.yaml --participant NAME\n", program.name);
  return fmt::format(
      "Keys of {} in the YAML file ({} --docs prints the full reference):\n"
      "{}\n"
      "{}Coupled:    couplet run case.yaml -n fluid=2, or mpirun -n 5 couplet-exec case.yaml -n fluid=2\n"
      "Exit codes: 0 done, 1 the run failed, 2 invalid configuration or command line, 3 stopped by SIGTERM "
      "with a checkpoint to continue from, 4 done, but the result is provably useless (--accept ID accepts "
      "it).",
      is_participant ? "this program's section under 'participants'" : "the section 'coupling'", program.name,
      list_keys(items), is_participant ? alone : "");
}

std::string explain_extra(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const auto meant = word.starts_with('-') ? base::closest(word, names) : std::nullopt;
  return fmt::format("Unknown option or argument '{}'.{}", word,
                     meant ? fmt::format(" Did you mean '{}'?", *meant) : "");
}

CommandLine::Strict strictness(const std::string& word) {
  if (word.empty()) return CommandLine::Strict::no;
  if (word == "answer" || word == "true") return CommandLine::Strict::answer;
  if (word == "effects") return CommandLine::Strict::effects;
  throw CLI::ValidationError("--strict=" + word + ": use --strict or --strict=effects.");
}

/// Options that are not stored in the command line.
struct Flags {
  bool check = false, docs = false, schema = false, print_config = false, explain = false, verbose = false,
       quiet = false;
  std::string strict, diagnostics;
};

void add_options(CLI::App& app, CommandLine& line, Flags& flags) {
  app.add_option("case", line.case_file, "YAML file of the case")->type_name("case.yaml");
  app.add_option("--participant", line.participant,
                 "name under 'participants' in the YAML file; required if several participants use this "
                 "program")
      ->type_name("NAME");
  app.add_option("--set", line.overrides,
                 "set one value, for example --set simulation.end-time='2 s'; repeatable")
      ->type_name("a.b=v")
      ->allow_extra_args(false);
  app.add_option("--restart", line.restart_folder, "continue from the checkpoints in this folder")
      ->type_name("FOLDER");
  app.add_flag("--restart-with-changes", line.restart_with_changes,
               "continue although keys that change the solution differ from those of the checkpoint");
  app.add_flag("--allow-commands", line.allow_commands,
               "allow a .geo to run commands and write files, with your permissions");
  app.add_flag(
      "--strict{answer}", flags.strict,
      "exit with code 1 if the run warns about its own result; --strict=effects: also if it warns about neglected effects");
  app.add_option(
         "--accept", line.accept,
         "accept a finding by its id (in brackets at the end of its line; docs/findings.md); repeatable")
      ->type_name("ID")
      ->allow_extra_args(false);
  app.add_option(
         "--diagnostics", flags.diagnostics,
         "short for --set simulation.diagnostics=WORD (standard, without-errors or full, which includes searches that may take "
         "as long as a solve)")
      ->type_name("WORD");
  app.add_flag("--check", flags.check, "only check the configuration; exit code 0 or 2");
  app.add_flag("--docs", flags.docs, "print the reference of all keys as Markdown");
  app.add_flag("--schema", flags.schema, "print the JSON schema of all keys, for editors");
  app.add_flag("--print-config", flags.print_config, "print all values in effect as YAML");
  app.add_flag("--explain", flags.explain,
               "print the effects in the case, their cost and the launch line without running the case");
  app.add_flag("-v,--verbose", flags.verbose, "log more, on every rank");
  app.add_flag("-q,--quiet", flags.quiet, "log warnings and errors only");
}

void take_task(const Flags& flags, CommandLine& line) {
  using Task = CommandLine::Task;
  if (flags.check) line.task = Task::check;
  if (flags.docs) line.task = Task::docs;
  if (flags.schema) line.task = Task::schema;
  if (flags.print_config) line.task = Task::print_config;
  if (flags.explain) line.task = Task::explain;
  line.verbosity = flags.verbose ? log::Verbosity::verbose
                   : flags.quiet ? log::Verbosity::quiet
                                 : log::Verbosity::normal;
}

}  // namespace

std::string version_text() { return fmt::format("couplet {}", version); }

ParsedCommandLine parse_command_line(int argc, const char* const* argv, const ProgramText& program) {
  ParsedCommandLine result;
  CommandLine& line = result.command_line;
  Flags flags;

  CLI::App app(program.description, program.name);
  app.footer([&] { return footer(program); });
  app.set_version_flag("--version", version_text());
  add_options(app, line, flags);
  // Unknown options are reported by our own message with a suggestion.
  app.allow_extras();
  try {
    app.parse(argc, argv);
    if (const std::vector<std::string> rest = app.remaining(); !rest.empty())
      throw CLI::ExtrasError(explain_extra(app, rest.front()), CLI::ExitCodes::ExtrasError);
    if (flags.check + flags.docs + flags.schema + flags.print_config + flags.explain > 1)
      throw CLI::ExcludesError("Use only one of --check, --docs, --schema, --print-config and --explain.",
                               CLI::ExitCodes::ExcludesError);
    if (flags.verbose && flags.quiet)
      throw CLI::ExcludesError("Use either --verbose or --quiet, not both.", CLI::ExitCodes::ExcludesError);
    line.strict = strictness(flags.strict);
    if (const std::string problem = diagnostics::unknown_ids(line.accept); !problem.empty())
      throw CLI::ValidationError("--accept: " + problem);
    if (line.case_file.empty() && !flags.docs && !flags.schema)
      throw CLI::ValidationError("Give the YAML file of the case, for example: " + program.name +
                                 " case.yaml");
  } catch (const CLI::ParseError& error) {
    std::ostringstream out, err;
    result.exit_code = app.exit(error, out, err) == 0 ? 0 : 2;
    result.output = out.str() + err.str();
    return result;
  }
  if (!flags.diagnostics.empty()) line.overrides.push_back("simulation.diagnostics=" + flags.diagnostics);
  take_task(flags, line);
  return result;
}

}  // namespace couplet::app
