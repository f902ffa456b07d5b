// SPDX-License-Identifier: Apache-2.0
#include "common/app/watch/start_guard.hpp"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <sstream>
#include <thread>
#include <vector>

#include "common/app/watch/watch_board.hpp"
#include "common/coupling/wait.hpp"
#include "common/log/progress.hpp"

namespace couplet::app {

FaultInjection::FaultInjection(std::string_view participant, int rank) {
  const char* text = std::getenv("COUPLET_FAULT");
  if (text == nullptr) return;
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ':');) parts.push_back(part);
  if (parts.size() < 3 || parts[0] != participant) return;
  if ((parts.size() > 3 ? std::atoi(parts[3].c_str()) : 0) != rank) return;
  armed_ = true;
  phase_ = parts[1];
  remaining_ = std::atoi(parts[2].c_str());
  fate_ = parts.size() > 4 ? parts[4] : "kill";
}

void FaultInjection::at(std::string_view phase) {
  if (!armed_ || phase != phase_ || --remaining_ != 0) return;
  using namespace std::chrono_literals;
  if (fate_ == "kill") std::raise(SIGKILL);
  if (fate_ == "stop") std::raise(SIGSTOP);
  while (fate_ == "hang") std::this_thread::sleep_for(1s);
  coupling::PoliteWait wait("a message that is never sent");
  while (fate_ == "wait") wait.pause();
  for (int i = 0; fate_ == "work" && i < 140; ++i) {
    std::this_thread::sleep_for(50ms);
    log::alive();
  }
}

namespace {

/// "fluid_solver (pid 7)", of the launcher's other children that are stopped, if any.
std::string stopped_ones() {
  const std::string launcher = std::to_string(::getppid());
  std::ifstream children("/proc/" + launcher + "/task/" + launcher + "/children");
  std::string names;
  for (int pid = 0; children >> pid;) {
    if (pid == ::getpid() || watching::state_of(pid) != 'T') continue;
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/" + std::to_string(pid) + "/exe", unknown);
    names += (names.empty() ? "" : ", ") + program.filename().string() + " (pid " + std::to_string(pid) + ")";
  }
  return names;
}

}  // namespace

StartGuard::StartGuard(double seconds, std::string label) {
  if (!(seconds > 0)) return;
  guard_ = std::jthread([seconds, label = std::move(label)](const std::stop_token& stop) {
    sigset_t all;  // signals are for the main thread
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, nullptr);
    std::mutex mutex;
    std::condition_variable_any bell;
    std::unique_lock lock(mutex);
    bell.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
    if (stop.stop_requested()) return;
    const std::string stopped = stopped_ones();
    std::ostringstream text;
    text << "[" << label << "] error: not all programs of this job have answered within " << seconds
         << " s of the start (simulation.hang-timeout): "
         << (stopped.empty() ? "one of them hangs or was not started" : "stopped (as by SIGSTOP): " + stopped)
         << ". The job ends.\n";
    std::cerr << text.str() << std::flush;
    ::_exit(1);  // the launcher ends the others, stopped ones too
  });
}

}  // namespace couplet::app
