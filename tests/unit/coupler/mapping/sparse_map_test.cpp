// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <ctime>

#include "coupler/mapping/face_weights.hpp"
#include "coupler/mapping/sparse_map.hpp"
#include "tests/coupling/support/surfaces.hpp"
#include "tests/support/test.hpp"

namespace couplet::map_test {
using namespace coupling;
using namespace coupler;
using Kind = Mapping::Kind;
using Type = MappingParameters::Type;
using tests::faces_of;
using tests::flap;
using tests::plate;
using tests::vertices_of;

MappingParameters of_type(Type type) {
  MappingParameters parameters;
  parameters.type = type;
  return parameters;
}
constexpr Type type = Type::projection;

std::vector<double> linear(const std::vector<Vec3>& points) {
  std::vector<double> values;
  for (const Vec3& p : points) values.insert(values.end(), {1 + 2 * p.x() - 3 * p.y(), p.y() - p.x(), 4.});
  return values;
}

double largest(const std::vector<double>& a, const std::vector<double>& b) {
  double most = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

struct Pair {
  const char* name;
  Interface structure, fluid;
};
std::vector<Pair> pairs() {
  return {{"2:1", flap(20, 4, 1), flap(40, 8, -1)},
          {"1:2", flap(40, 8, 1), flap(20, 4, -1)},
          {"3:1", flap(17, 3, 1), flap(51, 9, -1)},
          {"1:3", flap(51, 9, 1), flap(17, 3, -1)},
          {"shifted", flap(30, 5, 1), flap(30, 5, -1, 0.4)},
          {"plate, 12 to 7", plate(12, false, 1), plate(7, false, -1)},
          {"plate, 7 to 12", plate(7, false, 1), plate(12, false, -1)},
          {"plate, triangles to quadrilaterals", plate(9, true, 1), plate(6, false, -1)},
          {"plate, quadrilaterals to triangles", plate(9, false, 1), plate(5, true, -1)}};
}

TEST(Maps, carry_linear_fields_exactly) {
  double worst = 0;
  for (const Pair& p : pairs()) {
    const Mapping map(Kind::consistent, vertices_of(p.structure), vertices_of(p.fluid), of_type(type));
    const double off = largest(map.apply(linear(p.structure.vertices), 3), linear(p.fluid.vertices));
    EXPECT_LT(off, 1e-12) << p.name;
    const Mapping faces(Kind::consistent, faces_of(p.structure), faces_of(p.fluid), of_type(type));
    EXPECT_LT(largest(faces.apply(linear(p.structure.face_centres), 3), linear(p.fluid.face_centres)), 1e-11)
        << p.name << " at faces";
    worst = std::max(worst, off);
  }
  RecordProperty("linear", fmt::format("{:.1e}", worst));
}

/// A pressure that is different on each face and a shear.
std::vector<double> forces(const Interface& s) {
  std::vector<double> result;
  std::mt19937 engine(4);
  std::uniform_real_distribution<double> random(0.5, 1.5);
  for (const Vec3& area : s.face_areas) {
    const Vec3 f = random(engine) * area + Vec3(0.1, 0.2, 0) * area.norm();
    result.insert(result.end(), f.begin(), f.end());
  }
  return result;
}

Eigen::Matrix<double, 6, 1> force_and_moment(const Interface& s, const std::vector<double>& values) {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t f = 0; f < s.face_centres.size(); ++f) {
    const Vec3 force(values[3 * f], values[3 * f + 1], values[3 * f + 2]);
    sum.head<3>() += force;
    sum.tail<3>() += s.face_centres[f].cross(force);
  }
  return sum;
}

TEST(Maps, keep_force_and_moment) {
  double worst_force = 0, worst_moment = 0;
  for (const Pair& p : pairs()) {
    const Mapping map(Kind::conservative, faces_of(p.fluid), faces_of(p.structure), of_type(type));
    const auto given = force_and_moment(p.fluid, forces(p.fluid));
    const auto taken = force_and_moment(p.structure, map.apply(forces(p.fluid), 3));
    const double force = (taken - given).head<3>().norm() / given.head<3>().norm(),
                 moment = (taken - given).tail<3>().norm() / given.tail<3>().norm();
    EXPECT_LT(force, 1e-12) << p.name;
    EXPECT_LT(moment, 1e-10) << p.name;
    worst_force = std::max(worst_force, force);
    worst_moment = std::max(worst_moment, moment);
  }
  RecordProperty("force", fmt::format("{:.1e}", worst_force));
  RecordProperty("moment", fmt::format("{:.1e}", worst_moment));
}

TEST(Maps, keep_force_and_moment_where_a_side_lists_no_corners) {
  for (Pair& p : pairs()) {
    p.structure.face_offset.clear(), p.structure.face_vertices.clear();
    const Mapping map(Kind::conservative, faces_of(p.fluid), faces_of(p.structure), of_type(type));
    const auto given = force_and_moment(p.fluid, forces(p.fluid));
    const auto taken = force_and_moment(p.structure, map.apply(forces(p.fluid), 3));
    EXPECT_LT((taken - given).head<3>().norm() / given.head<3>().norm(), 1e-12) << p.name;
    EXPECT_LT((taken - given).tail<3>().norm() / given.tail<3>().norm(), 1e-10) << p.name;
  }
}

TEST(Maps, the_nearest_face_does_not_keep_the_moment) {
  const Interface structure = flap(17, 3, 1), fluid = flap(20, 4, -1);
  const Mapping map(Kind::conservative, faces_of(fluid), faces_of(structure), of_type(Type::nearest));
  const auto given = force_and_moment(fluid, forces(fluid)),
             taken = force_and_moment(structure, map.apply(forces(fluid), 3));
  EXPECT_LT((taken - given).head<3>().norm(), 1e-12);
  EXPECT_GT((taken - given).tail<3>().norm(), 1e-4);
}

/// Largest jump of the slope of a smooth motion from face to face of a finer wall.
double roughness(Type type) {
  Interface coarse, fine;
  coarse.dim = fine.dim = 2;
  for (int i = 0; i <= 20; ++i) coarse.vertices.emplace_back(i / 20., 0, 0);
  for (int i = 0; i <= 60; ++i) fine.vertices.emplace_back(i / 60., 0, 0);
  for (Index v = 0; v < 20; ++v) tests::add_face(coarse, {v, v + 1}, Vec3(0, 1 / 20., 0));
  for (Index v = 0; v < 60; ++v) tests::add_face(fine, {v, v + 1}, Vec3(0, -1 / 60., 0));
  std::vector<double> motion;
  for (const Vec3& p : coarse.vertices) motion.push_back(std::sin(2 * std::numbers::pi * p.x()));
  const std::vector<double> moved =
      Mapping(Kind::consistent, vertices_of(coarse), vertices_of(fine), of_type(type)).apply(motion, 1);
  double most = 0;
  for (std::size_t i = 1; i + 1 < moved.size(); ++i)
    most = std::max(most, std::abs(moved[i + 1] - 2 * moved[i] + moved[i - 1]) * 60);
  return most;
}

TEST(Maps, make_no_staircase) {
  const double nearest = roughness(Type::nearest);
  {
    EXPECT_LT(roughness(type), nearest / 4);
    RecordProperty("projection", fmt::format("{:.3f}", roughness(type) / nearest));
  }
}

TEST(Maps, a_smooth_load_stays_smooth_on_a_finer_wall) {
  // A constant pressure on coarse faces: every finer face takes its share, none goes without.
  const Interface structure = flap(60, 9, 1), fluid = flap(20, 3, -1);
  std::vector<double> pressure;
  for (const Vec3& area : fluid.face_areas) pressure.insert(pressure.end(), area.begin(), area.end());
  {
    const Mapping map(Kind::conservative, faces_of(fluid), faces_of(structure), of_type(type));
    const std::vector<double> taken = map.apply(pressure, 3);
    double worst = 0;
    for (int f = 3; f < 57; ++f) {
      const Vec3 wanted = -structure.face_areas[f];
      worst = std::max(
          worst, (Vec3(taken[3 * f], taken[3 * f + 1], taken[3 * f + 2]) - wanted).norm() / wanted.norm());
    }
    EXPECT_LT(worst, 0.05);
    RecordProperty("uneven_projection", fmt::format("{:.1e}", worst));
  }
}

TEST(Maps, work_without_corners_where_they_need_none) {
  Interface structure = flap(20, 4, 1);
  const Interface fluid = flap(33, 5, -1);
  structure.face_offset.clear(), structure.face_vertices.clear();
  const Mapping map(Kind::consistent, vertices_of(structure), vertices_of(fluid), of_type(type));
  EXPECT_LT(largest(map.apply(linear(structure.vertices), 3), linear(fluid.vertices)), 1e-12);
}

TEST(Maps, projection_lands_on_the_nearest_face_and_ends_at_the_edge) {
  const Interface s = plate(4, true, 1);
  const PointSet to = whole_set({"points", {Vec3(0.3, 0.4, 0.2), Vec3(-0.5, 0.5, 0)}});
  const Mapping map(Kind::consistent, vertices_of(s), to, of_type(Type::projection));
  EXPECT_LT(largest(map.apply(linear(s.vertices), 3), linear({Vec3(0.3, 0.4, 0), Vec3(0, 0.5, 0)})), 1e-13);
}

TEST(LocalWeights, take_points_in_any_position) {
  const std::vector<Vec3> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
      twice{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}}, one_place{{1, 1, 1}, {1, 1, 1}};
  const auto value = [](const std::vector<Vec3>& points, const Vec3& x) {
    std::vector<Index> all(points.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = Index(i);
    const std::vector<double> w = local_weights(points, all, x);
    double sum = 0, field = 0;
    for (std::size_t i = 0; i < w.size(); ++i) sum += w[i], field += w[i] * points[i].x();
    EXPECT_NEAR(sum, 1, 1e-12);
    return field;
  };
  EXPECT_NEAR(value(line, {0.7, 0, 0}), 0.7, 1e-12);
  EXPECT_NEAR(value(line, {0.7, 5, 0}), 0.7, 1e-12) << "beside the line: its foot";
  EXPECT_NEAR(value(line, {2.5, 0, 0}), 2.5, 1e-12) << "beyond its end: linear";
  EXPECT_NEAR(value(twice, {0.7, 0, 0}), 0.7, 1e-10);
  EXPECT_NEAR(value(one_place, {0, 0, 0}), 1, 1e-12);
}

TEST(Corners, are_checked) {
  const auto problem = [](const Interface& s) -> std::string {
    return support::error_of([&] { check_corners(s, "wall", GlobalIndex(s.vertices.size())); });
  };
  const Interface good = flap(4, 2, 1);
  EXPECT_EQ(problem(good), "");
  EXPECT_EQ(problem(Interface{}), "");
  Interface bad = good;
  bad.face_offset.pop_back();
  EXPECT_THAT(problem(bad), testing::HasSubstr("10 offsets for 10 faces"));
  bad = good;
  bad.face_vertices[3] = 11;
  EXPECT_EQ(problem(bad), "The face corners of 'wall' are invalid: vertex 11 is not one of its 11.");
  bad = good;
  bad.face_offset[3] = bad.face_offset[2];
  EXPECT_THAT(problem(bad), testing::HasSubstr("face 2 has fewer than two corners"));
  bad = good;
  bad.face_vertices.pop_back();
  EXPECT_THAT(problem(bad), testing::HasSubstr("do not run from 0"));
}

TEST(Maps, are_set_up_in_n_log_n) {
  // Seconds of cpu for 1e5 vertices, motion and load: read by scripts/validate, judged nowhere else.
  const Interface structure = plate(223, false, 1), fluid = plate(200, true, -1);
  for (const Type type : {Type::nearest, Type::projection}) {
    const std::clock_t start = std::clock();
    const Mapping motion(Kind::consistent, vertices_of(structure), vertices_of(fluid), of_type(type));
    const Mapping load(Kind::conservative, faces_of(fluid), faces_of(structure), of_type(type));
    EXPECT_EQ(motion.n_from(), structure.vertices.size());
    EXPECT_EQ(load.n_to(), structure.face_centres.size());
    RecordProperty(fmt::format("setup_{}", int(type)),
                   fmt::format("{:.2f}", double(std::clock() - start) / CLOCKS_PER_SEC));
  }
}

// The weights of corners keep the moment of a force at a face's centre, wherever in the face that is.

TEST(CornerWeights, meet_the_centre_of_a_face_that_is_no_parallelogram) {
  coupling::Interface s;
  s.vertices = {{0, 0, 0}, {4, 0, 0}, {1.5, 2, 0}, {0.5, 2, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  s.face_offset = {0, 4, 7};
  s.face_vertices = {0, 1, 2, 3, 4, 5, 6};
  // The centroid of the trapezoid is not the mean of its corners, and some participants say yet another place.
  const Vec3 corners_mean(1.5, 1, 0);
  for (const Vec3& centre : {Vec3(1.7, 0.8, 0), Vec3(1.6, 0.9, 0), corners_mean}) {
    s.face_centres = {centre, {0.3, 0.4, 1}};
    for (Index f = 0; f < 2; ++f) {
      const std::vector<double> weights = coupler::corner_weights(s, f);
      const auto vertex = coupler::corners(s, f);
      Vec3 met = Vec3::Zero();
      double sum = 0;
      for (std::size_t i = 0; i < weights.size(); ++i)
        met += weights[i] * s.vertices[vertex[i]], sum += weights[i];
      EXPECT_NEAR(sum, 1, 1e-13);
      EXPECT_LT((met - s.face_centres[std::size_t(f)]).norm(), 1e-13);
    }
  }
}

// Over the triangles about the mean (3/2, 3/4) of the corners, whose areas are as 6, 7, 4 and 3: a third of both
// triangles at a corner and 1/12 of all.
TEST(CornerWeights, are_those_of_the_triangles_about_the_mean_of_the_corners) {
  coupling::Interface s;
  s.vertices = {{0, 0, 0}, {4, 0, 0}, {2, 2, 0}, {0, 1, 0}};
  s.face_offset = {0, 4};
  s.face_vertices = {0, 1, 2, 3};
  s.face_centres = {{26. / 15, 11. / 15, 0}};
  const std::vector<double> weights = coupler::corner_weights(s, 0);
  const double wanted[] = {14. / 60, 18. / 60, 16. / 60, 12. / 60};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(weights[std::size_t(i)], wanted[i], 1e-13) << i;
}

// What the faces of the other side cover of a face, and who gets what none covers.

/// A face looks up; those of the other side, which look down, cover it up to x = 0.4.
double length_given(const coupling::Interface& other) {
  coupling::Interface edge;
  edge.dim = 2;
  edge.vertices = {{0, 0, 0}, {1, 0, 0}};
  edge.face_centres = {{0.5, 0, 0}}, edge.face_areas = {{0, 1, 0}};
  edge.face_offset = {0, 2}, edge.face_vertices = {0, 1};
  std::vector<Index> all(other.face_centres.size());
  std::iota(all.begin(), all.end(), Index(0));
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (const coupler::Cover& c : coupler::covers(edge, 0, other, all)) products += c.products;
  // The samples stand for what they lie in: the mass matrix of an edge nearly, its sum exactly.
  EXPECT_NEAR(products(0, 0), 1. / 3, 0.05);
  EXPECT_NEAR(products(1, 1), 1. / 3, 0.05);
  return products.sum();
}

TEST(Overlay, a_part_of_an_edge_that_nothing_covers_goes_to_the_nearest_in_full) {
  coupling::Interface other;
  other.dim = 2;
  other.vertices = {{0, 0, 0}, {0.4, 0, 0}};
  other.face_centres = {{0.2, 0, 0}}, other.face_areas = {{0, -0.4, 0}};
  other.face_offset = {0, 2}, other.face_vertices = {0, 1};
  EXPECT_NEAR(length_given(other), 1, 1e-12);
}

TEST(Overlay, a_part_of_a_face_that_nothing_covers_goes_to_the_nearest_in_full) {
  coupling::Interface face, other;
  face.dim = other.dim = 3;
  face.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  face.face_centres = {{0.5, 0.5, 0}}, face.face_areas = {{0, 0, 1}};
  face.face_offset = {0, 4}, face.face_vertices = {0, 1, 2, 3};
  other.vertices = {{0, 0, 0}, {0.4, 0, 0}, {0.4, 1, 0}, {0, 1, 0}};
  other.face_centres = {{0.2, 0.5, 0}}, other.face_areas = {{0, 0, -0.4}};
  other.face_offset = {0, 4}, other.face_vertices = {0, 3, 2, 1};
  const std::vector<coupler::Cover> part = coupler::covers(face, 0, other, {0});
  ASSERT_EQ(part.size(), 1);
  EXPECT_NEAR(part[0].products.sum(), 1, 1e-12);
}

}  // namespace couplet::map_test
