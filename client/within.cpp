// SPDX-License-Identifier: Apache-2.0
// Data of a participant and their values within a step ("datum@share", docs/protocol.md).
#include <algorithm>
#include <charconv>
#include <cstdio>

#include "client.hpp"

namespace couplet::wire {

std::size_t entries(const couplet_client& c, const Datum& d) {
  const std::size_t places = d.place == COUPLET_FACES ? c.surface.faces() : c.surface.vertices();
  return places * std::size_t(d.size(c.surface.dim));
}

const Datum* find(const std::vector<Datum>& list, const std::string& name) {
  for (const Datum& d : list)
    if (d.name == name) return &d;
  const std::size_t at = name.rfind('@');
  for (const Datum& d : list)
    if (at != std::string::npos && at + 1 < name.size() && name.compare(0, at, d.name) == 0) return &d;
  return nullptr;
}

void take_over(couplet_client& c, const std::string& name, const double* values, std::size_t count) {
  std::vector<double>& to = c.output[name];
  if (to.empty()) to.swap(c.spare[name]);
  to.assign(values, values + count);
}

std::string within_name(const std::string& datum, double share) {
  char text[40];
  std::snprintf(text, sizeof text, "@%.15g", share);
  return datum + text;
}

namespace {

/// Share in a name made by within_name(), or 0.
double share_in(const std::string& name) {
  double share = 0;
  std::from_chars(name.data() + name.rfind('@') + 1, name.data() + name.size(), share);
  return share;
}

/// Shares and values of a datum within the step, in ascending order.
std::vector<std::pair<double, const double*>> within(const couplet_client& c, const std::string& datum) {
  std::vector<std::pair<double, const double*>> list;
  const std::string begins = datum + '@';
  for (auto it = c.input.lower_bound(begins);
       it != c.input.end() && it->first.compare(0, begins.size(), begins) == 0; ++it)
    list.emplace_back(share_in(it->first), it->second.data());
  std::sort(list.begin(), list.end());
  return list;
}

}  // namespace
}  // namespace couplet::wire

using namespace couplet::wire;

extern "C" {

void couplet_takes_within(couplet_client* c, const char* datum) {
  const Datum* d = find(c->takes, datum);
  if (d == nullptr) end_the_job(std::string("'") + datum + "' was not announced by couplet_takes.");
  Datum asked = *d;
  asked.name += '@';
  c->takes.push_back(asked);
}

void couplet_write_within(couplet_client* c, const char* datum, double share, const double* values) {
  const Datum* d = find(c->gives, datum);
  if (d == nullptr) end_the_job(std::string("'") + datum + "' was not announced by couplet_gives.");
  const std::string name = within_name(datum, share);
  // Checks the share as written, because it may be rounded to an end of the step.
  if (const double written = share_in(name); !(written > 0 && written < 1))
    end_the_job(std::string("'") + datum + "' was given at " + std::to_string(share) +
                " of the step; times within it are between 0 and 1.");
  take_over(*c, name, values, entries(*c, *d));
}

int couplet_within(const couplet_client* c, const char* datum) { return int(within(*c, datum).size()); }

const double* couplet_read_within(const couplet_client* c, const char* datum, int number, double* share) {
  const auto list = within(*c, datum);
  if (number < 0 || std::size_t(number) >= list.size())
    end_the_job("there are " + std::to_string(list.size()) + " values of '" + datum +
                "' within the step, not " + std::to_string(number + 1) + ".");
  *share = list[std::size_t(number)].first;
  return list[std::size_t(number)].second;
}

}  // extern "C"
