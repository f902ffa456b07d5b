// SPDX-License-Identifier: Apache-2.0
#include "coupler/judge/still_guard.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

double largest(const coupling::Exchange& data, const std::string& name) {
  const auto found = data.find(name);
  double most = 0;
  if (found != data.end())
    for (const double value : found->second) most = std::max(most, std::abs(value));
  return most;
}

}  // namespace

StillGuard::StillGuard(MPI_Comm comm, const std::vector<Side>& sides) : comm_(comm) {
  for (std::size_t s = 0; s < sides.size(); ++s) {
    const coupling::Interface& i = sides[s].interface;
    if (std::ranges::find(i.gives, std::string("displacement"), &coupling::Interface::Datum::name) ==
        i.gives.end())
      continue;
    Structure one{s, sides[s].name, {}, {}};
    for (const auto& datum : i.takes)
      if (datum.unit == "N" || datum.unit == "Pa") one.loads.push_back(datum.name), one.unit = datum.unit;
    if (!one.loads.empty()) structures_.push_back(std::move(one));
  }
}

std::vector<std::string> StillGuard::accepted(const std::vector<coupling::Exchange>& given,
                                              const std::vector<coupling::Exchange>& taken) {
  std::vector<std::string> findings;
  for (Structure& one : structures_) {
    if (one.told) continue;
    double load = 0;
    for (const std::string& name : one.loads) load = std::max(load, largest(taken[one.side], name));
    load = parallel::max(comm_, load);
    const double motion = parallel::max(comm_, largest(given[one.side], "displacement"));
    one.steps = load > 0 && motion == 0 ? one.steps + 1 : 0;
    if (one.steps < patience) continue;
    one.told = true;
    findings.push_back(fmt::format(
        "motion of '{}': 0 m at every interface vertex for {} steps under a load of up to {:.3g} {} per "
        "face: the interface is held fixed; check its boundary conditions and `coupling`.",
        one.name, one.steps, load, one.unit));
  }
  return findings;
}

}  // namespace couplet::coupler
