// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/unknown.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/coupling/step_plan.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {

Unknown::Unknown(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                 const std::vector<std::size_t>& group, bool side_by_side)
    : comm_(comm), sides_(&sides) {
  const auto position_in_group = [&](std::size_t i) { return std::ranges::find(group, i) - group.begin(); };
  const auto add = [&](const Links::Link& link) {
    const auto known = std::ranges::find_if(
        parts_, [&](const Part& p) { return p.giver == link.giver && p.datum.name == link.datum.name; });
    if (known != parts_.end()) {
      known->needs_samples = known->needs_samples || link.within;
      return;
    }
    parts_.push_back({link.giver, link.datum, link.components, 0,
                      sides[link.giver].entries(link.datum.place) * std::size_t(link.components)});
    parts_.back().needs_samples = link.within;
  };
  for (const auto& link : links.all()) {
    if (position_in_group(link.giver) == std::ssize(group)) continue;  // not a member
    const auto taker = position_in_group(link.taker);
    // A mover takes its data first.
    if (taker == std::ssize(group) || side_by_side || position_in_group(link.giver) >= taker) add(link);
  }
  // The mover's guess of a displacement also requires its velocity.
  const std::vector<Part> taken = parts_;
  for (const Part& p : taken)
    for (const auto& link : links.all())
      if (p.datum.name == "displacement" && link.giver == p.giver && link.datum.name == "velocity") add(link);
  for (Part& p : parts_) {
    if (p.datum.name != "velocity") continue;
    for (Part& d : parts_)
      if (d.giver == p.giver && d.datum.name == "displacement" && d.count == p.count) p.is_dependent = true;
  }
  n_parts_ = parts_.size();
  for (Part& p : parts_) {
    std::size_t& n = p.is_dependent ? n_dependent_ : n_unknown_;
    p.first = n;
    n += p.count;
  }
  for (Part& d : parts_)
    for (const Part& p : parts_)
      if (p.is_dependent && p.giver == d.giver && d.datum.name == "displacement") d.velocity = p.first;
  // Data of one unit need no scale, but data without a unit may be of any.
  const auto lead = std::ranges::find(parts_, false, &Part::is_dependent);
  const bool alike = std::ranges::count(parts_, false, &Part::is_dependent) < 2 ||
                     (lead->datum.unit != "1" && std::ranges::all_of(parts_, [&](const Part& p) {
                        return p.is_dependent || p.datum.unit == lead->datum.unit;
                      }));
  for (Part& p : parts_) p.scaled = alike || p.is_dependent;
}

bool Unknown::complete(const std::vector<coupling::Exchange>& given) const {
  bool missing = false;
  for (const Part& p : parts()) missing = missing || !given[p.giver].contains(p.datum.name);
  return !missing;
}

Iterate Unknown::gather(const std::vector<coupling::Exchange>& given) const {
  Iterate x;
  x.unknown.reserve(n_unknown_);
  x.dependent.reserve(n_dependent_);
  std::vector<double> between;
  for (const Part& p : parts_) {
    const auto found = given[p.giver].find(p.datum.name);
    if (found == given[p.giver].end() && !p.sample_of)
      throw Error("A participant did not give '{}'.", p.datum.name);
    const std::vector<double>& values =
        found != given[p.giver].end() ? found->second : between = interpolate_sample(p, given[p.giver]);
    if (values.size() != p.count)
      throw Error("A participant gave {} values of '{}', but {} were announced.", values.size(), p.datum.name,
                  p.count);
    std::vector<double>& to =
        p.is_dependent ? x.dependent : x.unknown;  // parts lie in it one after the other
    to.insert(to.end(), values.begin(), values.end());
    if (p.weight != 1)
      for (std::size_t i = p.first; i < p.first + p.count; ++i) to[i] *= p.weight;
  }
  return x;
}

void Unknown::scatter(const Iterate& x, std::vector<coupling::Exchange>& given) const {
  for (const Part& p : parts_) {
    const std::vector<double>& from = p.is_dependent ? x.dependent : x.unknown;
    std::vector<double>& values = given[p.giver][p.datum.name];
    values.assign(from.begin() + std::ptrdiff_t(p.first), from.begin() + std::ptrdiff_t(p.first + p.count));
    if (p.weight != 1)
      for (double& v : values) v /= p.weight;
  }
}

bool Unknown::start_at_rest(std::vector<coupling::Exchange>& given) const {
  bool all = true;
  for (const Part& p : parts()) {
    const bool motion = p.is_dependent || p.velocity;
    if (motion) given[p.giver][p.datum.name].assign(p.count, 0.);
    all = all && motion;
  }
  return all;
}

