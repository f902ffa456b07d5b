// SPDX-License-Identifier: Apache-2.0
// Pressure and temperature taken at an interface patch: a box that expands and is pressed, whose displacement
// is linear in space and therefore exact.
#include "solid_solver/thermal/temperature_field.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::interface_data_test {
using namespace coupling;

using namespace solid;

using testing::boundary;
using Type = SolidBoundary::Type;

SolidParameters pressed_box() {
  SolidParameters p = testing::box_parameters(3);
  for (const char* name : {"xmin", "ymin", "zmin"}) p.boundaries[name] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::interface_);
  p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
  p.expansion.emplace();
  p.expansion->reference_temperature = 300;
  p.interface_data.emplace();
  p.interface_data->load = InterfaceData::Load::pressure;
  p.interface_data->temperature = true;
  return p;
}

mesh::RawMesh raw_box() {
  return mesh::make_box(mesh::BoxCells::hexahedra, {4, 3, 2}, Vec3::Zero(), Vec3(2, 1, 0.5));
}

Exchange given(const Interface& interface, double pressure, double temperature) {
  const std::size_t n = interface.face_centres.size();
  if (n == 0) return {};
  return {{"pressure", std::vector<double>(n, pressure)},
          {"temperature", std::vector<double>(n, temperature)}};
}

void take(Solid& solid, const Exchange& in) {
  solid.begin_step({solid.stepper().state().time, 1, Scheme::explicit_, solid.stepper().state().steps});
  solid.solve(in);
  solid.accept_step();
}

double largest_error(const Solid& solid, double pressure, double warmer) {
  const double e = solid.body().parameters().material.youngs_modulus,
               nu = solid.body().parameters().material.poissons_ratio;
  const Vec3 strain(1.2e-5 * warmer - pressure / e, 1.2e-5 * warmer + nu * pressure / e,
                    1.2e-5 * warmer + nu * pressure / e);
  const std::vector<double> u = solid.fields().point_displacement();
  double worst = 0;
  for (std::size_t v = 0; v < u.size() / 3; ++v)
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(u[3 * v + c] - strain[c] * solid.body().geometry().points[v][c]));
  return parallel::max(solid.body().mesh().comm, worst) / 1e-3;
}

TEST(InterfaceData, pressure_and_temperature_deform_a_box_as_they_must) {
  const auto solid = testing::make_solid(raw_box(), pressed_box());
  const Interface interface = solid->initialise();
  ASSERT_EQ(interface.takes.size(), 2u);
  EXPECT_EQ(interface.takes[0].name, "pressure");
  EXPECT_EQ(interface.takes[1].name, "temperature");
  take(*solid, given(interface, 5e7, 350));
  EXPECT_LT(largest_error(*solid, 5e7, 50), 1e-9);
  take(*solid, given(interface, -2e7, 280));
  EXPECT_LT(largest_error(*solid, -2e7, -20), 1e-9);
}

TEST(InterfaceData, before_anything_is_given_the_solid_has_its_reference_temperature) {
  const auto solid = testing::make_solid(raw_box(), pressed_box());
  solid->initialise();
  take(*solid, {});
  EXPECT_LT(largest_error(*solid, 0, 0), 1e-12);
}

TEST(InterfaceData, a_step_that_is_solved_again_forgets_what_was_tried) {
  const auto solid = testing::make_solid(raw_box(), pressed_box());
  const Interface interface = solid->initialise();
  take(*solid, given(interface, 1e7, 320));
  solid->begin_step({1, 1, Scheme::explicit_, 1});
  solid->solve(given(interface, 9e7, 900));
  take(*solid, given(interface, 2e7, 330));
  EXPECT_LT(largest_error(*solid, 2e7, 30), 1e-9);
}

TEST(InterfaceData, stress_of_free_expansion_is_zero) {
  const auto solid = testing::make_solid(raw_box(), pressed_box());
  const Interface interface = solid->initialise();
  take(*solid, given(interface, 0, 400));
  double worst = 0;
  for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
    worst = std::max(worst, s.norm());
  EXPECT_LT(worst, 1e-3 * 200e9 * 1.2e-5 * 100 * 1e-6);
}

