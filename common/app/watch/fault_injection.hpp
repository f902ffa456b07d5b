// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

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

}  // namespace couplet::app
