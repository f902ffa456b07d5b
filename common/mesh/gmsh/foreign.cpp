// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/gmsh.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/sandbox.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;

constexpr int no_module = 3;  // exit code of the script
constexpr std::size_t most_complaints = 3;

// Reads a mesh of another program and writes it as an input deck.
constexpr const char* script =
#include "to_deck.inc"
    ;

bool is_note(const std::string& line) { return line.starts_with("info: ") || line.starts_with("warning: "); }

/// Last lines printed by Python, which contain its error.
std::string complaint(std::vector<std::string> lines) {
  std::string text;
  std::erase_if(lines, is_note);
  if (lines.size() > most_complaints) lines.erase(lines.begin(), lines.end() - most_complaints);
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n  ") + line;
  return text;
}

}  // namespace

bool is_foreign(const std::string& extension) {
  constexpr std::string_view all[] = {".unv", ".med", ".exo", ".e", ".ex2", ".g", ".gen"};
  return std::ranges::find(all, extension) != std::end(all);
}

RawMesh read_foreign(const fs::path& file) {
  const OwnFolder folder;
  const fs::path deck = folder.path() / "mesh.inp", log = folder.path() / "python.log";
  log::info("reading {} with Python", file.string());
  const auto run = [&](const std::string& python) {
    return run_in_sandbox({python, "-c", script, fs::absolute(file).string(), deck.string()}, folder.path(),
                          log, {fs::canonical(file)});
  };
  ProgramEnd end = run("python3");
  // A python3 of the user's own may lack what that of the system has.
  const char* system_python = "/usr/bin/python3";
  if (end.code == no_module && fs::exists(system_python)) end = run(system_python);
  const std::vector<std::string> lines = csv::read_lines(log, "output of python3", {.text_only = false});
  if (end.code == no_module)
    throw Error(
        "The mesh '{}' is read with the Python module h5py, which python3 on the PATH lacks. Install it "
        "(Debian: apt install python3-h5py), or convert the mesh elsewhere to .msh 4.1 with its groups as "
        "physical names.",
        file.string());
  if (end.code != 0 || !fs::is_regular_file(fs::symlink_status(deck)))
    throw Error(
        "Cannot read the mesh '{}': {}.", file.string(),
        end.signal != 0 ? fmt::format("python3 was ended by signal {}", end.signal) : complaint(lines));
  for (const std::string& line : lines)
    if (is_note(line))
      line.starts_with("warning") ? log::warn("'{}': {}.", file.string(), line.substr(line.find(' ') + 1))
                                  : log::info("'{}': {}.", file.string(), line.substr(line.find(' ') + 1));
  return read_inp(deck);
}

}  // namespace couplet::mesh