TEST(FaceInterpolation, is_exact_for_a_linear_temperature_along_a_strip) {
  // Faces along the height of a wall, one wide, sections of changing height; points between them, at their
  // edges and behind them in the wall.
  std::vector<Vec3> faces;
  std::vector<double> values;
  for (int k = 0; k < 10; ++k) faces.emplace_back(9.1, 0, 0.05 * k * (1 + 0.1 * k));
  for (const Vec3& f : faces) values.push_back(400 + 150 * f.z());
  std::vector<Vec3> points;
  for (double z = 0; z < faces.back().z(); z += 0.013)
    for (const double r : {9.1, 9.12}) points.emplace_back(r, 0.001, z);
  const FaceInterpolation at(faces, points);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(at.value(i, values), 400 + 150 * points[i].z(), 1e-9) << "z = " << points[i].z();
}

TEST(FaceInterpolation, is_exact_for_a_linear_temperature_on_a_plane) {
  std::vector<Vec3> faces, points;
  std::vector<double> values;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 5; ++j) faces.emplace_back(0.5, 0.1 * i, 0.08 * j);
  const auto linear = [](const Vec3& x) { return 300 + 70 * x.y() - 40 * x.z(); };
  for (const Vec3& f : faces) values.push_back(linear(f));
  for (double y = 0.06; y < 0.44; y += 0.03)
    for (double z = 0.05; z < 0.27; z += 0.03) points.emplace_back(0.4, y, z);
  const FaceInterpolation at(faces, points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(at.value(i, values), linear(points[i]), 1e-9);
}

TEST(FaceInterpolation, stays_within_its_faces) {
  std::vector<Vec3> faces, points;
  std::vector<double> values;
  for (int k = 0; k < 10; ++k) faces.emplace_back(1, 0, k), values.push_back(k < 5 ? 300 : 400);
  for (double z = -2; z < 12; z += 0.1) points.emplace_back(1, 0, z);
  const FaceInterpolation at(faces, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_GE(at.value(i, values), 300);
    EXPECT_LE(at.value(i, values), 400);
  }
  const FaceInterpolation one(std::vector<Vec3>{Vec3(0, 0, 0)}, points);
  EXPECT_EQ(one.value(3, std::vector<double>{351}), 351);
}

TEST(InterfaceTemperature, a_rank_holds_its_own_faces_and_those_that_its_places_need) {
  // A strip of faces that the ranks share, with places a little beyond the ends of each part.
  constexpr int faces_a_rank = 40;
  const int begin = faces_a_rank * parallel::comm_rank(MPI_COMM_WORLD),
            ranks = parallel::comm_size(MPI_COMM_WORLD);
  std::vector<Vec3> faces, places;
  std::vector<double> here;
  for (int k = begin; k < begin + faces_a_rank; ++k) faces.emplace_back(1, 0, k), here.push_back(300 + 2 * k);
  for (int k = begin - 1; k <= begin + faces_a_rank; ++k) places.emplace_back(0.9, 0, k + 0.3);
  const InterfaceTemperature temperature(MPI_COMM_WORLD, faces, {places, faces});
  const std::vector<double> held = temperature.with_others(here);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double z = std::clamp<double>(places[i].z(), 0, faces_a_rank * ranks - 1);  // held within its faces
    EXPECT_NEAR(temperature.at(0).value(i, held), 300 + 2 * z, 1e-9) << "z = " << z;
  }
  EXPECT_GE(held.size(), std::size_t(faces_a_rank));
  EXPECT_LE(held.size(), std::size_t(faces_a_rank) + 16);
  EXPECT_TRUE(temperature.with_others({}).empty());
  if (begin == 0) here.pop_back();
  EXPECT_THROW(temperature.with_others(here), Error);  // on all ranks
}

TEST(InterfaceData, the_solid_has_the_given_temperature_along_the_interface) {
  // Linear along y on the face x = max; the points at the edges between faces, too. With the nearest face's
  // value they would be off by half a cell, 40/3/2 K.
  const auto solid = testing::make_solid(raw_box(), pressed_box());
  const Interface interface = solid->initialise();
  Exchange in = given(interface, 0, 300);
  for (std::size_t f = 0; f < interface.face_centres.size(); ++f)
    in["temperature"][f] = 300 + 40 * interface.face_centres[f].y();
  take(*solid, in);
  int found = 0;
  const std::vector<double> points = solid->body().temperature()->of_points();
  const auto& places = solid->body().geometry().points;
  for (std::size_t v = 0; v < points.size(); ++v, ++found)
    if (places[v].y() > 0.2 && places[v].y() < 0.8) {
      EXPECT_NEAR(points[v], 300 + 40 * places[v].y(), 1e-9);
    }
  EXPECT_GT(found, 0);
}

}  // namespace couplet::interface_data_test
