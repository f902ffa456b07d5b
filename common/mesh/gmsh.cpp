// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"

namespace couplet {
namespace {

/// Output and script of gmsh, whole.
std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error("The file '{}' cannot be opened. Check the path and the permissions.", file.string());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The environment without the variables by which an MPI program finds its job: a gmsh that was built with
/// MPI must not take itself for a rank of this one.
std::vector<char*> environment_without_mpi() {
  std::vector<char*> kept;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text(*entry);
    bool mpi = false;
    for (const char* prefix : {"OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDRA_", "SLURM_"})
      mpi = mpi || text.starts_with(prefix);
    if (!mpi) kept.push_back(*entry);
  }
  kept.push_back(nullptr);
  return kept;
}

/// Runs a program found on PATH with its output in a file; gives the exit code, -1 if it was killed.
int run(const std::vector<std::string>& command, const std::filesystem::path& output) {
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const std::vector<char*> environment = environment_without_mpi();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int error =
      posix_spawnp(&child, command[0].c_str(), &actions, nullptr, arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT)
    throw Error(
        "A mesh that is no .msh is read by the program '{}', which is not on the PATH. Install it (Debian: apt install "
        "gmsh) or give a .msh file instead.",
        command[0]);
  if (error != 0) throw Error("The program '{}' cannot be started: {}.", command[0], std::strerror(error));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Up to three different lines of gmsh's output that speak of errors.
std::string complaints(const std::string& output) {
  std::istringstream in(output);
  std::string line, found, last;
  for (int n = 0; n < 3 && std::getline(in, line);) {
    if (!line.starts_with("Error") || line == last || line.find("----") != std::string::npos) continue;
    found += "\n  " + line;
    last = line;
    ++n;
  }
  return found;
}

/// Whether the gmsh at hand was built with a library, "Med" or "Cgns": what it does not know it would take for a script.
bool gmsh_has(const std::string& library, const std::filesystem::path& beside) {
  const std::filesystem::path output =
      beside.parent_path() / fmt::format("{}.{}.info.log", beside.stem().string(), getpid());
  run({"gmsh", "-info"}, output);
  const std::string text = read_text(output);
  std::filesystem::remove(output);
  std::istringstream words(text);
  for (std::string word; words >> word;)
    if (word == library || word.starts_with(library + "[")) return true;
  return false;
}

}  // namespace

void run_gmsh(const std::vector<std::string>& options, const std::filesystem::path& source,
              const std::filesystem::path& result, const std::string& verb) {
  // Several programs of a job may mesh the same file at the same time: each writes its own, the last rename
  // counts.
  std::string host(256, '\0');
  gethostname(host.data(), host.size() - 1);
  const std::string own = fmt::format("{}.{}.{}", result.stem().stem().string(), host.c_str(), getpid());
  const std::filesystem::path mesh = source.parent_path() / (own + ".msh"),
                              log = source.parent_path() / (own + ".log");
  if (!std::ofstream(log))
    throw Error(
        "The mesh of '{}' is to be written beside it, but the folder cannot be written to. Change the "
        "permissions, or make the .msh elsewhere and give that.",
        source.string());
  int code = 0;
  try {
    std::vector<std::string> command{"gmsh", "-format", "msh41", "-v", "2"};
    command.insert(command.end(), options.begin(), options.end());
    // Absolute: a name that starts with '-' would be an option.
    command.insert(command.end(), {"-o", absolute(mesh).string(), absolute(source).string()});
    code = run(command, log);
  } catch (...) {
    std::filesystem::remove(log);
    throw;
  }
  const std::string errors = complaints(read_text(log));
  std::filesystem::remove(log);
  if (code != 0 || !errors.empty() || !std::filesystem::is_regular_file(mesh)) {
    std::filesystem::remove(mesh);
    throw Error("gmsh could not {} '{}' (exit code {}).{}", verb, source.string(), code, errors);
  }
  flush_to_disk(mesh);
  std::filesystem::rename(mesh, result);
}

std::filesystem::path convert_mesh(const std::filesystem::path& file) {
  const std::string kind = file.extension().string();
  const std::string library = kind == ".med" ? "Med" : kind == ".cgns" ? "Cgns" : "";
  if (!library.empty() && !gmsh_has(library, file))
    throw Error(
        "The mesh '{}' cannot be read: the gmsh on the PATH was built without {}. Convert it elsewhere, for example by "
        "meshio, to .msh 4.1 with its groups as physical names.",
        file.string(), kind == ".med" ? "MED" : "CGNS");
  const std::string hash = fmt::format("{:016x}", stable_hash(read_text(file)));
  const std::filesystem::path result =
      file.parent_path() / (file.stem().string() + "." + hash + ".cache.msh");
  if (std::filesystem::is_regular_file(result)) return result;
  log::info("reading {} with gmsh", file.string());
  run_gmsh({"-0"}, file, result, "read");
  return result;
}

}  // namespace couplet