void Unknown::scale(const std::vector<coupling::Exchange>& given) {
  for (std::size_t i = 0; i < n_parts_; ++i) {
    Part& p = parts_[i];
    if (p.scaled) continue;
    double square = 0;
    const auto add = [&](const std::string& name) {
      const std::vector<double>& values = values_of(given[p.giver], name);
      square += dot(values, values);
    };
    add(p.datum.name);
    coupling::for_within(given[p.giver], p.datum.name,
                         [&](double, const std::string& name, const auto&) { add(name); });
    square = parallel::sum(comm_, square);
    if (!(square > 0)) continue;
    p.scaled = true;
    for (Part& same : parts_)
      if (&same == &p || same.sample_of == i) same.weight = 1 / std::sqrt(square);
  }
}

std::vector<double> Unknown::weights() const {
  std::vector<double> w{1};
  for (const Part& p : parts()) w.push_back(p.scaled ? p.weight : 0);
  for (std::size_t i = n_parts_; i < parts_.size(); ++i)
    w.insert(w.end(), {double(*parts_[i].sample_of), parts_[i].share});
  return w;
}

void Unknown::restore_weights(const std::vector<double>& w) {
  bool sound = w.size() >= n_parts_ + 1 && (w.size() - n_parts_) % 2 == 1;
  std::vector<std::pair<std::size_t, double>> times;
  for (std::size_t i = n_parts_ + 1; sound && i + 1 < w.size(); i += 2) {
    times.emplace_back(std::size_t(w[i]), w[i + 1]);
    sound = w[i] >= 0 && times.back().first < n_parts_;
  }
  if (!sound) throw Error("The checkpoint is from a coupling with other data.");
  for (std::size_t i = 0; i < n_parts_; ++i) {
    parts_[i].scaled = w[i + 1] > 0;
    parts_[i].weight = parts_[i].scaled ? w[i + 1] : 1;
  }
  set_sample_times(times);
}

IterateOrder Unknown::order(bool within) const {
  std::vector<GlobalIndex> ids[2];
  GlobalIndex next[2] = {0, 0};
  for (const Part& p : within ? std::span<const Part>(parts_) : parts()) {
    const coupling::Interface& of = (*sides_)[p.giver].interface;
    const auto& places = p.datum.place == coupling::Interface::Place::vertices ? of.vertex_ids : of.face_ids;
    GlobalIndex most = -1;
    for (const GlobalIndex id : places) {
      for (int c = 0; c < p.components; ++c)
        ids[p.is_dependent].push_back(next[p.is_dependent] + id * p.components + c);
      most = std::max(most, id);
    }
    MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_INT64_T, MPI_MAX, comm_);
    next[p.is_dependent] += (most + 1) * p.components;
  }
  return {parallel::GlobalOrder::by_numbers(comm_, ids[0], ids[0].size()),
          parallel::GlobalOrder::by_numbers(comm_, ids[1], ids[1].size())};
}

std::vector<Residual> Unknown::measure(const Iterate& x, const Iterate& image, const Iterate& start,
                                       double least) const {
  std::vector<double> sums;
  std::vector<std::size_t> place_of(n_parts_);
  const auto all = x.unknown.size() == n_unknown_ ? parts() : std::span<const Part>(parts_);
  for (const Part& p : all) {
    if (p.is_dependent) continue;
    if (!p.sample_of) place_of[std::size_t(&p - parts_.data())] = sums.size();
    const std::span<const double> here(x.unknown.data() + p.first, p.count),
        there(image.unknown.data() + p.first, p.count);
    const ChangeSquares squares = squares_of_change(there, here);
    double moved = squares.size;
    if (!start.unknown.empty()) {
      const std::size_t first = p.sample_of ? parts_[*p.sample_of].first : p.first;
      moved = squares_of_change(there, {start.unknown.data() + first, p.count}).change;
    }
    const double four[] = {squares.change, squares.size, double(p.count) / p.components, moved};
    if (!p.sample_of)
      sums.insert(sums.end(), std::begin(four), std::end(four));
    else
      for (std::size_t i = 0; i < std::size(four); ++i) sums[place_of[*p.sample_of] + i] += four[i];
  }
  sum_over(comm_, sums);
  std::vector<Residual> list;
  std::size_t k = 0;
  for (const Part& p : parts()) {
    if (p.is_dependent) continue;
    const double r = sums[k], h = sums[k + 1], places = sums[k + 2];
    const double of = std::max(sums[k + 3], least * least * h);
    k += 4;
    // Converged if nothing moves, but not if a nonzero residual meets zero.
    const double relative =
        of > 0 ? std::sqrt(r / of) : (r > 0 ? std::numeric_limits<double>::infinity() : r);
    const auto mean = [&](double square) { return places > 0 ? std::sqrt(square / places) / p.weight : 0; };
    list.push_back({relative, mean(r), mean(h)});
  }
  return list;
}

std::vector<double> Unknown::motion(const Iterate& x) const {
  std::vector<double> values;
  for (const Part& p : parts_)
    if (p.datum.name == "displacement")
      for (std::size_t i = p.first; i < p.first + p.count; ++i) values.push_back(x.unknown[i] / p.weight);
  return values;
}

