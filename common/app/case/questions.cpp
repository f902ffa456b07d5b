// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/case_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <span>
#include <sstream>

#include "common/app/case/roll_call.hpp"
#include "common/app/loop/step_loop.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/config/document.hpp"
#include "common/diagnostics/results.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/io/cut_mesh.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/readers/read_msh.hpp"

namespace couplet::app {

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class FileCheck {
 public:
  FileCheck(const config::Document& document, std::string section, fs::path folder)
      : document_(document), section_(std::move(section)), folder_(std::move(folder)) {}

  Names run() {
    if (const auto name = config::text_of(document_, section_ + ".mesh")) check_mesh(*name);
    check_other_files();
    return std::move(problems_);
  }

 private:
  void report(const std::string& key, const std::string& text) {
    problems_.push_back(fmt::format("{}: {}", config::where(document_, section_ + "." + key), text));
  }

  void check_mesh(const std::string& name) {
    const fs::path file = folder_ / name;
    std::error_code ignored;
    // Caches are created on demand, some by a script of the case.
    if (name.ends_with(".cache.msh") && !fs::exists(file, ignored)) return;
    try {
      if (!io::is_cut_mesh(file) || !fs::exists(file, ignored)) mesh::check_mesh_file(file);
      if (file.extension() == ".msh") {
        if (!mesh::is_converted(file)) check_patches(mesh::read_msh(file).patches);
      } else if (mesh::is_foreign(file.extension())) {
        check_patches(mesh::read_foreign(file).patches);
      } else if (file.extension() == ".geo") {
        check_geo(mesh::read_geo(file));
      } else if (io::is_cut_mesh(file)) {
        check_patches(io::read_cut_mesh_facts(file).patches);
      }
    } catch (const Error& error) {
      report("mesh", error.what());
    }
  }

  void check_geo(const mesh::GeoScript& script) {
    for (const std::string& name : config::keys_of(document_, section_ + ".mesh-parameters"))
      if (std::find(script.constants.begin(), script.constants.end(), name) == script.constants.end())
        report("mesh-parameters." + name, fmt::format("the .geo defines no such name with DefineConstant. {}",
                                                      base::did_you_mean(name, script.constants, "names")));
    const auto dimension = config::text_of(document_, section_ + ".dimension");
    if (dimension != "2" && dimension != "3") return;
    std::optional<Names> patches = script.groups[*dimension == "2" ? 1 : 2];
    if (!patches) return;
    // Only gmsh knows whether some boundary is in no group.
    for (const std::string& entry : config::keys_of(document_, section_ + ".boundaries"))
      if (entry == "rest" && std::ranges::find(*patches, entry) == patches->end()) patches->push_back(entry);
    check_patches(*patches);
  }

  void check_patches(const Names& patches) {
    if (patches.empty()) return;
    const Names entries = config::keys_of(document_, section_ + ".boundaries");
    const auto has = [](const Names& names, const std::string& name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    for (const char* key : {"boundaries", "heat.boundaries"})
      for (const std::string& entry : config::keys_of(document_, section_ + "." + key))
        if (!has(patches, entry))
          report(fmt::format("{}.{}", key, entry),
                 fmt::format("the mesh has no patch with this name. {}",
                             base::did_you_mean(entry, patches, "patches")));
    // In pure heat conduction a patch without an entry is adiabatic.
    if (config::text_of(document_, section_ + ".analysis") == "thermal") return;
    for (const std::string& patch : patches)
      if (!has(entries, patch))
        report("boundaries", fmt::format("the patch '{}' of the mesh has no entry here.", patch));
  }

  void check_other_files() {
    for (const auto& [path, value] : config::leaves(document_)) {
      if (!path.starts_with(section_ + ".") || !path.ends_with(".file")) continue;
      std::error_code ignored;
      if (!fs::is_regular_file(folder_ / value, ignored))
        report(path.substr(section_.size() + 1),
               fmt::format("the file '{}' does not exist.", (folder_ / value).string()));
    }
  }

  const config::Document& document_;
  std::string section_;
  fs::path folder_;
  Names problems_;
};

}  // namespace

std::vector<std::string> problems_of_files(const config::Document& document, const std::string& participant,
                                           const fs::path& case_folder) {
  return FileCheck(document, "participants." + participant, case_folder).run();
}

std::string problem_of_restart(const CommandLine& command_line, const CaseFile& file, bool is_coupler) {
  if (command_line.restart_folder.empty()) return "";
  const std::string own = (is_coupler ? std::string(coupler_name) : file.participant) + ".h5";
  try {
    const std::filesystem::path folder = find_checkpoint(command_line.restart_folder);
    const auto set = io::read_checkpoint_set(folder);
    bool has_own = false;
    for (const io::CheckpointSet::File& part : set->files) {
      if (const std::string problem = io::problem_in_set(folder / part.name); !problem.empty())
        return fmt::format("--restart {}: {}", folder.string(), problem);
      has_own = has_own || part.name == own;
      if (part.name == own || part.name == run_file)
        if (const std::string problem = io::problem_of_checkpoint(folder / part.name); !problem.empty())
          return fmt::format("--restart {}: {}", folder.string(), problem);
    }
    if (!has_own)
      return fmt::format(
          "--restart {}: the checkpoint has no file {}: the run that wrote it did not include this program.",
          folder.string(), own);
    if (is_coupler || !file.coupled)
      check_changes(folder, case_keys(*file.document, command_line.case_file.parent_path()),
                    command_line.restart_with_changes);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

namespace {

/// Problems of a participant's files: general ones, or else those found by its program.
std::vector<std::string> problems(const CaseFile& file, const Program& program,
                                  const diagnostics::CaseScene& scene) {
  std::vector<std::string> all = problems_of_files(*file.document, file.participant, scene.folder);
  if (!all.empty() || !program.problems_of_files) return all;
  for (const ProblemOfKey& problem : program.problems_of_files(scene))
    all.push_back(fmt::format(
        "{}: {}", config::where(*file.document, "participants." + file.participant + "." + problem.key),
        problem.what));
  return all;
}

int check(const CommandLine& command_line, const Program& program, bool print) {
  CaseFile file = read_case(command_line, program);
  if (!print && file.errors.empty() && !program.is_coupler)
    file.errors = problems(file, program, scene_of(command_line, file));
  if (!print && file.errors.empty())
    if (std::string problem = problem_of_restart(command_line, file, program.is_coupler); !problem.empty())
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
  const std::string own = config::effective(section_of(program));
  if (program.is_coupler) {
    section("coupling", own, 1);
  } else {
    fmt::print("participants:\n");
    section(file.participant, own, 2);
  }
  return 0;
}

}  // namespace

namespace {

/// Prints number of cells and size of the mesh. A run reports problems of the mesh.
void print_mesh(const CaseFile& file, const diagnostics::CaseScene& scene, const Program& program) {
  try {
    const mesh::MeshFacts facts = program.mesh(scene.folder);
    const std::span<const double> sides(facts.size.data(), std::size_t(facts.dim));
    const bool is_scaled =
        config::text_of(*file.document, "participants." + file.participant + ".mesh-scale").has_value();
    const std::string hint = diagnostics::hint_on_unit(facts.largest_side(), is_scaled ? 0 : 1);
    fmt::print("mesh:             {} cells, {:.4g} m{}{}\n", facts.cells, fmt::join(sides, " x "),
               hint.empty() ? "" : " ", hint);
  } catch (const Error& error) {
    fmt::print("mesh:             unknown: {}\n", error.what());
  }
}

/// True if the values have a key that switches an effect on: "gravity", "analysis: dynamic", "bed.shells above 1" or one of two.
bool is_on(const config::Document& values, const std::string& key) {
  if (key.empty()) return false;
  if (const std::size_t either = key.find(" or "); either != key.npos)
    return is_on(values, key.substr(0, either)) || is_on(values, key.substr(either + 4));
  const std::size_t word = key.find(": "), number = key.find(" above ");
  const std::string path = key.substr(0, std::min(word, number));
  const auto text = config::text_of(values, path);
  if (word != key.npos) return text == key.substr(word + 2);
  if (number != key.npos) return text && std::stod(*text) > std::stod(key.substr(number + 7));
  return text.has_value() || !config::keys_of(values, path).empty() ||
         !config::texts_of(values, path).empty();
}

/// Prints the effects that change the result of this program where a case leaves them out.
void print_effects(const CaseFile& file, const Program& program) {
  const config::Document values = config::Document::parse(config::effective(section_of(program)));
  std::string on, off;
  for (const diagnostics::FindingId& finding : diagnostics::finding_ids()) {
    const auto& [programs, key, number] = finding.effect;
    if (std::string_view(programs).find(program.name) == std::string_view::npos) continue;
    if (is_on(values, key) || is_on(*file.document, key))
      on += fmt::format("  on   {}: {}\n", finding.id, key);
    else
      off += fmt::format("  off  {}: {}; the run assesses it by: {}\n", finding.id,
                         *key == '\0' ? "not in the model" : fmt::format("'{}'", key), number);
  }
  fmt::print("{}{}", on, off);
}

/// Prints the effects of the scene and the launch line without running anything.
int explain(const CommandLine& command_line, const Program& program) {
  const CaseFile file = read_case(command_line, program);
  if (!file.errors.empty()) {
    for (const std::string& error : file.errors) fmt::print(stderr, "{}\n", error);
    return 2;
  }
  const diagnostics::CaseScene scene = scene_of(command_line, file);
  fmt::print("{} as '{}' of {}:\n", program.name, program.is_coupler ? "coupler" : file.participant,
             command_line.case_file.string());
  for (const diagnostics::EffectChoice& choice : file.choices)
    fmt::print("  {}\n", diagnostics::text(choice));
  print_effects(file, program);
  if (program.mesh) print_mesh(file, scene, program);
  fmt::print("{} {}\n", file.coupled ? "whole case:       couplet run" : "launch:           " + program.name,
             command_line.case_file.string());
  return 0;
}

}  // namespace

int answer(const CommandLine& command_line, const Program& program) {
  using Task = CommandLine::Task;
  SimulationParameters simulation;
  switch (command_line.task) {
    case Task::check:
    case Task::print_config:
      return check(command_line, program, command_line.task == Task::print_config);
    case Task::docs:
      fmt::print("{}", config::markdown(program.name, section_of(program)));
      if (program.is_coupler)
        fmt::print("\n{}",
                   config::markdown("simulation", [&](config::Section& s) { declare(s, simulation); }));
      return 0;
    case Task::schema:
      fmt::print("{}\n", config::json_schema(program.name, section_of(program)));
      return 0;
    case Task::explain:
      return explain(command_line, program);
    case Task::run:
      break;
  }
  return 0;
}

}  // namespace couplet::app
