// SPDX-License-Identifier: Apache-2.0
#include "common/app/watch/watch_board.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>

namespace couplet::app::watching {

Board board;  // NOLINT: see above

double now() {
  timespec t{};
  ::clock_gettime(CLOCK_MONOTONIC, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

char state_of(int pid) {
  if (::kill(pid, 0) != 0 && errno == ESRCH) return 'X';
  Line path;
  path << "/proc/" << long(pid) << "/stat" << std::string_view("\0", 1);
  const int file = ::open(path.text(), O_RDONLY);
  if (file < 0) return 'X';
  char text[512];
  const ssize_t size = ::read(file, text, sizeof text);
  ::close(file);
  // "pid (program) state ...", where the program's name may hold anything but ends at the last bracket.
  for (ssize_t i = size - 1; i >= 0; --i)
    if (text[i] == ')' && i + 2 < size) return text[i + 2];
  return 'R';
}

bool gone(int pid) {
  const char state = state_of(pid);
  return state == 'Z' || state == 'X';
}

namespace {

/// utime and stime of one process, and those of its children that have ended.
double own_seconds(const std::string& folder) {
  std::ifstream file(folder + "/stat");
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto end = text.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(text.substr(end + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) fields >> skipped;
  double total = 0, ticks = 0;
  for (int i = 0; i < 4 && fields >> ticks; ++i) total += ticks;
  return total / double(::sysconf(_SC_CLK_TCK));
}

/// With its children and theirs: a program may be started by way of another.
double seconds_of(const std::string& pid, int depth) {
  const std::string folder = "/proc/" + pid;
  double total = own_seconds(folder);
  std::ifstream children(folder + "/task/" + pid + "/children");
  for (std::string child; depth > 0 && children >> child;) total += seconds_of(child, depth - 1);
  return total;
}

}  // namespace

double processor_seconds_of(int pid) { return seconds_of(std::to_string(pid), 4); }

void describe(Line& line, const Slot& slot, std::string_view fate) {
  line << "participant '" << slot.participant << "'";
  if (slot.rank >= 0)
    line << " (rank " << long(slot.rank) << ", pid " << long(slot.pid) << ")";
  else
    line << " (pid " << long(slot.pid) << ")";
  line << " " << fate << "; last heard of in " << name(Phase(slot.phase.load()));
  if (slot.time >= 0) line << " at t = " << slot.time.load() << " s";
}

void end_job_with(const Line& line) {
  if (board.slots[0].spoke_for_all.exchange(1) == 0) line.write_to(STDERR_FILENO);
  board.slots[board.mine].ending = 1;
  timespec pause{0, 100'000'000};
  ::nanosleep(&pause, nullptr);
  ::_exit(1);
}

}  // namespace couplet::app::watching
