// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/sandbox.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/child_process.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// The file that a shell would start; nothing if there is none on the PATH.
std::optional<std::string> on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : base::split(path != nullptr ? path : "/usr/bin:/bin", ':')) {
    const fs::path file = fs::path(folder.empty() ? "." : folder) / program;
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0)
      return fs::absolute(file).string();
  }
  return std::nullopt;
}

std::string program_of(const Words& command) {
  if (const auto file = on_path(command[0])) return *file;
  throw Error(
      "Meshes other than .msh are read with the program '{}', which is not on the PATH. Install it (Debian: "
      "apt install {}) or give a .msh file.",
      command[0], command[0]);
}

bool begins_with_any(std::string_view entry, std::initializer_list<std::string_view> prefixes) {
  for (const std::string_view prefix : prefixes)
    if (entry.starts_with(prefix)) return true;
  return false;
}

/// All but the variables by which an MPI program finds its job: a gmsh that was built with MPI must not take itself for a
/// rank of this one.
Words environment_without_mpi() {
  Words kept;
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (!begins_with_any(*entry, {"OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDRA_", "SLURM_"}))
      kept.emplace_back(*entry);
  return kept;
}

/// What a program needs to be found and to start, and a home of its own: no .gmshrc, no .gmsh-options is read.
Words clean_environment(const fs::path& folder) {
  Words kept{"HOME=" + folder.string(), "TMPDIR=" + folder.string(), "OMP_NUM_THREADS=1"};
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (begins_with_any(*entry, {"PATH=", "LD_LIBRARY_PATH=", "LANG=", "LC_",
                                 "PYTHONPATH=", "CONDA_PREFIX=", "VIRTUAL_ENV="}))
      kept.emplace_back(*entry);
  // A gmsh that pip installed for this user looks for its library under the home.
  if (const char* home = std::getenv("HOME"); home != nullptr && std::getenv("PYTHONUSERBASE") == nullptr)
    kept.push_back(fmt::format("PYTHONUSERBASE={}/.local", home));
  return kept;
}

struct Bubblewrap {
  std::string program;
  bool proc = true;  // with a /proc of its own, which some containers forbid
};

/// The command line up to the program: all of the disk to read, one folder to write, no network, an end with its parent.
Words command_of(const Bubblewrap& b, const fs::path& folder) {
  Words words{b.program,
              "--die-with-parent",
              "--new-session",
              "--unshare-user",
              "--unshare-ipc",
              "--unshare-pid",
              "--unshare-net",
              "--unshare-uts",
              "--ro-bind",
              "/",
              "/",
              "--dev",
              "/dev"};
  if (b.proc) words.insert(words.end(), {"--proc", "/proc"});
  words.insert(words.end(), {"--bind", folder.string(), folder.string(), "--chdir", folder.string()});
  return words;
}

bool is_setuid(const std::string& file) {
  struct stat status {};
  return stat(file.c_str(), &status) == 0 && (status.st_mode & S_ISUID) != 0;
}

/// How bubblewrap starts here; nothing if it is not installed or does not start (namespaces of users may be forbidden).
std::optional<Bubblewrap> find_bubblewrap(const fs::path& folder) {
  const auto bwrap = on_path("bwrap"), probe = on_path("true");
  if (!bwrap || !probe) {
    log::info(
        "gmsh runs without a sandbox, with resource limits only: bubblewrap (bwrap) is not installed "
        "(Debian: apt install bubblewrap).");
    return std::nullopt;
  }
  for (const bool proc : {true, false}) {
    const Bubblewrap found{*bwrap, proc};
    ChildProcess child{command_of(found, folder), clean_environment(folder), folder,
                       folder / "probe.log",      !is_setuid(*bwrap),        false};
    child.command.push_back(*probe);
    if (run_child(child).code == 0) return found;
  }
  log::info(
      "gmsh runs without a sandbox, with resource limits only: bubblewrap cannot start here (user "
      "namespaces?).");
  return std::nullopt;
}

}  // namespace

OwnFolder::OwnFolder() {
  std::string name = (fs::temp_directory_path() / "couplet-gmsh-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error("Cannot create a folder for gmsh in '{}': {}. Set TMPDIR to a writable folder.",
                fs::temp_directory_path().string(), std::strerror(errno));
  path_ = fs::canonical(name);
}

OwnFolder::~OwnFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

ProgramEnd run_in_sandbox(const Words& command, const fs::path& folder, const fs::path& output) {
  ChildProcess child{command, clean_environment(folder), folder, output, true, true};
  child.command[0] = program_of(command);
  // Tried, and said, once in a process; tests change the PATH.
  static std::map<std::string, std::optional<Bubblewrap>> tried;
  const char* path = std::getenv("PATH");
  const auto [known, is_new] = tried.try_emplace(path != nullptr ? path : "");
  if (is_new) known->second = find_bubblewrap(folder);
  if (const auto& bubblewrap = known->second) {
    const Words words = command_of(*bubblewrap, folder);
    child.no_new_privileges = !is_setuid(bubblewrap->program);
    child.no_processes = false;  // bubblewrap itself is one
    child.command.insert(child.command.begin(), words.begin(), words.end());
  }
  return run_child(child);
}

ProgramEnd run_trusted(const Words& command, const fs::path& output) {
  ChildProcess child{command, environment_without_mpi(), {}, output, false, false};
  child.command[0] = program_of(command);
  return run_child(child);
}

}  // namespace couplet::mesh
