// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/sandbox.hpp"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
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

// A signal that is to end this process while it waits for a program. It is raised again once the folder of the
// program is gone.
volatile std::sig_atomic_t stop_signal = 0, waited_for = 0;
constexpr std::array stop_signals{SIGTERM, SIGINT, SIGHUP};

extern "C" void end_program(int signal) {
  stop_signal = signal;
  if (waited_for > 0) kill(waited_for, SIGKILL);
}

/// Handles signals that would end this process by ending the program instead. Ignored signals stay ignored.
class StopHandler {
 public:
  StopHandler() {
    struct sigaction action {};
    action.sa_handler = end_program;
    for (std::size_t i = 0; i < stop_signals.size(); ++i) {
      sigaction(stop_signals[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) sigaction(stop_signals[i], &action, nullptr);
    }
  }
  ~StopHandler() {
    waited_for = 0;
    for (std::size_t i = 0; i < stop_signals.size(); ++i) sigaction(stop_signals[i], &before_[i], nullptr);
  }
  StopHandler(const StopHandler&) = delete;

 private:
  std::array<struct sigaction, stop_signals.size()> before_{};
};

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
  const StopHandler handler;
  const pid_t id = fork();
  if (id == 0) be_child(p);
  const int fork_error = errno;
  close(pipe[1]);
  int error = 0;
  const bool failed = id > 0 && read(pipe[0], &error, sizeof error) == sizeof error;
  close(pipe[0]);
  if (id < 0) throw Error("Cannot start the program '{}': {}.", p.command[0], std::strerror(fork_error));
  waited_for = id;
  if (stop_signal != 0) kill(id, SIGKILL);
  int status = 0;
  while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  if (stop_signal != 0) throw Error("Stopped by a signal while '{}' was running.", p.command[0]);
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
  if (stop_signal == 0) return;
  const int signal = stop_signal;
  stop_signal = 0;
  raise(signal);
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

namespace {

// Rights of the first version of Landlock (Linux 5.13), which all later versions support.
constexpr std::uint64_t reading =
    LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
constexpr std::uint64_t everything = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;
constexpr std::uint64_t of_a_file =
    LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE;

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;  // no barrier
#endif

int create_rules(const landlock_ruleset_attr* attributes, std::size_t size, std::uint32_t flags) {
  return static_cast<int>(syscall(SYS_landlock_create_ruleset, attributes, size, flags));
}

bool allow(int rules, const fs::path& path, std::uint64_t rights) {
  const int fd = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (fd < 0) return true;  // does not exist
  std::error_code ignored;
  landlock_path_beneath_attr below{};
  below.allowed_access = fs::is_directory(path, ignored) ? rights : rights & of_a_file;
  below.parent_fd = fd;
  const bool done = syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &below, 0) == 0;
  close(fd);
  return done;
}

// System calls with external effects that Landlock's first version does not restrict. A new process would be
// harmless by itself, but not its actions.
constexpr long refused_calls[] = {SYS_fchmod,
                                  SYS_fchmodat,
                                  SYS_fchown,
                                  SYS_fchownat,
                                  SYS_utimensat,
                                  SYS_truncate,
                                  SYS_setxattr,
                                  SYS_lsetxattr,
                                  SYS_fsetxattr,
                                  SYS_removexattr,
                                  SYS_lremovexattr,
                                  SYS_fremovexattr,
                                  SYS_socket,
                                  SYS_socketpair,
                                  SYS_kill,
                                  SYS_tkill,
                                  SYS_tgkill,
                                  SYS_rt_sigqueueinfo,
                                  SYS_rt_tgsigqueueinfo,
                                  SYS_ptrace,
                                  SYS_process_vm_readv,
                                  SYS_process_vm_writev,
                                  SYS_pidfd_open,
                                  SYS_pidfd_send_signal,
                                  SYS_pidfd_getfd,
                                  SYS_io_uring_setup,
                                  SYS_bpf,
                                  SYS_perf_event_open,
                                  SYS_userfaultfd,
                                  SYS_keyctl,
                                  SYS_add_key,
                                  SYS_request_key,
                                  SYS_shmget,
                                  SYS_shmctl,
                                  SYS_semget,
                                  SYS_semctl,
                                  SYS_msgget,
                                  SYS_msgctl,
                                  SYS_mq_open,
                                  SYS_mq_unlink,
                                  SYS_setpriority,
                                  SYS_sched_setaffinity,
                                  SYS_unshare,
                                  SYS_setns,
                                  SYS_mount};
#if defined(__x86_64__)
constexpr long older_calls[] = {SYS_fork,   SYS_vfork, SYS_chmod,  SYS_chown,
                                SYS_lchown, SYS_utime, SYS_utimes, SYS_futimesat};
#else
constexpr std::array<long, 0> older_calls{};
#endif

constexpr std::uint32_t refusal(int error) { return SECCOMP_RET_ERRNO | std::uint32_t(error); }

std::vector<sock_filter> filter() {
  constexpr std::uint32_t number = offsetof(seccomp_data, nr), arch = offsetof(seccomp_data, arch),
                          first_argument = offsetof(seccomp_data, args);
  const auto load = [](std::uint32_t at) { return sock_filter(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, at)); };
  const auto end = [](std::uint32_t what) { return sock_filter(BPF_STMT(BPF_RET | BPF_K, what)); };
  const auto equals = [](std::uint32_t value, std::uint8_t skip_otherwise) {
    return sock_filter(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, skip_otherwise));
  };
  std::vector<sock_filter> f{load(arch), equals(architecture, 1),
                             sock_filter(BPF_JUMP(BPF_JMP | BPF_JA, 1, 0, 0)), end(SECCOMP_RET_KILL_PROCESS),
                             load(number)};
  // Newer calls than these lists, and calls of another range on some kernels, fail as on an older kernel.
  f.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, SYS_landlock_restrict_self + 1, 0, 1));
  f.push_back(end(refusal(ENOSYS)));
  const auto refuse = [&](const auto& calls) {
    for (const long call : calls) {
      f.push_back(equals(std::uint32_t(call), 1));
      f.push_back(end(refusal(EPERM)));
    }
  };
  refuse(refused_calls);
  refuse(older_calls);
  f.push_back(equals(SYS_clone3, 1));  // its flags are not visible here; the C library falls back to clone()
  f.push_back(end(refusal(ENOSYS)));
  f.push_back(equals(SYS_prlimit64, 4));  // only its own limits
  f.push_back(load(first_argument));
  f.push_back(equals(0, 1));
  f.push_back(end(SECCOMP_RET_ALLOW));
  f.push_back(end(refusal(EPERM)));
  f.push_back(equals(SYS_clone, 3));
  f.push_back(load(first_argument));
  f.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0));
  f.push_back(end(refusal(EPERM)));
  f.push_back(end(SECCOMP_RET_ALLOW));
  return f;
}

}  // namespace

bool Barrier::is_possible() {
  return architecture != 0 && create_rules(nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) >= 1;
}

Barrier::Barrier(const std::vector<fs::path>& readable, const fs::path& writable) : filter_(filter()) {
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = everything;
  rules_ = create_rules(&handled, sizeof handled, 0);
  bool done = rules_ >= 0 &&
              allow(rules_, writable, everything & ~std::uint64_t(LANDLOCK_ACCESS_FS_EXECUTE)) &&
              allow(rules_, "/dev/null", LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_WRITE_FILE);
  for (const fs::path& path : readable) done = done && allow(rules_, path, reading);
  if (!done) throw Error("Cannot confine a program by Landlock: {}.", std::strerror(errno));
}

Barrier::~Barrier() {
  if (rules_ >= 0) close(rules_);
}

bool Barrier::put_up() const {
  const sock_fprog program{static_cast<unsigned short>(filter_.size()),
                           const_cast<sock_filter*>(filter_.data())};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && syscall(SYS_landlock_restrict_self, rules_, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

}  // namespace couplet::mesh
