// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace couplet::app {

/// Why steps were halved. A cause that comes back again and again is not one that shorter steps cure: they only feed a run
/// whose answer is lost.
class HalvingCauses {
 public:
  /// So many halvings for one cause end a run. A cause begins anew where more than `calm_steps` steps were accepted since
  /// that are as long as the one that failed: it is over, as where a load has changed suddenly.
  static constexpr int most = 10, calm_steps = 16;

  /// dt [s] of the step.
  void accepted(double dt);
  /// How often this cause has halved a step, now included. Causes are the same where the first sentences differ by numbers only.
  int halved(const std::string& reason, double dt);
  /// "the pressure did not converge in # iterations".
  static std::string without_numbers(const std::string& reason);

 private:
  struct Count {
    int halvings = 0, good_steps = 0;
    double dt = 0;  // that failed [s]
  };
  std::map<std::string, Count> counts_;
};

}  // namespace couplet::app
