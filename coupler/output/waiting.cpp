// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/waiting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace couplet::coupler {
namespace {

// What a division has to gain before it is proposed.
constexpr double worth_it = 0.1;
// Below that a run is too short to judge [s].
constexpr double too_short = 1;

double work(const Worker& w) { return w.seconds * w.ranks; }

double time(const std::vector<Worker>& workers, const std::vector<int>& ranks, bool side_by_side) {
  double sum = 0, longest = 0;
  for (std::size_t i = 0; i < workers.size(); ++i) {
    const double t = work(workers[i]) / ranks[i];
    sum += t;
    longest = std::max(longest, t);
  }
  return side_by_side ? longest : sum;
}

std::string listed(const std::vector<Worker>& workers, const std::vector<int>& ranks) {
  std::string text;
  for (std::size_t i = 0; i < workers.size(); ++i)
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", workers[i].name, ranks[i]);
  return text;
}

}  // namespace

std::vector<int> divide_ranks(const std::vector<Worker>& workers, int total, bool side_by_side) {
  std::vector<int> ranks(workers.size(), 1);
  // Each further rank where it helps most: right for sums of convex functions, and for the longest of falling ones.
  for (int n = int(workers.size()); n < total; ++n) {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < workers.size(); ++i) {
      const double gain = work(workers[i]) / (side_by_side ? ranks[i] : ranks[i] * (ranks[i] + 1.));
      if (gain > most) most = gain, best = i;
    }
    ++ranks[best];
  }
  return ranks;
}

std::string waiting_sentence(const std::vector<Worker>& workers, bool side_by_side) {
  double sum = 0;
  int total = 0;
  std::vector<int> now;
  for (const Worker& w : workers) {
    sum += w.seconds;
    total += w.ranks;
    now.push_back(w.ranks);
  }
  if (workers.size() < 2 || sum < too_short) return {};
  const auto slowest = std::ranges::max_element(workers, {}, &Worker::seconds);
  std::string text =
      side_by_side
          ? fmt::format("waiting: side by side, all wait for '{}', which takes longest", slowest->name)
          : fmt::format("waiting: one after another, the others wait for '{}' {:.0f} % of the time at work",
                        slowest->name, 100 * slowest->seconds / sum);
  if (total == int(workers.size()))
    return text + fmt::format("; a further rank is best given to it ('-n {}={}')", slowest->name, 2);
  const std::vector<int> better = divide_ranks(workers, total, side_by_side);
  const double before = time(workers, now, side_by_side), after = time(workers, better, side_by_side);
  if (after > (1 - worth_it) * before)
    return text + fmt::format("; the ranks fit ({})", listed(workers, now));
  return text +
         fmt::format("; '-n {}' in place of {} would take {:.0f} % less if the work divides by the ranks",
                     listed(workers, better), listed(workers, now), 100 * (1 - after / before));
}

}  // namespace couplet::coupler
