// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters/schedule.hpp"

#include <cmath>

#include "common/log/log.hpp"

namespace couplet::coupler {

std::vector<std::string> Schedule::everyone() const {
  std::vector<std::string> all;
  if (mover) all.push_back(*mover);
  all.insert(all.end(), group.begin(), group.end());
  return all;
}

int Schedule::sub_steps_of(const std::string& name) const {
  const auto found = sub_steps.find(name);
  return found == sub_steps.end() ? 1 : found->second;
}

int predictor_order_of(const CouplingParameters& p) {
  const bool one_pass = p.scheme == coupling::Scheme::explicit_;
  return int(p.predictor_order.value_or(!one_pass ? 2 : p.exchange ? 0 : 1));
}

Schedule schedule_of(const CouplingParameters& p) {
  Schedule s;
  s.iterates = p.scheme != coupling::Scheme::explicit_;
  s.mesh_on_guess = p.mesh_on_guess || p.scheme.adapts;
  s.loads_at_rest = p.loads_at_rest;
  for (const auto& [name, steps] : p.sub_steps) s.sub_steps[name] = int(std::lround(steps));
  if (p.exchange) {
    s.group = p.exchange->participants;
    s.side_by_side = p.exchange->order == CouplingParameters::Exchange::Order::parallel;
  } else if (p.moves_alone()) {
    s.group = {p.fluid->participant};
  } else {
    s.group = {p.fluid.value().participant, p.structure.value().participant};
    if (p.order == CouplingParameters::Exchange::Order::structure_first) std::swap(s.group[0], s.group[1]);
    s.side_by_side = p.order == CouplingParameters::Exchange::Order::parallel;
  }
  s.predictor = predictor_order_of(p);
  if (!p.mesh) return s;
  s.mover = p.mesh->participant;
  s.moved = p.fluid.value().participant;
  return s;
}

bool SchemeChoice::accepted(double time) {
  if (!is_open_) return false;
  const bool failed = now_ == coupling::Scheme::implicit;
  in_a_row_ = failed ? in_a_row_ + 2 : renewals_ >= too_many ? in_a_row_ + 1 : 0;
  renewed_share_ += ((failed || renewals_ > 0 ? 1 : 0) - renewed_share_) / memory;
  const bool in_a_row = in_a_row_ >= most_in_a_row;
  is_open_ = !in_a_row && renewed_share_ < most_renewed;
  now_ = is_open_ ? coupling::Scheme::semi_implicit : coupling::Scheme::implicit;
  if (is_open_) return failed;
  log::info("t = {:g} s: the scheme is implicit from now on: {}", time,
            in_a_row && failed ? "several steps in a row failed"
            : in_a_row
                ? fmt::format("in several steps in a row, the fluid predicted its velocity {} times or more",
                              too_many)
                : fmt::format("in {:.0f} % of the last steps, the fluid predicted its velocity again",
                              100 * renewed_share_));
  return true;
}

bool SchemeChoice::failed() {
  if (!is_open_ || now_ == coupling::Scheme::implicit) return false;
  now_ = coupling::Scheme::implicit;
  return true;
}

void SchemeChoice::restore(const std::array<double, 2>& state) {
  renewed_share_ = state[1];
  if (state[0] >= 0) {
    in_a_row_ = int(state[0]);
  } else if (is_open_) {
    is_open_ = false;
    now_ = coupling::Scheme::implicit;
  }
}

}  // namespace couplet::coupler
