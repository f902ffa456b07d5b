// SPDX-License-Identifier: Apache-2.0
// Values within the step as a part of the unknown.
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/coupling/step_plan.hpp"
#include "coupler/acceleration/unknown.hpp"

namespace couplet::coupler {

bool Unknown::asked_within() const { return std::ranges::any_of(parts(), &Part::asked_within); }

bool Unknown::adopt_times(const std::vector<coupling::Exchange>& given) {
  std::vector<std::pair<std::size_t, double>> times, before;
  for (std::size_t i = 0; i < n_parts_; ++i) {
    if (!parts_[i].asked_within) continue;
    const auto first = std::ptrdiff_t(times.size());
    coupling::for_within(
        given[parts_[i].giver], parts_[i].datum.name,
        [&](double share, const std::string&, const auto&) { times.emplace_back(i, share); });
    std::sort(times.begin() + first, times.end());
  }
  for (std::size_t i = n_parts_; i < parts_.size(); ++i)
    before.emplace_back(*parts_[i].within, parts_[i].share);
  if (times == before) return false;
  set_times(times);
  return true;
}

void Unknown::set_times(const std::vector<std::pair<std::size_t, double>>& times) {
  parts_.resize(n_parts_);
  std::size_t unknown = n_unknown_, rider = n_rider_;
  for (const auto& [end, share] : times) {
    Part part = parts_[end];
    part.datum.name = coupling::WithinStep::name(part.datum.name, share);
    part.within = end;
    part.share = share;
    part.velocity.reset();
    std::size_t& n = part.rides ? rider : unknown;
    part.first = n;
    n += part.count;
    parts_.push_back(std::move(part));
  }
}

Iterate Unknown::begin_step(Iterate guess) {
  if (asked_within()) start_ = guess;
  return held(std::move(guess));
}

Iterate Unknown::held(Iterate x) const {
  for (std::size_t i = n_parts_; i < parts_.size(); ++i) {
    std::vector<double>& values = parts_[i].rides ? x.rider : x.unknown;
    const std::size_t first = parts_[*parts_[i].within].first;
    for (std::size_t k = 0; k < parts_[i].count; ++k) values.push_back(values[first + k]);
  }
  return x;
}

Iterate Unknown::ends(Iterate x) const {
  if (!has_within()) return x;
  x.unknown.resize(n_unknown_);
  x.rider.resize(n_rider_);
  return x;
}

/// On the cubic through the four times next to it that a participant gave instead, in a later pass of the step (Lagrange; fewer
/// times: of a lower degree).
std::vector<double> Unknown::between_times(const Part& part, const coupling::Exchange& given) const {
  const Part& end = parts_[*part.within];
  std::vector<std::pair<double, std::span<const double>>> known;
  const std::vector<double>& start = end.rides ? start_.rider : start_.unknown;
  std::vector<double> at_start;
  if (start.size() >= end.first + end.count) {
    at_start.assign(start.begin() + std::ptrdiff_t(end.first),
                    start.begin() + std::ptrdiff_t(end.first + end.count));
    for (double& v : at_start) v /= end.weight;
    known.emplace_back(0, at_start);
  }
  coupling::for_within(given, end.datum.name, [&](double share, const std::string&, const auto& values) {
    known.emplace_back(share, values);
  });
  if (const auto found = given.find(end.datum.name); found != given.end())
    known.emplace_back(1, found->second);
  std::ranges::sort(known, {}, [](const auto& one) { return one.first; });
  for (const auto& one : known)
    if (one.second.size() != end.count)
      throw Error("A participant gave {} values of '{}' within the step, but {} were announced.",
                  one.second.size(), end.datum.name, end.count);
  const auto distance = [&](const auto& one) { return std::abs(one.first - part.share); };
  while (known.size() > 4)  // the farther of both ends
    known.erase(distance(known.front()) > distance(known.back()) ? known.begin() : known.end() - 1);
  std::vector<double> values(end.count);
  for (const auto& [time, then] : known) {
    double weight = 1;
    for (const auto& other : known)
      if (other.first != time) weight *= (part.share - other.first) / (time - other.first);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * then[i];
  }
  return values;
}

}  // namespace couplet::coupler
