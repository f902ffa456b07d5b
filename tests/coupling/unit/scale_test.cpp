// SPDX-License-Identifier: Apache-2.0
// Set-up of a large interface is linear in its size. Times are recorded, not judged.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>

#include "common/base/error.hpp"
#include "coupler/mapping/surface_checks.hpp"
#include "coupler/output/mechanics.hpp"

namespace couplet::scale_test {
using namespace coupling;
using namespace coupler;
namespace {

using Place = Interface::Place;
const std::vector<Interface::Datum> motion{{"displacement", "m", Place::vertices},
                                           {"velocity", "m/s", Place::vertices}};
const std::vector<Interface::Datum> load{{"pressure-force", "N", Place::faces}};

/// A wavy sheet of n x n quadrilaterals.
Interface sheet(int n, bool fluid) {
  Interface i{3, {}, {}, {}, fluid ? motion : load, fluid ? load : motion};
  const auto at = [n](double a, double b) { return Vec3(a / n, b / n, 0.1 * std::sin(6 * a / n)); };
  for (int a = 0; a <= n; ++a)
    for (int b = 0; b <= n; ++b) i.vertices.push_back(at(a, b));
  i.face_offset = {0};
  for (Index a = 0; a < n; ++a)
    for (Index b = 0; b < n; ++b) {
      i.face_centres.push_back((at(a, b) + at(a + 1, b) + at(a, b + 1) + at(a + 1, b + 1)) / 4);
      i.face_areas.emplace_back(0, 0, 1. / n / n);
      const Index v = a * (n + 1) + b;
      i.face_vertices.insert(i.face_vertices.end(), {v, v + 1, v + n + 2, v + n + 1});
      i.face_offset.push_back(Index(i.face_vertices.size()));
    }
  return i;
}

double setup_seconds(int n, double* exchange = nullptr) {
  const std::vector<Side> sides{{MPI_COMM_SELF, "fluid", sheet(n, true)},
                                {MPI_COMM_SELF, "solid", sheet(n, false)}};
  MappingParameters nearest_map;
  nearest_map.type = MappingParameters::Type::nearest;
  const std::clock_t start = std::clock();
  const Links links(MPI_COMM_SELF, sides, nearest_map);
  check_places(MPI_COMM_SELF, sides, links, nearest_map);
  Mechanics mechanics(MPI_COMM_SELF, sides, links, {"fluid", "solid"});
  const double seconds = double(std::clock() - start) / CLOCKS_PER_SEC;
  const std::size_t values = 3 * sides[1].interface.vertices.size();
  const std::vector<Exchange> given{
      {}, {{"displacement", std::vector<double>(values, 1.)}, {"velocity", std::vector<double>(values, 1.)}}};
  const std::clock_t exchange_start = std::clock();
  EXPECT_EQ(links.input(0, given).at("velocity"), std::vector<double>(values, 1.));
  if (exchange) *exchange = double(std::clock() - exchange_start) / CLOCKS_PER_SEC / 2;
  return seconds;
}

TEST(Scale, set_up_of_a_large_interface_grows_with_its_size_alone) {
  double exchange = 0;
  const double small = setup_seconds(100), large = setup_seconds(316, &exchange);
  // Ten times the vertices: a quadratic set-up would take a hundred times as long.
  EXPECT_LT(large, 40 * small + 0.1);
  RecordProperty("setup_seconds_1e5", fmt::format("{:.3f}", large));
  RecordProperty("map_milliseconds_1e5", fmt::format("{:.3f}", 1e3 * exchange));
}

}  // namespace
}  // namespace couplet::scale_test
