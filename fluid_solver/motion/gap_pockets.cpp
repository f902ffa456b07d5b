// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/gaps.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Share of the flux through a pocket's inlets that their profiles may leave over.
constexpr double inlet_leftover = 1e-6;

}  // namespace

template <int D>
GapPockets<D>::GapPockets(const mesh::Mesh& mesh, const FluidParameters& parameters) : mesh_(mesh) {
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    if (condition_of(b).passage != Passage::none) (gives_pressure(b) ? open_ : given_).push_back(&patch);
  }
}

/// The least label spreads over the faces between free cells, then over the ranks, until all stand.
template <int D>
void GapPockets<D>::find(const std::vector<int>& gap) {
  label_.assign(mesh_.cells.n_local(), 0.0);
  for (Index c = 0; c < mesh_.cells.n_local(); ++c)
    if (gap[c] < 0) label_[c] = double(mesh_.cell_id[c]) + 1;
  std::vector<double> before;
  do {
    before = label_;
    for (bool spreads = true; spreads;) {
      spreads = false;
      const auto join = [&](Index f) {
        double &p = label_[mesh_.owner[f]], &n = label_[mesh_.neighbour[f]];
        if (p == 0 || n == 0 || p == n) return;
        p = n = std::min(p, n);
        spreads = true;
      };
      for (Index f = 0; f < mesh_.n_interior; ++f) join(f);
      for (Index f = mesh_.n_interior; f-- > 0;) join(f);
    }
    mesh_.cells.update_ghosts(label_);
  } while (parallel::any(mesh_.comm, before != label_));
  std::vector<double> all, open;
  for (const double label : label_) all.push_back(label);
  for (const mesh::Patch* patch : open_)
    for (Index f = patch->first; f < patch->first + patch->count; ++f) open.push_back(label_[mesh_.owner[f]]);
  for (auto* labels : {&all, &open}) {
    std::ranges::sort(*labels);
    labels->erase(std::unique(labels->begin(), labels->end()), labels->end());
    *labels = parallel::all_gather(mesh_.comm, *labels);
    std::ranges::sort(*labels);
    labels->erase(std::unique(labels->begin(), labels->end()), labels->end());
  }
  shut_.clear();
  std::ranges::set_difference(all, open, std::back_inserter(shut_));
}

template <int D>
void GapPockets<D>::check(const Placement<D>& at, const Vectors<D>& w, double time, bool compressible) const {
  if (shut_.empty()) return;
  // Net outflow of each pocket and the sum of its absolute values, then the same of each patch, to name it.
  const std::size_t n = shut_.size();
  std::vector<double> sums(n * (1 + given_.size()), 0.0), sizes(sums.size(), 0.0);
  for (std::size_t g = 0; g < given_.size(); ++g)
    for (Index f = given_[g]->first; f < given_[g]->first + given_[g]->count; ++f) {
      const double label = label_[mesh_.owner[f]];
      const auto found = std::ranges::lower_bound(shut_, label);
      if (found == shut_.end() || *found != label) continue;
      const std::size_t pocket = found - shut_.begin();
      const double flux = w[f - mesh_.n_interior].dot(at.area[f]);
      for (const std::size_t i : {pocket, n * (1 + g) + pocket}) sums[i] += flux, sizes[i] += std::abs(flux);
    }
  const int count = static_cast<int>(sums.size());
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), count, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  MPI_Allreduce(MPI_IN_PLACE, sizes.data(), count, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  for (std::size_t i = 0; i < n; ++i) {
    const bool in_blocked_cells = shut_[i] == 0;
    if (compressible && !in_blocked_cells) continue;
    if ((in_blocked_cells ? sizes[i] : std::abs(sums[i])) <= inlet_leftover * sizes[i]) continue;
    std::vector<std::string> names;
    for (std::size_t g = 0; g < given_.size(); ++g)
      if (sizes[n * (1 + g) + i] > 0) names.push_back(given_[g]->name);
    if (in_blocked_cells)
      throw SchemeFailure(
          "gaps: at t = {:.6g} s the closed gap reaches '{}', where {:.3g} m^3/s would cross its blocked "
          "cells. Keep the gap wider than 'opening' there, or reduce that velocity to zero before it closes.",
          time, base::join(names), sizes[i]);
    throw SchemeFailure(
        "gaps: at t = {:.6g} s the closed gap separates '{}' from every outlet, but {:.3g} m^3/s are to "
        "flow {} there, which cannot be balanced. Give that part of the fluid an outlet, reduce the "
        "velocity to zero before the gap closes, or prescribe a pressure instead (type outlet).",
        time, base::join(names), std::abs(sums[i]), sums[i] < 0 ? "in" : "out");
  }
}

template <int D>
std::string GapPockets<D>::cause(const Placement<D>& at) const {
  if (shut_.empty() || shut_.back() == 0) return {};
  double sums[D + 1] = {};  // of the last one's cells: places, number
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
    if (label_[c] != shut_.back()) continue;
    for (int i = 0; i < D; ++i) sums[i] += at.centre[c][i];
    sums[D] += 1;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, D + 1, MPI_DOUBLE, MPI_SUM, mesh_.comm);
  return fmt::format(
      "A closed gap has separated {} cells around ({:.4g}, {:.4g}, {:.4g}) m from every outlet: the volume "
      "that their walls displace cannot leave. Give that part of the fluid an outlet, or block it as well.",
      GlobalIndex(sums[D]), sums[0] / sums[D], sums[1] / sums[D], D == 3 ? sums[2] / sums[D] : 0.0);
}

template class GapPockets<2>;
template class GapPockets<3>;

}  // namespace couplet::fluid
