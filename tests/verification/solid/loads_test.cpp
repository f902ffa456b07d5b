// SPDX-License-Identifier: Apache-2.0
// Loads by their total: resultant force and moment to round-off on any mesh and any ranks, and what they do to a body.
#include <Eigen/Geometry>

#include "common/mesh/gmsh/gmsh.hpp"
#include "tests/verification/solid/loads_support.hpp"

namespace couplet::testing::loads_test {
using namespace mesh;

using ::testing::AllOf;
using ::testing::HasSubstr;

class Loads : public ::testing::TestWithParam<BoxCells> {
 protected:
  const BoxCells cells = GetParam();
  const int dim = dimension_of(cells);
  const LoadedMesh loaded = distribute(MPI_COMM_WORLD, distorted_box(cells));
  const Mesh& mesh = loaded.mesh;
  const Geometry& geometry = loaded.geometry;
  SolidParameters p = box_parameters(dim);
  const Vec3 force = dim == 3 ? Vec3(3, -2, 5) : Vec3(3, -2, 0);
  const Vec3 point{1.7, -0.4, dim == 3 ? 0.9 : 0};
};
INSTANTIATE_TEST_SUITE_P(Solid, Loads, ::testing::ValuesIn(all_cells),
                         [](const auto& info) { return std::string(name(info.param)); });

TEST_P(Loads, a_total_force_is_the_same_traction_on_all_faces) {
  p.boundaries["xmax"] = with_force(Type::force, force, dim);
  const Resultant found = resultant(mesh, geometry, p);
  const double height = 0.8, depth = dim == 3 ? 0.6 : 1;
  EXPECT_LT((found.force - force).norm(), 1e-12 * force.norm());
  // At the centre of the flat face, and along it everywhere alike.
  const Vec3 centre(1, height / 2, dim == 3 ? depth / 2 : 0);
  EXPECT_LT((found.moment - centre.cross(force)).norm(), 1e-12 * force.norm());
  p.boundaries["xmax"] = boundary(Type::traction, texts(force / (height * depth), dim));
  EXPECT_LT((resultant(mesh, geometry, p).force - found.force).norm(), 1e-12 * force.norm());
}

TEST_P(Loads, a_remote_load_has_its_force_and_its_moment) {
  p.boundaries["xmax"] = with_force(Type::remote_load, force, dim);
  p.boundaries["xmax"].load.point = point;
  const Vec3 moment = dim == 3 ? Vec3(-1, 2, 0.5) : Vec3(0, 0, 0.5);
  for (int a = dim == 3 ? 0 : 2; a < 3; ++a)
    p.boundaries["xmax"].load.moment.push_back({fmt::format("{}*t", moment[a])});
  const Resultant found = resultant(mesh, geometry, p, 2);
  EXPECT_LT((found.force - force).norm(), 1e-12 * force.norm());
  EXPECT_LT((found.moment - point.cross(force) - 2 * moment).norm(), 1e-12 * point.cross(force).norm());
}

TEST_P(Loads, a_point_load_within_a_radius_has_its_force_and_its_moment) {
  PointLoad& load = p.point_loads["pin"];
  static_cast<TotalLoad&>(load) = with_force(Type::remote_load, force, dim).load;
  load.point = {1, 0.4, dim == 3 ? 0.3 : 0};
  load.radius = 0.35;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement);
  const Resultant found = resultant(mesh, geometry, p);
  EXPECT_LT((found.force - force).norm(), 1e-12 * force.norm());
  EXPECT_LT((found.moment - load.point.cross(force)).norm(), 1e-12 * force.norm());
}

TEST_P(Loads, a_point_force_without_a_radius_goes_to_the_nearest_face) {
  PointLoad& load = p.point_loads["pin"];
  static_cast<TotalLoad&>(load) = with_force(Type::remote_load, force, dim).load;
  load.point = {0.52, 0.8, dim == 3 ? 0.31 : 0};
  const Resultant found = resultant(mesh, geometry, p);
  EXPECT_LT((found.force - force).norm(), 1e-12 * force.norm());
  EXPECT_EQ(found.loaded, 1);
}