void CouplingHistory::accepted(Iterate x, double dt, int order) {
  if (order > 1) older = std::move(old), older_dt = old_dt;
  if (order > 0) old = std::move(now), old_dt = dt;
  now = std::move(x);
}

namespace {

/// Lagrange weights of the values at 0, -a and -a-b for the value at dt.
struct LagrangeWeights {
  double now = 1, old = 0, older = 0;
};
LagrangeWeights extrapolation(const CouplingHistory& h, double dt, int order) {
  if (order == 0 || h.old.unknown.size() + h.old.dependent.size() == 0) return {};
  const double a = h.old_dt;
  if (order == 1 || h.older.unknown.size() + h.older.dependent.size() == 0) return {1 + dt / a, -dt / a, 0};
  const double b = h.old_dt + h.older_dt;
  return {(dt + a) * (dt + b) / (a * b), -dt * (dt + b) / (a * (b - a)), dt * (dt + a) / (b * (b - a))};
}

}  // namespace

Iterate predict(const Unknown& unknown, const CouplingHistory& history, double dt, int order) {
  Iterate guess = history.now;
  if (order == 0) return guess;
  const LagrangeWeights w = extrapolation(history, dt, order);
  const bool two_levels = order == 2 && !history.old.dependent.empty();
  const double r = two_levels ? dt / history.old_dt : 0;
  const auto& v_now = history.now.dependent;
  for (const auto& p : unknown.parts()) {
    if (p.is_dependent) continue;
    for (std::size_t i = p.first; i < p.first + p.count; ++i) {
      if (!p.velocity) {
        guess.unknown[i] = w.now * history.now.unknown[i];
        if (w.old != 0) guess.unknown[i] += w.old * history.old.unknown[i];
        if (w.older != 0) guess.unknown[i] += w.older * history.older.unknown[i];
        continue;
      }
      const std::size_t k = *p.velocity + (i - p.first);
      const double change = two_levels ? v_now[k] - history.old.dependent[k] : 0;
      guess.unknown[i] += p.weight * dt * (v_now[k] + r / 2 * change);
      guess.dependent[k] += r * change;
    }
  }
  return guess;
}

// Values within the step as part of the unknown.

bool Unknown::needs_samples() const { return std::ranges::any_of(parts(), &Part::needs_samples); }

bool Unknown::adopt_sample_times(const std::vector<coupling::Exchange>& given) {
  std::vector<std::pair<std::size_t, double>> times, before;
  for (std::size_t i = 0; i < n_parts_; ++i) {
    if (!parts_[i].needs_samples) continue;
    const auto first = std::ptrdiff_t(times.size());
    coupling::for_within(
        given[parts_[i].giver], parts_[i].datum.name,
        [&](double share, const std::string&, const auto&) { times.emplace_back(i, share); });
    std::sort(times.begin() + first, times.end());
  }
  for (std::size_t i = n_parts_; i < parts_.size(); ++i)
    before.emplace_back(*parts_[i].sample_of, parts_[i].share);
  if (times == before) return false;
  set_sample_times(times);
  return true;
}

void Unknown::set_sample_times(const std::vector<std::pair<std::size_t, double>>& times) {
  parts_.resize(n_parts_);
  std::size_t unknown = n_unknown_, dependent = n_dependent_;
  for (const auto& [end, share] : times) {
    Part part = parts_[end];
    part.datum.name = coupling::WithinStep::name(part.datum.name, share);
    part.sample_of = end;
    part.share = share;
    part.velocity.reset();
    std::size_t& n = part.is_dependent ? dependent : unknown;
    part.first = n;
    n += part.count;
    parts_.push_back(std::move(part));
  }
}

Iterate Unknown::start_step(Iterate guess) {
  if (needs_samples()) start_ = guess;
  return hold_samples(std::move(guess));
}

Iterate Unknown::hold_samples(Iterate x) const {
  x = end_values(std::move(x));
  for (std::size_t i = n_parts_; i < parts_.size(); ++i) {
    std::vector<double>& values = parts_[i].is_dependent ? x.dependent : x.unknown;
    const std::size_t first = parts_[*parts_[i].sample_of].first;
    for (std::size_t k = 0; k < parts_[i].count; ++k) values.push_back(values[first + k]);
  }
  return x;
}

Iterate Unknown::end_values(Iterate x) const {
  if (!has_samples()) return x;
  x.unknown.resize(n_unknown_);
  x.dependent.resize(n_dependent_);
  return x;
}

/// Values at other times that a participant gave in a later pass of the step, by the cubic through the four
/// nearest times (Lagrange; fewer times lower the degree).
std::vector<double> Unknown::interpolate_sample(const Part& part, const coupling::Exchange& given) const {
  const Part& end = parts_[*part.sample_of];
  std::vector<std::pair<double, std::span<const double>>> known;
  const std::vector<double>& start = end.is_dependent ? start_.dependent : start_.unknown;
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
