// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace couplet {

/// Why steps were halved. A cause that comes back again and again is not one that shorter steps cure: they only feed a run
/// whose answer is lost.
class HalvingCauses {
 public:
  /// So many halvings for one cause end a run. A cause that was away for more than `calm_steps` accepted steps (as where a
  /// load changes suddenly, or where a halved step tries now and then to grow back) begins anew.
  static constexpr int most = 10, calm_steps = 32;

  void accepted();
  /// How often this cause has halved a step, now included. Causes are the same where only numbers differ.
  int halved(const std::string& reason);
  /// "the pressure did not converge in # iterations".
  static std::string without_numbers(const std::string& reason);

 private:
  struct Count {
    int halvings = 0;
    long last = 0;
  };
  std::map<std::string, Count> counts_;
  long steps_ = 0;
};

}  // namespace couplet
