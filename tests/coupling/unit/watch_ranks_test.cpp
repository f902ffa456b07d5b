// SPDX-License-Identifier: Apache-2.0
// Integrals over interfaces that a coupling watches, against values by hand, on any number of ranks.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/base/error.hpp"
#include "coupler/output/watch_integrals.hpp"
#include "tests/coupling/support/surfaces.hpp"
#include "tests/support/world.hpp"

namespace couplet::watch_ranks_test {
using namespace coupling;
namespace {

using Place = Interface::Place;

Interface sheet(bool triangles) {
  Interface s = tests::plate(4, triangles, -1);  // (0, 2) x (0, 1), areas down, corners counted the other way
  s.parts = {"near", "far"};
  for (const Vec3& c : s.face_centres) s.face_part.push_back(c.x() < 1 ? 0 : 1);
  s.takes = {{"pressure-force", "N", Place::faces},
             {"heat", "W", Place::faces, 1},
             {"weights", "N", Place::vertices}};
  s.gives = {{"displacement", "m", Place::vertices},
             {"velocity", "m/s", Place::vertices},
             {"temperature", "degC", Place::faces, 1},
             {"five", "1", Place::faces, 5},
             {"mass-flux", "kg/m^2/s", Place::faces}};
  return s;
}

std::vector<double> vectors(const std::vector<Vec3>& points, const std::function<Vec3(const Vec3&)>& of) {
  std::vector<double> values;
  for (const Vec3& p : points) {
    const Vec3 v = of(p);
    values.insert(values.end(), {v.x(), v.y(), v.z()});
  }
  return values;
}

std::vector<double> watch(const Interface& whole,
                          const std::map<std::string, coupler::WatchParameters>& watched,
                          const std::function<void(const Interface&, Exchange&, Exchange&)>& fill) {
  std::vector<coupler::Side> sides;
  sides.emplace_back(world, "sheet", tests::part_of(world, whole));
  const coupler::WatchIntegrals integrals(world, sides, watched);
  Exchange given, taken;
  fill(sides[0].interface, given, taken);
  const auto row = integrals.row({given}, {taken});
  EXPECT_EQ(row.size(), integrals.columns().size());
  return row;
}

TEST(WatchIntegrals, amounts_are_summed_and_scalars_have_integral_and_mean_also_of_a_part) {
  const auto row = watch(sheet(false),
                         {{"a", {"sheet", "heat", ""}},
                          {"b", {"sheet", "heat", "far"}},
                          {"c", {"sheet", "temperature", "near"}},
                          {"d", {"sheet", "pressure-force", ""}},
                          {"e", {"sheet", "weights", ""}}},
                         [](const Interface& i, Exchange& given, Exchange& taken) {
                           for (const Vec3& c : i.face_centres) {
                             taken["heat"].push_back(c.x());
                             given["temperature"].push_back(20 + 10 * c.x());
                           }
                           taken["pressure-force"] =
                               vectors(i.face_centres, [](const Vec3&) { return Vec3(1, 2, 3); });
                           taken["weights"] = vectors(i.vertices, [](const Vec3&) { return Vec3(0, 0, 1); });
                         });
  // 32 faces, 45 vertices: sum of x over 8 columns of 4; those beyond 1; int of 20 + 10 x over the unit square.
  const std::vector<double> expected{32, 24, 25, 25, 32, 64, 96, 0, 0, 45};
  ASSERT_EQ(row.size(), expected.size());
  for (std::size_t k = 0; k < row.size(); ++k) EXPECT_NEAR(row[k], expected[k], 1e-12) << k;
}

TEST(WatchIntegrals, a_flux_goes_through_the_moved_surface) {
  // The sheet is stretched 3 to 1 along x and tilted: (x, y, 0) to (3 x, y, x); its area vector is (1, 0, -3) * 2.
  for (const bool triangles : {false, true}) {
    const auto row =
        watch(sheet(triangles), {{"v", {"sheet", "velocity", ""}}, {"w", {"sheet", "mass-flux", "near"}}},
              [](const Interface& i, Exchange& given, Exchange&) {
                given["displacement"] =
                    vectors(i.vertices, [](const Vec3& x) { return Vec3(2 * x.x(), 0, x.x()); });
                given["velocity"] = vectors(i.vertices, [](const Vec3& x) { return Vec3(x.x(), 0, x.y()); });
                given["mass-flux"] = vectors(i.face_centres, [](const Vec3&) { return Vec3(0, 7, 1); });
              });
    // int of x over (0, 2) x (0, 1) is 2, of -3 y it is -3.
    EXPECT_NEAR(row[0], 2 - 3, 1e-12);
    EXPECT_NEAR(row[1], -3, 1e-12);
  }
  // At rest where no displacement is known.
  const auto still = watch(
      sheet(false), {{"v", {"sheet", "velocity", ""}}}, [](const Interface& i, Exchange& given, Exchange&) {
        given["velocity"] = vectors(i.vertices, [](const Vec3& x) { return Vec3(x.x(), 0, x.y()); });
      });
  EXPECT_NEAR(still[0], -1, 1e-12);
}

TEST(WatchIntegrals, in_the_plane_a_growing_circle_sweeps_its_circumference) {
  constexpr int n = 64;
  Interface ring = tests::ring(n);
  ring.gives = {{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}};
  const auto row =
      watch(ring, {{"v", {"sheet", "velocity", ""}}}, [](const Interface& i, Exchange& given, Exchange&) {
        for (const Vec3& x : i.vertices)
          for (int c = 0; c < 2; ++c)
            given["displacement"].push_back(x[c]), given["velocity"].push_back(x[c]);
      });
  // Radius 2, growing at 1: the polygon's area n R^2 sin(2 pi / n) / 2 changes at that rate.
  EXPECT_NEAR(row[0], n * 2 * std::sin(2 * M_PI / n), 1e-12);
}

TEST(WatchIntegrals, what_has_not_gone_over_yet_is_no_number) {
  const auto row = watch(sheet(false), {{"a", {"sheet", "heat", ""}}, {"v", {"sheet", "velocity", ""}}},
                         [](const Interface&, Exchange&, Exchange&) {});
  EXPECT_TRUE(std::isnan(row[0]) && std::isnan(row[1]));
}

void expect_refused(const Interface& whole, const coupler::WatchParameters& p, const std::string& text) {
  try {
    watch(whole, {{"it", p}}, [](const Interface&, Exchange&, Exchange&) {});
    ADD_FAILURE() << "not refused: " << text;
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
  }
}

TEST(WatchIntegrals, what_is_not_there_is_refused_with_what_is) {
  Interface blind = sheet(false);
  blind.face_offset.clear(), blind.face_vertices.clear();
  expect_refused(sheet(false), {"shet", "heat", ""}, "'shet' is not a participant");
  expect_refused(
      sheet(false), {"sheet", "heath", ""},
      "neither gives nor takes 'heath'. Its data are: displacement, velocity, temperature, five, mass-flux, "
      "pressure-force, heat, weights");
  expect_refused(sheet(false), {"sheet", "heat", "middle"}, "has no part 'middle'. Its parts are: near, far");
  expect_refused(sheet(false), {"sheet", "five", ""}, "has 5 components");
  expect_refused(sheet(false), {"sheet", "weights", "far"}, "is given at vertices, which belong to no part");
  expect_refused(blind, {"sheet", "velocity", ""}, "does not provide the corners of its faces");
}

}  // namespace
}  // namespace couplet::watch_ranks_test
