// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/sandbox.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"

namespace couplet::mesh {
namespace {

struct ChildProcess {
  std::vector<std::string> command;      ///< program with its full path
  std::vector<std::string> environment;  ///< "NAME=value"
  std::filesystem::path folder;          ///< working directory; unchanged if empty
  std::filesystem::path output;
  const Barrier* barrier = nullptr;  ///< around the program, or nullptr

  // Prepared before the fork, because only system calls are safe between fork and exec.
  std::vector<char*> arguments{}, variables{};
  rlim_t memory = 0;
  pid_t parent = 0;
  int failures = -1;  ///< a pipe that exec closes
};

constexpr rlim_t hours = 3600;

std::vector<char*> pointers(const std::vector<std::string>& words) {
  std::vector<char*> result;
  for (const std::string& word : words) result.push_back(const_cast<char*>(word.c_str()));
  result.push_back(nullptr);
  return result;
}

void limit(__rlimit_resource_t what, rlim_t most) {
  rlimit now{};
  if (getrlimit(what, &now) != 0) return;
  now.rlim_cur = std::min(now.rlim_cur, most);
  now.rlim_max = std::min(now.rlim_max, most);
  setrlimit(what, &now);
}

/// Sends errno of a failed step to the parent.
[[noreturn]] void fail(int pipe) {
  const int error = errno;
  [[maybe_unused]] const auto n = write(pipe, &error, sizeof error);
  _exit(127);
}

[[noreturn]] void be_child(const ChildProcess& p) {
  // The death signal depends on the thread that forked. It waits for the child and therefore exists as long.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != p.parent) _exit(127);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, 4 * hours);
  limit(RLIMIT_FSIZE, rlim_t(64) << 30);
  limit(RLIMIT_AS, p.memory);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int signal : {SIGPIPE, SIGTERM, SIGINT, SIGHUP}) ::signal(signal, SIG_DFL);
  const int in = open("/dev/null", O_RDONLY),
            out = open(p.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, 0600);
  if (in < 0 || out < 0 || dup2(in, STDIN_FILENO) < 0 || dup2(out, STDOUT_FILENO) < 0 ||
      dup2(out, STDERR_FILENO) < 0)
    fail(p.failures);
  if (!p.folder.empty() && chdir(p.folder.c_str()) != 0) fail(p.failures);
  if (p.barrier != nullptr && !p.barrier->put_up()) fail(p.failures);
  // Closes files and sockets of this program. The pipe closes itself.
  for (int fd = 3; fd < 4096; ++fd)
    if (fd != p.failures) close(fd);
  execve(p.arguments[0], p.arguments.data(), p.variables.data());
  fail(p.failures);
}

/// Starts a program and waits. It receives SIGKILL when the calling thread ends, so that no process remains
/// if the program is killed. Throws Error if it cannot be started.
ProgramEnd run_child(ChildProcess p) {
  p.arguments = pointers(p.command);
  p.variables = pointers(p.environment);
  p.memory = rlim_t(sysconf(_SC_PHYS_PAGES)) * rlim_t(sysconf(_SC_PAGESIZE));
  p.parent = getpid();
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) throw Error("Cannot create a pipe: {}.", std::strerror(errno));
  p.failures = pipe[1];
  const pid_t id = fork();
  if (id == 0) be_child(p);
  const int fork_error = errno;
  close(pipe[1]);
  int error = 0;
  const bool failed = id > 0 && read(pipe[0], &error, sizeof error) == sizeof error;
  close(pipe[0]);
  if (id < 0) throw Error("Cannot start the program '{}': {}.", p.command[0], std::strerror(fork_error));
  int status = 0;
  while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  if (failed) throw Error("Cannot start the program '{}': {}.", p.command[0], std::strerror(error));
  if (WIFEXITED(status)) return {WEXITSTATUS(status), 0};
  return {-1, WIFSIGNALED(status) ? WTERMSIG(status) : 0};
}

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// File that a shell would start, or nothing if it is not on PATH.
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

