// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters/schedule.hpp"

#include <cmath>

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
  return int(p.predictor_order.value_or(p.exchange && one_pass ? 0 : 2));
}

Schedule schedule_of(const CouplingParameters& p) {
  Schedule s;
  s.iterates = p.scheme != coupling::Scheme::explicit_;
  s.mesh_on_guess = p.mesh_on_guess;
  s.waveform = p.waveform == CouplingParameters::Waveform::linear;
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

}  // namespace couplet::coupler
