// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/gmsh.hpp"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/mesh_cache.hpp"
#include "common/mesh/gmsh/sandbox.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error("Cannot open the file '{}'. Check the path and the permissions.", file.string());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The beginning of gmsh's output, which a script can make as long as it likes.
std::string read_log(const fs::path& file) {
  std::string text(1 << 20, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(text.data(), std::streamsize(text.size()));
  text.resize(std::size_t(in.gcount()));
  return text;
}

/// Up to three different lines of gmsh's output that speak of errors, with the user's names of the files.
std::string complaints(const std::string& output, const GmshInput& input, const fs::path& folder) {
  std::istringstream in(output);
  std::string line, found, last;
  for (int n = 0; n < 3 && std::getline(in, line);) {
    if (!line.starts_with("Error") || line == last || line.find("----") != std::string::npos) continue;
    last = line;
    for (const GmshInput::File& file : input.files) {
      const std::string own = (folder / file.name).string();
      for (std::size_t at = line.find(own); at != std::string::npos; at = line.find(own, at + 1))
        line.replace(at, own.size(), file.original.string());
    }
    found += "\n  " + line;
    ++n;
  }
  return found;
}

void write_files(const GmshInput& input, const fs::path& folder) {
  for (const GmshInput::File& file : input.files) {
    std::ofstream out(folder / file.name, std::ios::binary);
    out << file.text;
    out.close();
    if (!out) throw Error("Cannot write the file '{}'. Check the disk space.", (folder / file.name).string());
  }
}

std::string reason(const ProgramEnd& end) {
  if (end.signal == SIGXCPU) return "the limit of 4 hours of processor time was exceeded";
  if (end.signal == SIGXFSZ) return "a file exceeded 64 GB";
  return end.signal != 0 ? fmt::format("ended by signal {}", end.signal)
                         : fmt::format("exit code {}", end.code);
}

/// A name beside the result for this process alone: several programs of a job may mesh the same file at the same time, each
/// writes its own, the last rename counts.
fs::path own_name(const fs::path& result) {
  std::string host(256, '\0');
  gethostname(host.data(), host.size() - 1);
  return result.parent_path() /
         fmt::format("{}.{}.{}.msh", result.stem().stem().string(), host.c_str(), getpid());
}

void put(const fs::path& mesh, const fs::path& result, const fs::path& source) {
  const fs::path own = own_name(result);
  std::error_code error;
  fs::remove(own, error);           // of a run that was killed, or a link that somebody put there:
  fs::copy_file(mesh, own, error);  // only what is not there is made
  if (error) {
    fs::remove(own, error);
    throw Error(
        "The mesh of '{}' is written next to it, but that folder is not writable. Change the permissions, "
        "or create the .msh elsewhere and use that.",
        source.string());
  }
  base::flush_to_disk(own);
  fs::rename(own, result);
}

}  // namespace

void run_gmsh(const std::vector<std::string>& options, const GmshInput& input, const fs::path& result,
              const std::string& verb) {
  if (access(fs::absolute(result).parent_path().c_str(), W_OK) != 0)
    throw Error(
        "The mesh of '{}' is written next to it, but that folder is not writable. Change the permissions, "
        "or create the .msh elsewhere and use that.",
        input.source.string());
  const OwnFolder folder;
  const fs::path mesh = folder.path() / "mesh.msh", log = folder.path() / "gmsh.log";
  std::vector<std::string> command{"gmsh", "-nopopup", "-format", "msh41", "-v", "2"};
  command.insert(command.end(), options.begin(), options.end());
  write_files(input, folder.path());
  // Absolute: a name that starts with '-' would be an option.
  const bool trusted = input.files.empty();
  const fs::path read = trusted ? fs::absolute(input.source) : folder.path() / input.files.front().name;
  command.insert(command.end(), {"-o", mesh.string(), read.string()});
  const ProgramEnd end = trusted ? run_trusted(command, log) : run_in_sandbox(command, folder.path(), log);
  const std::string errors = complaints(read_log(log), input, folder.path());
  if (end.code != 0 || !errors.empty() || !fs::is_regular_file(fs::symlink_status(mesh)))
    throw Error("gmsh could not {} '{}' ({}).{}", verb, input.source.string(), reason(end), errors);
  seal_cache(mesh, result.filename().string());
  put(mesh, result, input.source);
}

// What gmsh does not know it would take for a script.
bool gmsh_has(const std::string& library) {
  const OwnFolder folder;
  try {
    run_in_sandbox({"gmsh", "-info"}, folder.path(), folder.path() / "info.log");
  } catch (const Error&) {
    return false;  // not installed
  }
  std::istringstream words(read_log(folder.path() / "info.log"));
  for (std::string word; words >> word;)
    if (word == library || word.starts_with(library + "[")) return true;
  return false;
}

fs::path convert_mesh(const fs::path& file) {
  const std::string kind = file.extension().string();
  const std::string library = kind == ".med" ? "Med" : kind == ".cgns" ? "Cgns" : "";
  if (!library.empty() && !gmsh_has(library))
    throw Error(
        "Cannot read the mesh '{}': the gmsh on the PATH was built without {}. Convert it elsewhere, for "
        "example with meshio, to .msh 4.1 with its groups as physical names.",
        file.string(), kind == ".med" ? "MED" : "CGNS");
  const std::string text = read_text(file);
  const std::string hash = fmt::format("{:016x}", base::stable_hash(text));
  const fs::path result = file.parent_path() / (file.stem().string() + "." + hash + ".cache.msh");
  if (is_sound_cache(result)) return result;
  log::info("reading {} with gmsh", file.string());
  run_gmsh({"-0"}, {file, {{file, "0" + kind, text}}}, result, "read");
  return result;
}

}  // namespace couplet::mesh
