// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/base/error.hpp"

namespace couplet::mesh {
namespace {

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

/// What a child needs, made before the fork: between fork and exec only calls to the kernel are sound.
struct Prepared {
  std::vector<char*> arguments, environment;
  std::string folder, output;
  rlim_t memory = 0;
  bool no_new_privileges = true, no_processes = false;
  pid_t parent = 0;
  int failures = -1;  // a pipe that exec closes
};

/// The step that failed goes to the parent as errno.
[[noreturn]] void fail(int pipe) {
  const int error = errno;
  [[maybe_unused]] const auto n = write(pipe, &error, sizeof error);
  _exit(127);
}

[[noreturn]] void be_child(const Prepared& p) {
  // Of the thread that forked, not of the process: it waits, and so it is there as long as the child.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != p.parent) _exit(127);
  if (p.no_new_privileges) prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, 4 * hours);
  limit(RLIMIT_FSIZE, rlim_t(64) << 30);
  limit(RLIMIT_AS, p.memory);
  if (p.no_processes) limit(RLIMIT_NPROC, 0);
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
  // Neither files nor sockets of this program. The pipe closes itself.
  for (int fd = 3; fd < 4096; ++fd)
    if (fd != p.failures) close(fd);
  execve(p.arguments[0], p.arguments.data(), p.environment.data());
  fail(p.failures);
}

}  // namespace

ProgramEnd run_child(const ChildProcess& child) {
  Prepared p;
  p.arguments = pointers(child.command);
  p.environment = pointers(child.environment);
  p.folder = child.folder.string();
  p.output = child.output.string();
  p.no_new_privileges = child.no_new_privileges;
  p.no_processes = child.no_processes;
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
  if (id < 0) throw Error("Cannot start the program '{}': {}.", child.command[0], std::strerror(fork_error));
  int status = 0;
  while (waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  if (failed) throw Error("Cannot start the program '{}': {}.", child.command[0], std::strerror(error));
  if (WIFEXITED(status)) return {WEXITSTATUS(status), 0};
  return {-1, WIFSIGNALED(status) ? WTERMSIG(status) : 0};
}

}  // namespace couplet::mesh