/// Environment without the variables by which an MPI program finds its job, so that a gmsh built with MPI
/// does not join this one.
Words environment_without_mpi() {
  Words kept;
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (!begins_with_any(*entry, {"OMPI_", "PMIX_", "PMI_", "PRTE_", "HYDRA_", "SLURM_"}))
      kept.emplace_back(*entry);
  return kept;
}

/// Variables needed to start a program. A separate home avoids that .gmshrc or .gmsh-options is read.
Words clean_environment(const fs::path& folder) {
  Words kept{"HOME=" + folder.string(), "TMPDIR=" + folder.string(), "OMP_NUM_THREADS=1"};
  for (char** entry = environ; *entry != nullptr; ++entry)
    if (begins_with_any(*entry, {"PATH=", "LD_LIBRARY_PATH=", "LANG=", "LC_",
                                 "PYTHONPATH=", "CONDA_PREFIX=", "VIRTUAL_ENV="}))
      kept.emplace_back(*entry);
  // A gmsh installed by pip for this user has its library below the home folder.
  if (const char* home = std::getenv("HOME"); home != nullptr && std::getenv("PYTHONUSERBASE") == nullptr)
    kept.push_back(fmt::format("PYTHONUSERBASE={}/.local", home));
  return kept;
}

/// Files needed to start a program: system libraries, and those beside a program or environment installed
/// elsewhere. No other user files are readable.
std::vector<fs::path> of_the_system(const fs::path& program) {
  std::vector<fs::path> paths{"/usr",
                              "/lib",
                              "/lib64",
                              "/bin",
                              "/sbin",
                              "/opt",
                              "/proc",
                              "/sys/devices/system",
                              "/dev/urandom",
                              "/etc/python3",
                              "/etc/ld.so.cache",
                              "/etc/localtime"};
  std::error_code ignored;
  for (const fs::path& file : {program, fs::canonical(program, ignored)})
    for (const fs::path& part : {file, file.parent_path().parent_path() / "lib"}) paths.push_back(part);
  // A Python script names the interpreter beside it.
  if (const fs::path python = fs::canonical(program.parent_path() / "python3", ignored); !python.empty())
    for (const fs::path& part : {python, python.parent_path().parent_path() / "lib"}) paths.push_back(part);
  for (const char* folder : {"CONDA_PREFIX", "VIRTUAL_ENV", "PYTHONUSERBASE"})
    if (const char* path = std::getenv(folder)) paths.emplace_back(path);
  for (const char* list : {"PYTHONPATH", "LD_LIBRARY_PATH"})
    if (const char* folders = std::getenv(list))
      for (const std::string& path : base::split(folders, ':'))
        if (!path.empty()) paths.emplace_back(path);
  if (const char* home = std::getenv("HOME")) paths.push_back(fs::path(home) / ".local/lib");
  return paths;
}

/// Finds the program behind a pyenv shim, which starts other processes and therefore fails in the sandbox.
std::string behind_shim(const std::string& program, const fs::path& folder) {
  const fs::path file = program, answer = folder / "shim.log";
  if (file.parent_path().filename() != "shims") return program;
  if (run_trusted({"pyenv", "which", file.filename().string()}, answer).code != 0) return program;
  std::string found;
  std::getline(std::ifstream(answer), found);
  return found;
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

ProgramEnd run_in_sandbox(const Words& command, const fs::path& folder, const fs::path& output,
                          std::vector<fs::path> readable) {
  ChildProcess child{command, clean_environment(folder), folder, output};
  child.command[0] = behind_shim(program_of(command), folder);
  if (!Barrier::is_possible()) {
    log::info("{} runs without a sandbox, with resource limits only: this kernel has no Landlock.",
              command[0]);
    return run_child(child);
  }
  for (const fs::path& path : of_the_system(child.command[0])) readable.push_back(path);
  const Barrier barrier(readable, folder);
  child.barrier = &barrier;
  return run_child(child);
}

ProgramEnd run_trusted(const Words& command, const fs::path& output) {
  ChildProcess child{command, environment_without_mpi(), {}, output};
  child.command[0] = program_of(command);
  return run_child(child);
}

}  // namespace couplet::mesh
