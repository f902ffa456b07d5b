// SPDX-License-Identifier: Apache-2.0
// Conduction and prescribed motion by themselves, against what is known in closed form.
#include "common/fv/conduction.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::operators_test {
using namespace fv;
using namespace mesh;

class Conduction : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Cells, Conduction,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

TEST_P(Conduction, gradients_values_and_heat_of_a_linear_temperature_are_exact_at_every_face) {
  RawMesh raw = make_box(GetParam(), {4, 3, 3}, Vec3::Zero(), Vec3(1, 0.7, 0.4));
  perturb_interior(raw, 0.25, 7);
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  const ConductionOperator conduction(
      mesh, geometry, std::vector<HeatCondition>(mesh.patches.size(), HeatCondition::temperature));
  const Vec3 slope(2, -3, mesh.dim == 3 ? 5 : 0);
  const auto at = [&](const Vec3& x) { return 1 + slope.dot(x); };
  std::vector<double> cells, boundary, points, conductivity(std::size_t(mesh.n_faces()), 1.5),
      heat(std::size_t(mesh.n_flux_faces()));
  for (const Vec3& x : geometry.cell_centre) cells.push_back(at(x));
  for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) boundary.push_back(at(geometry.face_centre[f]));
  for (const Vec3& x : geometry.points) points.push_back(at(x));
  conduction.face_heat(conductivity, cells, boundary, points, heat);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    EXPECT_LT((conduction.gradient(f, cells, boundary, points) - slope).norm(), 1e-10);
    EXPECT_NEAR(conduction.face_value(f, cells, boundary, points), at(geometry.face_centre[f]), 1e-11);
    EXPECT_NEAR(heat[std::size_t(f)], 1.5 * slope.dot(geometry.face_area[f]), 1e-11);
  }
}

MotionParameters moving(const std::string& x, const std::string& y, const std::string& angle = "0") {
  MotionParameters m;
  m.translation = {{x}, {y}};
  m.angle = {angle};
  m.centre = Vec3(0.3, 0.2, 0);
  return m;
}
const std::vector<Vec3> places{{0.3, 0.2, 0}, {0.8, 0.2, 0}, {0.3, 1.7, 0}};

TEST(PrescribedMotion, velocities_of_parabolas_are_exact) {
  const PrescribedMotion motion(moving("0.5*t^2 - t", "3*t"), 2);
  for (const Vec3& v : motion.velocities(places, 2, 0.1)) EXPECT_LT((v - Vec3(1, 3, 0)).norm(), 1e-7);
}

TEST(PrescribedMotion, velocities_of_a_turn_are_those_of_a_rigid_body) {
  const PrescribedMotion motion(moving("0", "0", "1.5*t"), 2);
  const std::vector<Vec3> now = motion.places(places, 0.4), v = motion.velocities(places, 0.4, 0.1);
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_LT((v[i] - Vec3(0, 0, 1.5).cross(now[i] - Vec3(0.3, 0.2, 0))).norm(), 1e-6);
}

TEST(PrescribedMotion, begins_with_the_velocity_that_it_has_at_once_and_from_rest_with_none) {
  const PrescribedMotion at_once(moving("0.7*t + 2*t^2", "sin(3*t)"), 2),
      from_rest(moving("2*t^2", "t^3"), 2);
  for (const Vec3& v : at_once.starting_velocities(places, 0, 1))
    EXPECT_LT((v - Vec3(0.7, 3, 0)).norm(), 1e-4);
  for (const Vec3& v : from_rest.starting_velocities(places, 0, 1)) EXPECT_EQ(v.norm(), 0);
}

// 1 - 10 q^3 + 15 q^4 - 6 q^5 with q = 0 at the inner radius and 1 at the outer one.
TEST(PrescribedMotion, fades_between_its_radii) {
  MotionParameters m = moving("1", "0");
  m.inner_radius = 0.2;
  m.outer_radius = 0.6;
  const PrescribedMotion motion(m, 2);
  const auto share = [&](double radius) {
    const std::vector<Vec3> x{m.centre + radius * Vec3(std::cos(1.), std::sin(1.), 0)};
    return (motion.places(x, 0)[0] - x[0]).x();
  };
  EXPECT_NEAR(share(0.1), 1, 1e-14);
  EXPECT_NEAR(share(0.2), 1, 1e-14);
  EXPECT_NEAR(share(0.3), 1 - 10. / 64 + 15. / 256 - 6. / 1024, 1e-13);
  EXPECT_NEAR(share(0.4), 0.5, 1e-13);
  EXPECT_NEAR(share(0.5), 10. / 64 - 15. / 256 + 6. / 1024, 1e-13);
  EXPECT_NEAR(share(0.7), 0, 1e-14);
  EXPECT_NEAR(motion.largest_displacement(places, 0), 1, 1e-14);
}

}  // namespace couplet::operators_test
