// SPDX-License-Identifier: Apache-2.0
#include "coupler/scheme_choice.hpp"

#include "common/log/log.hpp"

namespace couplet::coupler {

bool SchemeChoice::accepted(double time) {
  in_a_row_ = renewals_ >= too_many ? in_a_row_ + 1 : 0;
  renewed_share_ += ((renewals_ > 0 ? 1 : 0) - renewed_share_) / memory;
  const bool in_a_row = in_a_row_ >= most_in_a_row;
  if (!is_open_ || (!in_a_row && renewed_share_ < most_renewed)) return false;
  turn();
  tell(time, in_a_row ? fmt::format("in {} steps in a row the fluid renewed its prediction {} times or more",
                                    most_in_a_row, too_many)
                      : fmt::format("the fluid renewed its prediction in {:.0f} % of the last steps",
                                    100 * renewed_share_));
  return true;
}

void SchemeChoice::tell(double time, const std::string& why) {
  log::info("t = {:g} s: scheme: implicit from here on: {}", time, why);
}

bool SchemeChoice::failed() {
  if (!is_open_) return false;
  turn();
  return true;
}

void SchemeChoice::turn() {
  is_open_ = false;
  now_ = coupling::Scheme::implicit;
}

void SchemeChoice::restore(const std::array<double, 2>& state) {
  renewed_share_ = state[1];
  if (state[0] >= 0)
    in_a_row_ = int(state[0]);
  else if (is_open_)
    turn();
}

}  // namespace couplet::coupler
