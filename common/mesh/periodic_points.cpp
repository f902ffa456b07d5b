// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/periodic_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/disjoint_sets.hpp"
#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {
namespace {

/// Both sides of each point of the periodic faces on this rank.
std::vector<std::array<GlobalIndex, 2>> pairs_here(const Mesh& mesh, const Geometry& geometry) {
  std::vector<std::array<GlobalIndex, 2>> pairs;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Vec3 shift = mesh.shift(f);
    if (shift.isZero()) continue;
    for (const Index v : mesh.face_points[f]) {
      const Vec3 wanted = geometry.points[v] - shift;
      Index nearest = -1;
      double least = std::numeric_limits<double>::infinity();
      for (const Index other : mesh.cell_points[mesh.neighbour[f]]) {
        const double distance = (geometry.points[other] - wanted).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        nearest = other;
      }
      pairs.push_back({mesh.point_id[v], mesh.point_id[nearest]});
    }
  }
  return pairs;
}

/// Maps each point to its copy with the smallest number.
std::map<GlobalIndex, GlobalIndex> roots_of(const std::vector<std::array<GlobalIndex, 2>>& pairs) {
  std::vector<GlobalIndex> points;  // ascending, without duplicates
  for (const auto& pair : pairs) points.insert(points.end(), pair.begin(), pair.end());
  std::ranges::sort(points);
  points.erase(std::ranges::unique(points).begin(), points.end());
  const auto place = [&](GlobalIndex p) {
    return Index(std::ranges::lower_bound(points, p) - points.begin());
  };
  base::DisjointSets sets(Index(points.size()));
  for (const auto& [a, b] : pairs) sets.join(place(a), place(b));
  std::map<GlobalIndex, GlobalIndex> roots;
  for (Index i = 0; i < Index(points.size()); ++i)
    roots.emplace_hint(roots.end(), points[i], points[sets.find(i)]);
  return roots;
}

}  // namespace

std::vector<std::array<std::string, 2>> periodic_pairs(const std::map<std::string, std::string>& partner_of) {
  std::vector<std::array<std::string, 2>> pairs;
  for (const auto& [name, wanted] : partner_of) {
    const auto partner = partner_of.find(wanted);
    if (partner == partner_of.end() || partner->second != name || wanted == name)
      throw Error(
          "boundaries.{}: its partner '{}' must be another patch of type periodic whose partner is '{}'.",
          name, wanted, name);
    if (name < wanted) pairs.push_back({name, wanted});
  }
  return pairs;
}

PeriodicPoints::PeriodicPoints(const Mesh& mesh, const Geometry& geometry) : mesh_(mesh) {
  if (!parallel::any(mesh.comm, !mesh.neighbour_shift.empty())) return;  // empty on a rank without cells
  const auto roots = roots_of(parallel::all_gather(mesh.comm, pairs_here(mesh, geometry)));
  std::map<GlobalIndex, Index> group_of;  // of the roots
  for (const auto& [point, root] : roots)
    if (group_of.try_emplace(root, static_cast<Index>(group_of.size())).second) copies_.push_back(0);
  for (const auto& [point, root] : roots) ++copies_[group_of.at(root)];
  n_groups_ = group_of.size();
  for (Index v = 0; v < mesh.points.n_local(); ++v)
    if (const auto found = roots.find(mesh.point_id[v]); found != roots.end()) {
      points_.push_back(v);
      group_.push_back(group_of.at(found->second));
    }
}

void PeriodicPoints::add_up(std::span<double> values, int stride, Ghosts ghosts) const {
  std::vector<double> sums(n_groups_ * stride, 0.0);
  const Index end = ghosts == Ghosts::count ? mesh_.points.n_local() : mesh_.points.n_owned();
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (int c = 0; c < stride && points_[i] < end; ++c)
      sums[std::size_t(group_[i]) * stride + c] += values[std::size_t(points_[i]) * stride + c];
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
  for (std::size_t i = 0; i < points_.size(); ++i)
    for (int c = 0; c < stride; ++c)
      values[std::size_t(points_[i]) * stride + c] = sums[std::size_t(group_[i]) * stride + c];
}

double PeriodicPoints::largest_gap(std::span<const double> values, int stride) const {
  std::vector<double> means(values.begin(), values.end());
  add_up(means, stride);
  double largest = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    double square = 0;
    for (int c = 0; c < stride; ++c) {
      const std::size_t at = std::size_t(points_[i]) * stride + c;
      square += std::pow(values[at] - means[at] / copies(i), 2);
    }
    largest = std::max(largest, 2 * std::sqrt(square));
  }
  return parallel::max(mesh_.comm, largest);
}

}  // namespace couplet::mesh
