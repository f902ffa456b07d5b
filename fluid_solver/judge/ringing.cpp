// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/judge/ringing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace couplet::fluid {
namespace {

constexpr int rung_steps = 10;

}  // namespace

template <int D>
double RingingWatch::share(const mesh::Mesh& mesh, const State<D>& s) {
  if (!s.pressure[2]) return 0;
  const std::vector<double>&p0 = s.pressure[0]->p, &p1 = s.pressure[1]->p, &p2 = s.pressure[2]->p;
  double sums[3] = {};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double v = s.placement->volume[c], turn = p0[c] - 2 * p1[c] + p2[c], change = p0[c] - p2[c];
    sums[0] += v * turn * turn, sums[1] += v * change * change, sums[2] += v * p0[c] * p0[c];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sums[0] > sums[1] && sums[2] > 0 ? std::sqrt(sums[0] / sums[2]) / 4 : 0;
}

bool RingingWatch::add(double share) {
  steps_ = share > limit ? steps_ + 1 : 0;
  if (steps_ < rung_steps) return false;
  largest_ = std::max(largest_, share);
  return !std::exchange(told_, true);
}

template double RingingWatch::share<2>(const mesh::Mesh&, const State<2>&);
template double RingingWatch::share<3>(const mesh::Mesh&, const State<3>&);

}  // namespace couplet::fluid
