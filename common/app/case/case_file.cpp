// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/case_file.hpp"

#include <algorithm>
#include <memory>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/fv/expression.hpp"
#include "common/fv/table.hpp"

namespace couplet::app {
namespace {

constexpr std::size_t most_errors = 30, most_participants = 100, longest_participant_name = 50;

/// Reason why a participant cannot have this name, which becomes a folder and a file beside those of the run.
std::string problem_of_name(const std::string& name) {
  if (name.empty()) return "a participant needs a name";
  if (name == coupler_name) return "the coupler is not a participant; its keys are in `coupling`";
  if (name == "checkpoints" || name == "run")
    return "this name is reserved for a folder or file of the run; choose another";
  if (name.size() > longest_participant_name)
    return fmt::format("the name has {} characters; at most {} are allowed", name.size(),
                       longest_participant_name);
  const auto is_bad = [](char c) {
    return c == '/' || c == '\\' || c == ' ' || c == '.' || c == '\n' || c == '\t';
  };
  if (name.front() == '-' || std::any_of(name.begin(), name.end(), is_bad))
    return "the name becomes a folder name: it must not contain '/', '\\', '.' or blanks, nor start with '-'";
  return "";
}

void check_top_level(const config::Document& document, CaseFile& result) {
  static const std::vector<std::string> known{"simulation", "participants", "coupling", "study", "plot"};
  for (const std::string& key : config::keys_of(document, ""))
    if (std::find(known.begin(), known.end(), key) == known.end() && result.errors.size() < most_errors)
      result.errors.push_back(fmt::format("{}: unknown section. {}", config::where(document, key),
                                          base::did_you_mean(key, known, "sections")));
}

void list_expected(const config::Document& document, CaseFile& result) {
  result.coupled = !config::keys_of(document, "coupling").empty();
  if (result.coupled) result.expected.push_back({coupler_name, "coupler"});
  const std::vector<std::string> names = config::keys_of(document, "participants");
  if (names.size() > most_participants)
    throw Error("{}: there are {} participants, but at most {} are allowed.",
                config::where(document, "participants"), names.size(), most_participants);
  for (const std::string& name : names) {
    // The first invalid name is reported by itself, because its path cannot be looked up.
    if (const std::string problem = problem_of_name(name); !problem.empty())
      throw Error("{}: '{}': {}.", config::where(document, "participants"), name, problem);
    const auto program = config::text_of(document, "participants." + name + ".program");
    if (!program)
      result.errors.push_back(fmt::format(
          "{}: the key 'program' is missing. It names the program that runs this participant, for example solid_solver.",
          config::where(document, "participants." + name)));
    result.expected.push_back({name, program.value_or("?")});
  }
}

/// Finds the participant that this program must run. Throws Error.
std::string find_participant(const CommandLine& command_line, const Program& program, const CaseFile& file) {
  const std::string& source = file.document->name();
  if (program.is_coupler) {
    if (!command_line.participant.empty() && command_line.participant != coupler_name)
      throw Error("The coupler takes no --participant: it couples the participants named in {}.", source);
    if (!file.coupled)
      throw Error(
          "{}:1:1: the `coupling` section is missing, so the coupler has nothing to do: add the section "
          "(docs/config.md), or run each participant alone, without the coupler.",
          source);
    return coupler_name;
  }
  std::vector<std::string> names, mine;
  for (const Expected& e : file.expected) {
    if (e.participant == coupler_name) continue;
    names.push_back(e.participant);
    if (e.program == program.name) mine.push_back(e.participant);
  }
  if (names.empty())
    throw Error("{}:1:1: the `participants` section, which defines what {} runs, is missing.", source,
                program.name);
  const std::string& wanted = command_line.participant;
  if (!wanted.empty()) {
    if (std::find(names.begin(), names.end(), wanted) == names.end())
      throw Error("--participant {}: {} has no participant with this name. {}", wanted, source,
                  base::did_you_mean(wanted, names, "participants"));
    if (std::find(mine.begin(), mine.end(), wanted) == mine.end())
      throw Error(
          "--participant {}: this participant is run by the program '{}', but '{}' was started for it.",
          wanted, config::text_of(*file.document, "participants." + wanted + ".program").value_or("?"),
          program.name);
    return wanted;
  }
  if (mine.empty()) {
    std::vector<std::string> pairs;
    for (const Expected& e : file.expected)
      if (e.participant != coupler_name) pairs.push_back(fmt::format("'{}' ({})", e.participant, e.program));
    throw Error("{}: no participant is run by the program '{}': {}.",
                config::where(*file.document, "participants"), program.name, base::join(pairs));
  }
  if (mine.size() > 1)
    throw Error("{}: {} participants are run by the program '{}' ({}): select one with --participant.",
                config::where(*file.document, "participants"), mine.size(), program.name, base::join(mine));
  return mine.front();
}

/// Problem of an expression in x, y, z, t, of a property (a number or a table of the temperature T), or of a table of the flow rate q.
std::string problem_of_expression(const config::ExpressionText& text) {
  if (text.key.name == "pressure-drop") return fv::problem_of_property(text, "q");
  std::string problem = fv::problem_of(text);
  if (problem.find("unknown name 'T'") != std::string::npos) return fv::problem_of_property(text);
  return problem;
}

/// Applies `effects: auto`: sets keys that the case leaves open in the document. Existing keys are kept.
void choose(const CommandLine& command_line, const Program& program, CaseFile& result) {
  const diagnostics::CaseScene scene = scene_of(command_line, result);
  result.choices = program.choose(program.mesh(scene.folder), scene);
  const std::string section = "participants." + result.participant;
  const std::vector<std::string> there = config::keys_of(*result.document, section);
  for (diagnostics::EffectChoice& choice : result.choices) {
    choice.given = !choice.key.empty() && std::ranges::find(there, choice.key) != there.end();
    if (!choice.given && !choice.value.empty())
      result.document->set(fmt::format("{}.{}={}", section, choice.key, choice.value));
  }
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

diagnostics::CaseScene scene_of(const CommandLine& command_line, const CaseFile& file) {
  return {
      .folder = command_line.case_file.parent_path(),
      .end_time = file.simulation.end_time,
      .time_step = file.simulation.time_step,
      .coupled = file.coupled,
      .has_mover = file.coupled && config::text_of(*file.document, "coupling.mesh.participant").has_value()};
}

config::Section::Declare section_of(const Program& program) {
  if (program.is_coupler) return program.declare;
  const auto name = std::make_shared<std::string>(program.name);
  return [declare = program.declare, name](config::Section& section) {
    section.value("program", *name).required().doc("the program that runs this participant");
    declare(section);
  };
}

CaseFile read_case(const CommandLine& command_line, const Program& program) {
  CaseFile result;
  try {
    result.document.emplace(config::Document::read(command_line.case_file));
    for (const std::string& assignment : command_line.overrides) result.document->set(assignment);
    result.hash = result.document->hash();
    check_top_level(*result.document, result);
    list_expected(*result.document, result);
    if (result.coupled) append(result.errors, problems_of_roles(*result.document, result.expected));
    append(result.errors, share_seats(*result.document));
    std::vector<std::string> doubts;
    append(result.errors,
           config::load(
               *result.document, "simulation", [&](config::Section& s) { declare(s, result.simulation); }, {},
               &result.doubts));
    result.participant = find_participant(command_line, program, result);
    const auto load = [&] {
      return config::load(*result.document,
                          program.is_coupler ? "coupling" : "participants." + result.participant,
                          section_of(program), problem_of_expression, &doubts);
    };
    std::vector<std::string> problems = load();
    if (result.simulation.choose_effects && program.choose && result.errors.empty()) {
      choose(command_line, program, result);  // the first load may miss keys that are chosen now
      problems = load();
    }
    append(result.errors, problems);
    append(result.doubts, doubts);
    // Reported once per job.
    if (config::text_of(*result.document, "coupling.fluid.participant") == result.participant)
      append(result.doubts, check_wall_mass(*result.document));
  } catch (const Error& error) {
    result.errors.emplace_back(error.what());
  }
  return result;
}

}  // namespace couplet::app
