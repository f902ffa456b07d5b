// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/atmosphere.hpp"

#include "tests/support/test.hpp"

namespace couplet::testing::atmosphere_test {

struct Wetted {
  std::vector<Vec3> area, centre;
};

/// Square plate of n x n faces; its outward normal is -z.
Wetted plate(int n) {
  Wetted faces;
  for (int i = 0; i < n * n; ++i) {
    faces.area.emplace_back(0, 0, -1. / (n * n));
    faces.centre.emplace_back((i % n + 0.5) / n, (i / n + 0.5) / n, 1);
  }
  return faces;
}

/// Cylinder of unit radius: the inside of a tube, or the outside of a rod.
Wetted cylinder(int n, bool is_tube) {
  Wetted faces;
  for (int i = 0; i < 4 * n; ++i) {
    const double angle = 2 * M_PI * (i % n) / n;
    const Vec3 normal(std::cos(angle), std::sin(angle), 0);
    faces.area.emplace_back((is_tube ? -1 : 1) * 2 * M_PI / n * normal);
    faces.centre.emplace_back(normal + Vec3(5, 0, 10 * (i / n)));
  }
  return faces;
}

bool is_told(const Wetted& faces, double pressure, double varies = 0) {
  std::vector<double> force;
  for (std::size_t f = 0; f < faces.area.size(); ++f)
    for (int k = 0; k < 3; ++k)
      force.push_back(-pressure * (1 + varies * faces.centre[f].x()) * faces.area[f][k]);
  return diagnostics::atmosphere_on_one_side(MPI_COMM_SELF, 3, force, faces.area, faces.centre).has_value();
}

TEST(Atmosphere, is_told_where_an_even_pressure_acts_on_one_side) {
  EXPECT_TRUE(is_told(plate(4), 101325));
  EXPECT_TRUE(is_told(plate(4), 1e5));
  EXPECT_TRUE(is_told(cylinder(16, true), 101325));
  EXPECT_FALSE(is_told(cylinder(16, false), 101325)) << "it surrounds the body";
}

TEST(Atmosphere, is_not_told_of_other_loads) {
  EXPECT_FALSE(is_told(plate(4), 5e5)) << "a vessel";
  EXPECT_FALSE(is_told(plate(4), -101325)) << "suction";
  EXPECT_FALSE(is_told(plate(4), 13e3)) << "blood";
  EXPECT_FALSE(is_told(plate(4), 0));
  EXPECT_FALSE(is_told(plate(4), 95e3, 0.1)) << "a flow's pressure";
  EXPECT_FALSE(is_told({}, 101325));
}

}  // namespace couplet::testing::atmosphere_test