TEST_P(Loads, a_liquid_presses_with_its_exact_force_wherever_its_surface_cuts_the_faces) {
  for (const double level : {-0.1, 0.0, 0.07, 0.4, 0.63, 0.8, 1.3}) {
    p.boundaries["xmax"] = liquid(1000, 9.81, fmt::format("{}*t", level), dim);
    const double depth = dim == 3 ? 0.6 : 1, wet = std::clamp(level, 0.0, 0.8);
    const double wanted = -9810 * depth * (wet * level - wet * wet / 2);
    const Resultant found = resultant(mesh, geometry, p, 1);
    EXPECT_NEAR(found.force[0], wanted, 1e-12 * 9810) << level;
    EXPECT_LT(std::abs(found.force[1]) + std::abs(found.force[2]), 1e-12 * 9810) << level;
  }
}

TEST(SolidLoads, of_a_liquid_act_at_the_centre_of_pressure) {
  // At a third of the height; the place of a face's own force is its centre: an error of 1 / (2 n^2).
  for (const int n : {8, 16}) {
    SolidParameters p = box_parameters(3);
    p.boundaries["xmin"] = liquid(1000, 10, "3", 3);
    const auto [mesh, geometry] =
        distribute(MPI_COMM_WORLD, make_box(BoxCells::hexahedra, {2, n, 2}, Vec3::Zero(), Vec3(1, 3, 2)));
    const Resultant found = resultant(mesh, geometry, p);
    EXPECT_NEAR(found.force[0], 1000 * 10 * 4.5 * 2, 1e-8);
    EXPECT_NEAR(-found.moment[2] / found.force[0], 1 + 0.5 / (n * n), 1e-12);
    EXPECT_NEAR(found.moment[1] / found.force[0], 1, 1e-12);
  }
}

TEST(SolidLoads, of_a_pin_follow_the_cosine_and_have_its_total) {
  const int n = 24;
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::hexahedra}) {
    const int dim = dimension_of(cells);
    SolidParameters p = box_parameters(dim);
    p.boundaries["ymin"] = with_force(Type::bearing_load, Vec3(0, 700, 0), dim);
    const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, half_ring(cells, n));
    const Resultant found = resultant(mesh, geometry, p);
    EXPECT_LT((found.force - Vec3(0, 700, 0)).norm(), 1e-12 * 700);
    // Equal facets of the half circle: sum sin^2 = n/2.
    const double facet = 2 * std::sin(std::numbers::pi / (2 * n));
    const double highest = 700 / (0.5 * n * facet);
    visit_loads(mesh, geometry, p, [&](Index f, const Vec3& push) {
      const Vec3& centre = geometry.face_centre[f];
      const double pressure = push.norm() / geometry.face_area[f].norm();
      EXPECT_NEAR(pressure, highest * std::sin(std::atan2(centre[1], centre[0])), 1e-9 * highest);
      EXPECT_NEAR(centre.cross(push)[2], 0, 1e-9);
    });
  }
}

TEST(SolidLoads, of_a_pin_in_any_direction_load_one_half_and_keep_the_total) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::tetrahedra, BoxCells::prisms}) {
    const int dim = dimension_of(cells);
    SolidParameters p = box_parameters(dim);
    p.boundaries["ymin"] = with_force(Type::bearing_load, Vec3::Zero(), dim);
    p.boundaries["ymin"].load.force[0].text = "5*cos(t)";
    p.boundaries["ymin"].load.force[1].text = "5*sin(t)";
    const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, half_ring(cells, 23));
    for (const double t : {0.3, 1.0, 1.5, 2.9}) {
      const Vec3 force(5 * std::cos(t), 5 * std::sin(t), 0);
      EXPECT_LT((resultant(mesh, geometry, p, t).force - force).norm(), 1e-11);
      visit_loads(
          mesh, geometry, p,
          [&](Index f, const Vec3& push) {
            EXPECT_LE(push.dot(geometry.face_area[f]), 1e-12);
            EXPECT_GT(geometry.face_centre[f].dot(force), -0.5);
          },
          t);
    }
  }
}

