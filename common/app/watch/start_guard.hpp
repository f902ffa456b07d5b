// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <thread>

namespace couplet::app {

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
