// SPDX-License-Identifier: Apache-2.0
// Maps over the coupler's ranks: the same values as on one, however the two sides are cut.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "common/parallel/collective.hpp"
#include "coupler/mapping.hpp"

namespace couplet {
namespace {

const MPI_Comm world = MPI_COMM_WORLD;

/// n points on a spiral, this rank's part of them; `turned`: the list runs the other way.
PointSet spiral(int n, bool turned) {
  PointSet set;
  set.starts = even_starts(n, comm_size(world));
  const auto rank = std::size_t(comm_rank(world));
  for (GlobalIndex p = set.starts[rank]; p < set.starts[rank + 1]; ++p) {
    const double t = double(turned ? n - 1 - p : p) / (n - 1);
    set.points.emplace_back(t * std::cos(9 * t), t * std::sin(9 * t), t);
    set.positions.push_back(p);
    set.ids.push_back(turned ? n - 1 - p : p);
    set.sizes.push_back(1 + 0.5 * t);
  }
  return set;
}

/// The list of all ranks.
PointSet gathered(const PointSet& set) {
  return whole_set({set.what, all_gather(world, set.points), all_gather(world, set.sizes)});
}

TEST(MapsOverRanks, nearest_points_are_those_of_one_rank) {
  for (const auto& [n, m] : {std::pair{101, 37}, std::pair{5, 200}, std::pair{2, 1}}) {
    const PointSet a = spiral(n, false), b = spiral(m, true);
    const auto found = nearest(world, a.points, b);
    const auto expected = nearest(MPI_COMM_SELF, a.points, gathered(b));
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(found[i].distance, expected[i].distance);
      EXPECT_EQ((found[i].point - expected[i].point).norm(), 0);
    }
  }
}

TEST(MapsOverRanks, both_kinds_carry_what_one_rank_carries_and_keep_sums) {
  MappingParameters parameters;
  parameters.type = MappingParameters::Type::nearest;
  for (const auto& [n, m] : {std::pair{101, 37}, std::pair{37, 101}, std::pair{1, 8}})
    for (const auto kind : {Mapping::Kind::consistent, Mapping::Kind::conservative}) {
      const PointSet from = spiral(std::max(n, 2), false), to = spiral(m, true);
      std::vector<double> values;
      for (const Vec3& p : from.points) values.insert(values.end(), {p.x() + 1, std::sin(5 * p.z())});
      const Mapping map(world, kind, from, to, parameters);
      const auto carried = all_gather(world, map.apply(values, 2));
      const Mapping alone(MPI_COMM_SELF, kind, gathered(from), gathered(to), parameters);
      const auto expected = alone.apply(all_gather(world, values), 2);
      ASSERT_EQ(carried.size(), expected.size());
      for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_NEAR(carried[i], expected[i], 1e-14);
      if (kind == Mapping::Kind::consistent) continue;
      const auto all = all_gather(world, values);
      EXPECT_NEAR(std::accumulate(carried.begin(), carried.end(), 0.),
                  std::accumulate(all.begin(), all.end(), 0.), 1e-12);
    }
}

TEST(MapsOverRanks, matched_points_find_their_twins_on_any_rank) {
  const PointSet from = spiral(50, false), to = spiral(50, true);
  const Mapping map(world, Mapping::Kind::consistent, from, to, {});
  std::vector<double> z;
  for (const Vec3& p : from.points) z.push_back(p.z());
  const auto carried = map.apply(z, 1);
  for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_EQ(carried[i], to.points[i].z());
}

TEST(Transfers, entries_given_on_any_rank_add_up) {
  const Starts targets = even_starts(10, comm_size(world)), sources = even_starts(7, comm_size(world));
  std::vector<Transfer::Entry> entries;
  // Rank 0 alone knows the matrix: target t = source t mod 7 + twice source 0.
  if (comm_rank(world) == 0)
    for (GlobalIndex t = 0; t < 10; ++t) entries.insert(entries.end(), {{t, t % 7, 1.}, {t, 0, 2.}});
  const Transfer transfer(world, targets, sources, entries);
  std::vector<double> values;
  const auto rank = std::size_t(comm_rank(world));
  for (GlobalIndex s = sources[rank]; s < sources[rank + 1]; ++s) values.push_back(double(s) + 5);
  const auto all = all_gather(world, transfer.apply(values, 1));
  for (int t = 0; t < 10; ++t) EXPECT_EQ(all[std::size_t(t)], t % 7 + 5 + 2 * 5);
}

}  // namespace
}  // namespace couplet