TEST(SolidLoads, at_a_distance_bend_a_cantilever_as_the_theory_of_beams_has_it) {
  // 10 x 1 x 1, force at 4 beyond its end: F L^3/(3 E I) + F a L^2/(2 E I), shear 1.2 F L/(G A).
  SolidParameters p = box_parameters(3);
  p.material = {7800, 200e9, 0};
  p.method.face_gradient = FaceGradient::symmetric;
  p.method.relative_tolerance = 1e-10;
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = with_force(Type::remote_load, Vec3(0, 1e6, 0), 3);
  p.boundaries["xmax"].load.point = {14, 0.5, 0.5};
  const auto solid = stepped(make_box(BoxCells::hexahedra, {20, 4, 2}, Vec3::Zero(), Vec3(10, 1, 1)), p);
  const double EI = 200e9 / 12, wanted = 1e6 * (1000 / (3 * EI) + 4 * 100 / (2 * EI) + 1.2 * 10 / 100e9);
  EXPECT_NEAR(mean_on(*solid, "xmax")[1], wanted, 0.01 * wanted);
  const auto reactions = solid->fields().reactions(solid->fields().point_displacement());
  for (const auto& r : reactions)
    if (r.patch == "xmin") {
      EXPECT_NEAR(r.force[1], -1e6, 1e-3);
    }
}

TEST(SolidLoads, at_large_strain_leave_their_total_to_the_support) {
  SolidParameters p = box_parameters(2);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material.youngs_modulus = 2e7;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = with_force(Type::remote_load, Vec3(0, 1500, 0), 2);
  p.boundaries["xmax"].load.point = {5, 0.5, 0};
  p.boundaries["ymin"] = liquid(1000, 9.81, "1.2", 2);
  const auto solid = stepped(make_box(BoxCells::quadrilaterals, {8, 4, 1}, Vec3::Zero(), Vec3(4, 1, 1)), p);
  const auto reactions = solid->fields().reactions(solid->fields().point_displacement());
  const Vec3 load = solid->fields().total_load();
  for (const auto& r : reactions)
    if (r.patch == "xmin") {
      EXPECT_LT((r.force + load).norm(), 1e-5 * load.norm());
    }
  EXPECT_LT(load[0], -100);  // the liquid follows the surface
}

TEST(SolidLoads, drive_a_free_body_by_their_force) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.method.relative_tolerance = 1e-12;
  p.boundaries["xmax"] = with_force(Type::remote_load, Vec3(0, 7e4, 0), 2);
  p.boundaries["xmax"].load.point = {0.5, 0.5, 0};  // above its centre of mass: no turning
  const auto solid = make_solid(make_box(BoxCells::triangles, {6, 6, 1}, Vec3::Zero(), Vec3::Ones()), p);
  for (int n = 0; n < 20; ++n) step(*solid, 1e-4);
  const Vec3 momentum = momentum_of(*solid);
  EXPECT_NEAR(momentum[1], 7e4 * 2e-3, 1e-7 * 140);
  EXPECT_NEAR(momentum[0], 0, 1e-7 * 140);
}

TEST(SolidLoads, give_the_same_displacement_on_any_number_of_ranks) {
  SolidParameters p = box_parameters(3);
  p.method.relative_tolerance = 1e-13;
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = with_force(Type::remote_load, Vec3(1e6, 2e6, -1e6), 3);
  p.boundaries["xmax"].load.point = {2, 1, 1};
  p.boundaries["zmax"] = liquid(1000, 9.81, "0.7", 3);
  p.point_loads["pin"].force = p.boundaries["xmax"].load.force;
  p.point_loads["pin"].point = {0.5, 0.8, 0.3};
  expect_same_on_ranks(distorted_box(BoxCells::hexahedra), p, 1e-9);
}

/// A mesh of tetrahedra or hexahedra as CalculiX writes it, its sides as surfaces, but "zmax", which is a set of nodes.
std::string deck_of(const RawMesh& raw) {
  std::string text = "*NODE, NSET=Nall\n";
  for (std::size_t p = 0; p < raw.points.size(); ++p)
    text += fmt::format("{},{:.17g},{:.17g},{:.17g}\n", 10 * p + 1, raw.points[p][0], raw.points[p][1],
                        raw.points[p][2]);
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    text += fmt::format("*ELEMENT, TYPE=C3D{}, ELSET=Eall\n{}", raw.cell_points[c].size(), c + 1);
    for (const Index p : raw.cell_points[c]) text += fmt::format(",{}", 10 * p + 1);
    text += "\n";
  }
  for (std::size_t patch = 0; patch < raw.patches.size(); ++patch) {
    text += fmt::format("*{}={}\n", raw.patches[patch] == "zmax" ? "NSET, NSET" : "SURFACE, TYPE=NODE, NAME",
                        raw.patches[patch]);
    for (Index f = 0; f < raw.boundary_points.size(); ++f)
      for (const Index p : raw.boundary_points[f])
        if (raw.boundary_patch[std::size_t(f)] == static_cast<int>(patch))
          text += fmt::format("{}\n", 10 * p + 1);
  }
  return text;
}

