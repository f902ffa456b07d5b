// SPDX-License-Identifier: Apache-2.0
#include "common/app/loop/halving_causes.hpp"

#include <cctype>

namespace couplet::app {

void HalvingCauses::accepted(double dt) {
  for (auto& [cause, count] : counts_) count.good_steps += dt >= (1 - 1e-9) * count.dt;
}

int HalvingCauses::halved(const std::string& reason, double dt) {
  const std::string cause = without_numbers(reason);
  Count& count = counts_[cause.substr(0, cause.find(". "))];
  if (count.good_steps > calm_steps) count.halvings = 0;
  count.good_steps = 0;
  count.dt = dt;
  return ++count.halvings;
}

std::string HalvingCauses::without_numbers(const std::string& reason) {
  const auto digit = [&](std::size_t i) {
    return i < reason.size() && std::isdigit(static_cast<unsigned char>(reason[i]));
  };
  const auto sign = [&](std::size_t i) {
    return i < reason.size() && (reason[i] == '-' || reason[i] == '+');
  };
  std::string text;
  for (std::size_t i = 0; i < reason.size();) {
    if (!digit(i)) {
      text += reason[i++];
      continue;
    }
    if (!text.empty() && text.back() == '-') text.pop_back();
    while (digit(i) || (i < reason.size() && reason[i] == '.' && digit(i + 1)) ||
           (i < reason.size() && reason[i] == 'e' && (digit(i + 1) || (sign(i + 1) && digit(i + 2)))) ||
           (sign(i) && reason[i - 1] == 'e'))
      ++i;
    text += '#';
  }
  return text;
}

}  // namespace couplet::app
