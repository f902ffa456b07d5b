// SPDX-License-Identifier: Apache-2.0
#include "common/io/rehearse.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "common/base/error.hpp"
#include "common/log/log.hpp"

namespace couplet::io {
namespace {

// First byte that comes through the pipe; nothing comes of a crash.
enum Outcome : char { sound = 's', refused = 'r', out_of_memory = 'm' };
constexpr std::size_t longest_message = 3000;  // fits into the pipe: writing it never waits

std::uint64_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * std::uint64_t(::sysconf(_SC_PAGESIZE));
}

void limit(int resource, std::uint64_t most) {
  rlimit now{};
  ::getrlimit(static_cast<__rlimit_resource>(resource), &now);
  now.rlim_cur = std::min<rlim_t>(now.rlim_max, most);
  ::setrlimit(static_cast<__rlimit_resource>(resource), &now);
}

/// Nothing of the process that forked acts here any more: its handlers, its terminal, its files to write to.
void confine(std::uint64_t bytes, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, SIG_DFL);
  std::signal(SIGXFSZ, SIG_IGN);  // what would be written to a log is lost
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (const int standard : {0, 1, 2}) ::dup2(nowhere, standard);
  const std::uint64_t megabytes = bytes >> 20;
  limit(RLIMIT_AS, address_space() + (std::uint64_t(512) << 20) + 4 * bytes);
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  limit(RLIMIT_CPU, std::uint64_t(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + 2 + megabytes / 25);
  ::alarm(unsigned(60 + megabytes));  // should it wait for something that no thread of a fork will ever give
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CORE, 0);
}

[[noreturn]] void read_here(const std::function<void()>& read, int pipe) {
  std::string outcome(1, sound);
  try {
    read();
  } catch (const std::bad_alloc&) {
    outcome[0] = out_of_memory;
  } catch (const std::exception& error) {
    outcome = std::string(1, refused) + std::string(error.what()).substr(0, longest_message);
  }
  const ssize_t written = ::write(pipe, outcome.data(), outcome.size());
  ::_exit(written == ssize_t(outcome.size()) ? 0 : 1);
}

std::string all_of(int pipe) {
  std::string text;
  char part[512];
  for (;;) {
    const ssize_t n = ::read(pipe, part, sizeof part);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0 || text.size() > longest_message) return text;
    text.append(part, std::size_t(n));
  }
}

}  // namespace

void rehearse(const std::filesystem::path& file, const std::string& what, const std::function<void()>& read) {
  std::error_code ignored;
  const std::uint64_t bytes =
      std::filesystem::is_regular_file(file, ignored) ? std::filesystem::file_size(file, ignored) : 0;
  int ends[2];
  std::fflush(nullptr);
  const pid_t parent = ::getpid();
  const bool has_pipe = ::pipe2(ends, O_CLOEXEC) == 0;
  const pid_t child = has_pipe ? ::fork() : -1;
  if (child == 0) {
    confine(bytes, parent);
    read_here(read, ends[1]);
  }
  const std::string why = child < 0 ? std::strerror(errno) : "";
  if (has_pipe) ::close(ends[1]);
  const std::string outcome = child < 0 ? "" : all_of(ends[0]);
  if (has_pipe) ::close(ends[0]);
  if (child < 0) {
    log::warn("'{}' is read without a prior trial in a separate process, because none could be started ({}).",
              file.string(), why);
    return;
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (outcome.starts_with(sound)) return;
  if (outcome.starts_with(refused)) throw Error(outcome.substr(1));
  const bool time = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL ||
                                            WTERMSIG(status) == SIGALRM);
  throw Error("The {} '{}' cannot be used: it is damaged or malicious ({}). Create it again.", what,
              file.string(),
              outcome.starts_with(out_of_memory) ? "reading it takes more memory than its size justifies"
              : time                             ? "reading it takes longer than its size justifies"
                                                 : "a trial read crashed");
}

}  // namespace couplet::io
