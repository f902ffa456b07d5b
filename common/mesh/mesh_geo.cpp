// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/geo_script.hpp"
#include "common/mesh/load.hpp"

namespace couplet {
namespace {

/// Output and script of gmsh, whole.
std::string read_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw Error("The geometry file '{}' cannot be opened. Check the path and the permissions.",
                file.string());
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
        "A .geo is meshed by the program '{}', which is not on the PATH. Install it (Debian: apt install "
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

void check_names(const std::filesystem::path& geo, const std::vector<std::string>& known,
                 const MeshParameters& parameters) {
  for (const auto& [name, value] : parameters) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (known.empty())
      throw Error(
          "The geometry file '{}' defines no parameter, so 'mesh-parameters' cannot set '{}'. Write the "
          "names "
          "that are to be set from outside as 'DefineConstant [ {} = {} ];'.",
          geo.string(), name, name, value);
    throw Error("The geometry file '{}' defines no parameter '{}' by DefineConstant. {}", geo.string(), name,
                did_you_mean(name, known, "names"));
  }
}

}  // namespace

std::filesystem::path mesh_geo(const std::filesystem::path& geo, int dim, const MeshParameters& parameters) {
  const GeoScript script = read_geo(geo);
  if (!script.danger.empty() && std::getenv("COUPLET_ALLOW_COMMANDS") == nullptr)
    throw Error(
        "The geometry has {}: gmsh would run commands or write files with your rights. If you trust the case, start with "
        "--allow-commands.",
        script.danger);
  check_names(geo, script.constants, parameters);
  std::vector<std::string> numbers;
  for (const auto& [name, value] : parameters)
    numbers.insert(numbers.end(), {"-setnumber", name, fmt::format("{}", value)});
  const std::string hash =
      fmt::format("{:016x}", stable_hash(fmt::format("{}\n{}\n{}", dim, join(numbers, " "), script.text)));
  const std::string stem = geo.stem().string() + "." + hash;
  const std::filesystem::path result = geo.parent_path() / (stem + ".cache.msh");
  if (std::filesystem::is_regular_file(result)) return result;

  // Several programs of a job may mesh the same file at the same time: each writes its own, the last rename
  // counts.
  std::string host(256, '\0');
  gethostname(host.data(), host.size() - 1);
  const std::string own = fmt::format("{}.{}.{}", stem, host.c_str(), getpid());
  const std::filesystem::path mesh = geo.parent_path() / (own + ".msh"),
                              log = geo.parent_path() / (own + ".log");
  if (!std::ofstream(log))
    throw Error(
        "The mesh of '{}' is to be written beside it, but the folder cannot be written to. Change the "
        "permissions, or mesh it elsewhere and give the .msh.",
        geo.string());
  log::info("meshing {} with gmsh", geo.string());
  int code = 0;
  try {
    std::vector<std::string> command{"gmsh", fmt::format("-{}", dim), "-format", "msh41", "-v", "2"};
    command.insert(command.end(), numbers.begin(), numbers.end());
    // Absolute: a name that starts with '-' would be an option.
    command.insert(command.end(), {"-o", absolute(mesh).string(), absolute(geo).string()});
    code = run(command, log);
  } catch (...) {
    std::filesystem::remove(log);
    throw;
  }
  const std::string errors = complaints(read_text(log));
  std::filesystem::remove(log);
  if (code != 0 || !errors.empty() || !std::filesystem::is_regular_file(mesh)) {
    std::filesystem::remove(mesh);
    throw Error("gmsh could not mesh '{}' (exit code {}).{}", geo.string(), code, errors);
  }
  flush_to_disk(mesh);
  std::filesystem::rename(mesh, result);
  return result;
}

}  // namespace couplet