TEST(SolidLoads, and_supports_on_a_mesh_of_calculix_reproduce_a_linear_field) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra}) {
    const auto file = std::filesystem::temp_directory_path() /
                      fmt::format("couplet-deck-{}-{}.inp", ::getpid(), parallel::comm_rank(MPI_COMM_WORLD));
    std::ofstream(file) << deck_of(distorted_box(cells));
    const RawMesh raw = read_foreign(file);
    std::filesystem::remove(file);
    const LinearField field = general_field(3);
    SolidParameters p = to_round_off(box_parameters(3), FaceGradient::symmetric);
    for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, field.text(3));
    p.boundaries["zmax"] = boundary(Type::traction, traction_text(p, field, Vec3::UnitZ()));
    const auto solid = stepped(raw, p);
    expect_exact(*solid, field);
  }
}

std::string refusal(const RawMesh& raw, const SolidParameters& p) {
  return support::error_of([&] {
    const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
    resultant(mesh, geometry, p);
  });
}

TEST(SolidLoads, that_cannot_be_are_refused) {
  const RawMesh box = make_box(BoxCells::hexahedra, {4, 3, 1}, Vec3::Zero(), Vec3::Ones());
  SolidParameters p = box_parameters(3);
  p.boundaries["xmax"] = with_force(Type::bearing_load, Vec3(1, 0, 0), 3);
  EXPECT_THAT(refusal(box, p), AllOf(HasSubstr("boundaries.xmax"), HasSubstr("nearly flat")));
  // Two facets whose normals have this mean square across the ridge; 0.04 is asked for.
  for (const double square : {0.03, 0.05}) {
    RawMesh roof = make_box(BoxCells::hexahedra, {2, 2, 1}, Vec3::Zero(), Vec3::Ones());
    for (Vec3& x : roof.points)
      if (x[0] == 1 && x[1] == 0.5) x[0] += 0.5 * std::sqrt(square / (1 - square));
    EXPECT_EQ(refusal(roof, p).find("nearly flat") != std::string::npos, square < 0.04) << square;
  }
  p.boundaries["xmax"] = with_force(Type::remote_load, Vec3(0, 0, 1), 3);
  p.boundaries["xmax"].load.point = {1, 0.2, 0.7};  // one row of faces along y
  EXPECT_EQ(refusal(box, p), "");
  p.boundaries["xmax"].load.force = {{"1"}, {"0"}, {"0"}};
  EXPECT_THAT(refusal(box, p), AllOf(HasSubstr("boundaries.xmax"), HasSubstr("lie on one line")));
  p = box_parameters(3);
  PointLoad& load = p.point_loads["pin"];
  load.force = {{"1"}, {"0"}, {"0"}};
  load.point = {500, 400, 1000};
  EXPECT_THAT(refusal(box, p), AllOf(HasSubstr("point-loads.pin.point"), HasSubstr("off the surface")));
  load.radius = 1;
  EXPECT_THAT(refusal(box, p), AllOf(HasSubstr("point-loads.pin.radius"), HasSubstr("nearest face is")));
  load.radius = 0;
  load.point = {0, 0.5, 0.5};
  EXPECT_EQ(refusal(box, p), "");
  p.boundaries["xmin"] = clamped(3);
  EXPECT_THAT(refusal(box, p), AllOf(HasSubstr("patch 'xmin'"), HasSubstr("is supported")));
  p = box_parameters(3);
  p.boundaries["ymin"] = with_force(Type::bearing_load, Vec3(0, 1, 0.5), 3);
  EXPECT_THAT(refusal(half_ring(BoxCells::hexahedra, 12), p), HasSubstr("along the axis"));
  p.boundaries["ymin"] = with_force(Type::bearing_load, Vec3(0, -1, 0), 3);
  EXPECT_THAT(refusal(half_ring(BoxCells::hexahedra, 12), p), HasSubstr("no half of the cylinder faces"));
}

}  // namespace couplet::testing::loads_test
