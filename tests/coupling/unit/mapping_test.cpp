// SPDX-License-Identifier: Apache-2.0
#include "coupler/mapping/mapping.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "common/base/error.hpp"

namespace couplet::mapping_test {
using namespace coupler;
namespace {

using Kind = Mapping::Kind;
using MapType = MappingParameters::Type;

PointSet line(const std::string& what, int n, double y = 0) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.emplace_back(i / double(n - 1), y, 0);
  return {what, points};
}

std::string message(const PointSet& from, const PointSet& to, const MappingParameters& parameters) {
  try {
    const Mapping mapping(Kind::consistent, from, to, parameters);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(MatchedMapping, carries_values_to_their_twins_in_any_order) {
  const PointSet from = line("a", 50);
  PointSet to = from;
  std::shuffle(to.points.begin(), to.points.end(), std::mt19937(5));
  for (const Kind kind : {Kind::consistent, Kind::conservative}) {
    std::vector<double> values;
    for (const Vec3& p : from.points) values.insert(values.end(), {p.x(), -p.x()});
    const std::vector<double> result = Mapping(kind, from, to, {}).apply(values, 2);
    for (std::size_t i = 0; i < to.points.size(); ++i) {
      EXPECT_EQ(result[2 * i], to.points[i].x());
      EXPECT_EQ(result[2 * i + 1], -to.points[i].x());
    }
  }
}

TEST(MatchedMapping, reports_numbers_and_distances) {
  const Mapping mapping(Kind::consistent, line("a", 11), line("b", 11, 1e-9), {});
  EXPECT_NEAR(mapping.max_distance(), 1e-9, 1e-20);
  EXPECT_NEAR(mapping.mean_distance(), 1e-9, 1e-20);
}

TEST(MatchedMapping, names_points_without_a_twin) {
  PointSet to = line("vertices of 'fluid'", 5);
  to.points[3] += Vec3(0.05, 0.02, 0);
  EXPECT_EQ(message(line("vertices of 'solid'", 5), to, {}),
            "1 of 5 vertices of 'fluid' match none of the 5 vertices of 'solid' within 1e-06 m:\n"
            "  (0.8, 0.02, 0): the nearest is 0.0539 m away\n"
            "Give both meshes the same points on the interface, or set `coupling.mapping.type: projection`.");
}

TEST(MatchedMapping, names_points_that_only_the_other_side_lacks) {
  EXPECT_THAT(message(line("vertices of 'solid'", 9), line("vertices of 'fluid'", 5), {}),
              testing::StartsWith("4 of 9 vertices of 'solid' match none of the 5 vertices of 'fluid'"));
}

TEST(MatchedMapping, names_five_points_at_most) {
  EXPECT_THAT(message(line("a", 20), line("b", 20, 0.3), {}), testing::HasSubstr("\n  and 15 more"));
}

TEST(MatchedMapping, obeys_the_tolerance_of_the_user) {
  MappingParameters parameters;
  parameters.tolerance = 0.02;
  EXPECT_EQ(message(line("a", 5), line("b", 5, 0.01), parameters), "");
  parameters.tolerance = 0.005;
  EXPECT_NE(message(line("a", 5), line("b", 5, 0.01), parameters), "");
}

// What is near is a part of the surfaces' size, wherever they lie.
TEST(MatchedMapping, matches_alike_on_every_side_of_the_origin) {
  for (const double along : {-1000., -10., 10.}) {
    const auto moved = [&](const std::string& what, double aside) {
      PointSet set = line(what, 5, aside);
      for (Vec3& p : set.points) p.x() += along;
      return set;
    };
    EXPECT_EQ(message(moved("a", 0), moved("b", 5e-7), {}), "") << along;
    EXPECT_THAT(message(moved("a", 0), moved("b", 2e-6), {}), testing::HasSubstr("within 1e-06 m")) << along;
  }
}

TEST(MatchedMapping, refuses_twins_that_are_not_clear) {
  PointSet from = line("a", 5), to = line("b", 5);
  to.points[2] = to.points[3];
  from.points[2] = from.points[3];
  EXPECT_THAT(message(from, to, {}), testing::HasSubstr("Ambiguous matching"));
}

TEST(Mapping, refuses_an_empty_side) {
  EXPECT_THAT(message(line("vertices of 'solid'", 5), PointSet{"vertices of 'fluid'", {}}, {}),
              testing::StartsWith("There are 5 vertices of 'solid' and 0 vertices of 'fluid'"));
}

TEST(NearestMapping, keeps_a_constant_motion_and_the_sum_of_forces) {
  MappingParameters parameters;
  parameters.type = MapType::nearest;
  const PointSet a = line("a", 17, 0.01), b = line("b", 40);
  const std::vector<double> moved =
      Mapping(Kind::consistent, a, b, parameters).apply(std::vector<double>(17, 2.5), 1);
  EXPECT_THAT(moved, testing::Each(2.5));
  std::vector<double> force(40);
  std::iota(force.begin(), force.end(), 1.);
  const std::vector<double> given = Mapping(Kind::conservative, b, a, parameters).apply(force, 1);
  EXPECT_EQ(given.size(), 17u);
  EXPECT_DOUBLE_EQ(std::accumulate(given.begin(), given.end(), 0.), 40 * 41 / 2);
}

TEST(NearestMapping, shares_a_force_among_the_finer_faces_under_it_by_their_size) {
  MappingParameters parameters;
  parameters.type = MapType::nearest;
  const PointSet coarse{"a", {Vec3(0.5, 0, 0), Vec3(1.5, 0, 0)}, {1, 1}};
  const PointSet fine{"b", {Vec3(0.3, 0, 0), Vec3(0.8, 0, 0), Vec3(1.5, 0, 0)}, {0.6, 0.4, 1}};
  const std::vector<double> given = Mapping(Kind::conservative, coarse, fine, parameters).apply({10, 7}, 1);
  EXPECT_THAT(given, testing::ElementsAre(testing::DoubleEq(6), testing::DoubleEq(4), testing::DoubleEq(7)));
}

}  // namespace
}  // namespace couplet::mapping_test
