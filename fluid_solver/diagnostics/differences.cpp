// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/differences.hpp"

#include "common/base/processor_clones.hpp"

namespace couplet::fluid {
namespace {

template <int D>
[[gnu::always_inline]] inline std::array<double, 5> renew_all(const Differences<D>& d) {
  std::array<double, 5> sums{};
  for (std::size_t c = 0; c < d.volume.size(); ++c) {
    const double volume = d.volume[c];
    const Vec<D> rate = (d.now[c] - d.u[c]) * d.per_step, change = (rate - d.rate[c]) * d.per_apart;
    sums[0] += volume * d.now[c].squaredNorm();
    sums[1] += volume * rate.squaredNorm();
    sums[2] += volume * change.squaredNorm();
    sums[3] += volume * (change - d.change[c]).squaredNorm();
    sums[4] += volume;
    d.u[c] = d.now[c], d.rate[c] = rate, d.change[c] = change;
  }
  return sums;
}

}  // namespace

COUPLET_PROCESSOR_CLONES std::array<double, 5> renew(const Differences<2>& d) { return renew_all(d); }
COUPLET_PROCESSOR_CLONES std::array<double, 5> renew(const Differences<3>& d) { return renew_all(d); }

}  // namespace couplet::fluid
