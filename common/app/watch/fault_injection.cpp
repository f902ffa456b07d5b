// SPDX-License-Identifier: Apache-2.0
#include "common/app/watch/fault_injection.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <thread>
#include <vector>

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

}  // namespace couplet::app
