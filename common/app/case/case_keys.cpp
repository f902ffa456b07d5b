// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/case_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/config/document.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/log/log.hpp"

namespace couplet::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* separator = " = ";

/// Escapes a value so that it fits on one line.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\' || c == '\n') result += '\\';
    result += c == '\n' ? 'n' : c;
  }
  return result;
}

/// Names of files in a value: the value itself, or quoted files of tables in an expression.
std::vector<std::string> names_in(const std::string& value) {
  if (value.find('"') == std::string::npos) return {value};
  std::vector<std::string> names;
  const std::vector<std::string> parts = base::split(value, '"');
  for (std::size_t i = 1; i < parts.size(); i += 2) names.push_back(parts[i]);
  return names;
}

std::map<std::string, std::string> lines_of(const std::string& text) {
  std::map<std::string, std::string> result;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    const std::size_t at = line.find(separator);
    if (at != std::string::npos) result[line.substr(0, at)] = line.substr(at + 3);
  }
  return result;
}

/// Returns true for keys of durations, intervals, locations, studies (variants of a case) and plots.
bool is_harmless(const std::string& path) {
  if (path.starts_with("simulation.") || path.starts_with("study") || path.starts_with("plot")) return true;
  if (!path.starts_with("participants.")) return false;
  const std::vector<std::string> parts = base::split(path, '.');
  static constexpr std::array<std::string_view, 3> sections{"output", "probes", "statistics"};
  return parts.size() > 2 && std::any_of(sections.begin(), sections.end(), [&](std::string_view s) {
           return parts[2] == s || parts[2].starts_with(std::string(s) + "[");
         });
}

}  // namespace

std::string case_keys(const config::Document& document, const fs::path& case_folder) {
  std::string text;
  for (const auto& [path, value] : config::leaves(document)) {
    text += path + separator + escaped(value) + "\n";
    for (const std::string& name : names_in(value)) {
      std::error_code ignored;
      if (name.empty() || name.size() > 1000 || name.find('\0') != std::string::npos) continue;
      const fs::path file = case_folder / name;
      if (fs::is_regular_file(file, ignored))
        text += fmt::format("{}: content of {}{}{:016x}\n", path, escaped(name), separator,
                            io::digest_of_file(file));
    }
  }
  return text;
}

KeyChanges changes_between(const std::string& then, const std::string& now) {
  const auto before = lines_of(then), after = lines_of(now);
  KeyChanges changes;
  const auto note = [&](const std::string& path, const std::string& what) {
    (is_harmless(path) ? changes.harmless : changes.physics).push_back(path + what);
  };
  for (const auto& [path, value] : before) {
    const auto found = after.find(path);
    const bool is_content = path.find(": content of ") != std::string::npos;
    if (found == after.end()) {
      // Another file name is one change, not two.
      if (!is_content) note(path, fmt::format(": was {}, is now absent", value));
    } else if (is_content ? value != found->second : !config::same_value(value, found->second)) {
      note(path, is_content ? " has changed" : fmt::format(": was {}, is {}", value, found->second));
    }
  }
  for (const auto& [path, value] : after)
    if (!before.count(path) && path.find(": content of ") == std::string::npos)
      note(path, fmt::format(": was absent, is now {}", value));
  return changes;
}

std::vector<std::string> check_changes(const fs::path& checkpoint, const std::string& now, bool consent) {
  const fs::path file = checkpoint / "keys.txt";
  if (const std::string problem = io::problem_in_set(file); !problem.empty()) throw Error("{}", problem);
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream then;
  then << stream.rdbuf();
  const KeyChanges changes = changes_between(then.str(), now);
  for (const std::string& change : changes.harmless) log::info("since the checkpoint: {}", change);
  if (!changes.physics.empty() && !consent)
    throw Error(
        "The case differs from the one that {} was written with:\n"
        "  {}\n"
        "If this is intended, start all programs with --restart-with-changes as well.",
        checkpoint.string(), base::join(changes.physics, "\n  "));
  return changes.physics;
}

}  // namespace couplet::app
