// SPDX-License-Identifier: Apache-2.0
#include "common/app/fault_injection.hpp"

#include <csignal>
#include <cstdlib>
#include <sstream>
#include <vector>

namespace couplet {

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
}

void FaultInjection::at(std::string_view phase) {
  if (armed_ && phase == phase_ && --remaining_ == 0) std::raise(SIGKILL);
}

}  // namespace couplet
