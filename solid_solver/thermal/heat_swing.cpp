// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/thermal/heat_swing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/diagnostics/finding.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

constexpr int patience = 4;              // turns in a row
constexpr double turning_cosine = -0.5;  // cosine between the changes of two steps
constexpr double noticeable = 1e-3;      // root mean square of a step's change over all temperatures seen

}  // namespace

void HeatSwing::accepted(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                         const std::vector<double>& before, const std::vector<double>& after, double time) {
  if (told_) return;
  const bool first = !begun_;  // the same on all ranks, also on one without cells
  begun_ = true;
  change_.resize(after.size(), 0.0);
  double sums[4] = {};  // change.change, last.last, change.last, volume
  double range[2] = {-1e300, -1e300};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double volume = geometry.volume[c], change = after[c] - before[c];
    sums[0] += volume * change * change;
    sums[1] += volume * change_[c] * change_[c];
    sums[2] += volume * change * change_[c];
    sums[3] += volume;
    range[0] = std::max({range[0], after[c], before[c]});
    range[1] = std::max({range[1], -after[c], -before[c]});
    change_[c] = change;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, range, 2, MPI_DOUBLE, MPI_MAX, mesh.comm);
  highest_ = first ? range[0] : std::max(highest_, range[0]);
  lowest_ = first ? -range[1] : std::min(lowest_, -range[1]);
  const double size = std::sqrt(sums[0] / sums[3]);
  const bool turns =
      sums[2] < turning_cosine * std::sqrt(sums[0] * sums[1]) && size > noticeable * (highest_ - lowest_);
  turns_ = turns ? turns_ + 1 : 0;
  if (turns_ < patience) return;
  told_ = true;
  diagnostics::finding(
      parallel::comm_rank(mesh.comm),
      {.id = "heat-swing",
       .number = size / (highest_ - lowest_),
       .limit = noticeable,
       .sentence = fmt::format(
           "t = {:.6g} s: the temperature oscillates from step to step: amplitude {:.3g} K (rms) in a range "
           "of {:.3g} K: 'heat: {{scheme: trapezoidal}}' does not damp unresolved modes. Use 'scheme: "
           "three-point' or 'euler', or shorter steps.",
           time, size, highest_ - lowest_)});
}

}  // namespace couplet::solid
