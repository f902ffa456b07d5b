// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/point_medians.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/parallel/collective.hpp"

namespace couplet::solid {

std::vector<double> medians(const mesh::Mesh& mesh, const std::vector<PointShare>& shares,
                            std::span<const std::uint8_t> wanted) {
  std::vector<PointShare> all = parallel::all_gather(mesh.comm, shares);
  std::ranges::sort(all, {}, [](const PointShare& s) { return std::pair(s.point, s.share); });
  std::vector<double> result(wanted.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    if (!wanted[v]) continue;
    const auto own = std::ranges::equal_range(all, mesh.point_id[v], {}, &PointShare::point);
    if (const std::size_t n = own.size(); n > 0)
      result[v] = 0.5 * (own[(n - 1) / 2].share + own[n / 2].share);
  }
  return result;
}

}  // namespace couplet::solid
