// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <thread>

namespace couplet::app {

/// A test aid: COUPLET_FAULT="solid:solve:2" kills rank 0 of participant 'solid' with SIGKILL when it enters
/// its second solve; "solid:solve:2:1" kills rank 1. A fifth part names another fate: hang (for ever, without a sign of
/// life), work (for 7 s, with signs of life), wait (for a message that nobody sends), stop (SIGSTOP). The phases are those
/// of app/watch.hpp. Without the variable nothing happens.
class FaultInjection {
 public:
  FaultInjection(std::string_view participant, int rank);
  void at(std::string_view phase);

 private:
  bool armed_ = false;
  std::string phase_, fate_;
  int remaining_ = 0;
};

/// Until the processes of a job know each other, a Watch cannot see that one of them hangs: the others wait in
/// MPI_Init for ever. This ends the process, and by that the job, where the start takes longer than the hang timeout.
/// To be made before MPI_Init; disarmed by its end.
class StartGuard {
 public:
  /// `seconds`: 0 for never. `label`: who speaks.
  StartGuard(double seconds, std::string label);

 private:
  std::jthread guard_;
};

}  // namespace couplet::app
