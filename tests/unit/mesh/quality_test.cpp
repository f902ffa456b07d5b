// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/quality.hpp"

#include "support.hpp"

namespace couplet::quality_test {
using namespace mesh;

LoadedMesh square_box() {
  return distribute(MPI_COMM_WORLD,
                    make_box(BoxCells::quadrilaterals, {4, 2, 0}, Vec3::Zero(), Vec3(4, 2, 0)));
}

TEST(Quality, of_squares_is_perfect) {
  const auto [mesh, geometry] = square_box();
  const MeshQuality q = measure_quality(mesh, geometry);
  EXPECT_NEAR(q.min_volume, 1, 1e-14);
  EXPECT_NEAR(q.max_volume, 1, 1e-14);
  EXPECT_NEAR(q.max_non_orthogonality, 0, 1e-6);
  EXPECT_NEAR(q.max_skewness, 0, 1e-14);
}

TEST(Quality, of_sheared_squares_has_the_angle_of_the_shear_and_no_skewness) {
  const auto [mesh, geometry] = square_box();
  std::vector<Vec3> points(geometry.points);
  for (Vec3& x : points) x[0] += 0.5 * x[1];
  const MeshQuality q = measure_quality(mesh, compute_geometry(mesh, points));
  EXPECT_NEAR(q.max_non_orthogonality, std::atan(0.5) * 180 / M_PI, 1e-9);
  EXPECT_NEAR(q.max_skewness, 0, 1e-14);
  EXPECT_NEAR(q.max_volume, 1, 1e-14);
}

TEST(Quality, skewness_is_the_offset_of_the_face_centre_over_the_distance_of_the_cells) {
  // Two trapezoids: the common edge x = 0 from y = 0 to 1, the outer edges twice as long.
  RawMesh raw = make_box(BoxCells::quadrilaterals, {2, 1, 0}, {-1, 0, 0}, {1, 1, 0});
  for (Vec3& x : raw.points)
    if (x[0] != 0 && x[1] > 0) x[1] = 2;
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  // Centroid of the trapezoid with sides 1 (x = 0) and 2 (x = 1): x = 5/9, y = 7/9. The line between the
  // centroids pierces x = 0 at y = 7/9; the edge's centre is at 1/2.
  const MeshQuality q = measure_quality(mesh, geometry);
  EXPECT_NEAR(q.max_skewness, (7.0 / 9 - 0.5) / (10.0 / 9), 1e-14);
}

TEST(Quality, finds_where_a_cell_does_not_lie_behind_its_face) {
  const auto [mesh, geometry] = square_box();
  EXPECT_FALSE(find_fold(mesh, geometry));
  std::vector<Vec3> points(geometry.points);
  for (Vec3& x : points) x[0] += 0.9 * x[1];
  EXPECT_FALSE(find_fold(mesh, compute_geometry(mesh, points))) << "leaning cells are none";
  // A column of cells drawn over its neighbour.
  points = geometry.points;
  for (Vec3& x : points)
    if (x[0] > 1.5 && x[0] < 2.5) x[0] = 3.2;
  const auto fold = find_fold(mesh, compute_geometry(mesh, points));
  ASSERT_TRUE(fold);
  EXPECT_GT(fold->centre.x(), 2.9);
  // Two corners of a boundary face in one place.
  points = geometry.points;
  for (Vec3& x : points)
    if (x[0] < 0.5 && std::abs(x[1] - 1) < 0.1) x[1] = 0;
  ASSERT_TRUE(find_fold(mesh, compute_geometry(mesh, points)));
}

TEST(Quality, says_where_the_worst_of_each_kind_is) {
  const auto [mesh, geometry] = square_box();
  std::vector<Vec3> points(geometry.points);
  for (Vec3& x : points)
    if (x[0] > 3.5) x[0] = 3.1;  // the last column is a tenth as wide
  const MeshQuality q = measure_quality(mesh, compute_geometry(mesh, points));
  EXPECT_NEAR(q.min_volume, 0.1, 1e-14);
  EXPECT_NEAR(q.volume_at.x(), 3.05, 1e-12);
  EXPECT_NEAR(q.max_aspect_ratio, 10, 1e-12);
  EXPECT_NEAR(q.aspect_at.x(), 3.05, 1e-12);
}

TEST(FindCrossed, names_a_quadrilateral_that_crosses_itself_and_not_a_concave_one) {
  const auto [mesh, geometry] = square_box();
  EXPECT_FALSE(find_crossed(mesh, geometry).has_value());
  std::vector<Vec3> concave(geometry.points), crossed(geometry.points);
  for (Vec3& x : concave)
    if ((x - Vec3(1, 1, 0)).norm() < 0.1) x = Vec3(0.4, 0.4, 0);
  EXPECT_FALSE(find_crossed(mesh, compute_geometry(mesh, concave)).has_value());
  for (Vec3& x : crossed)
    if ((x - Vec3(0, 0, 0)).norm() < 0.1) x = Vec3(1.5, 0.8, 0);  // cell 0's corner beyond its right side
  const auto trouble = find_crossed(mesh, compute_geometry(mesh, crossed));
  ASSERT_TRUE(trouble.has_value());
  EXPECT_EQ(trouble->cell_id, 0);
}

TEST(FindCrossed, names_a_hexahedron_with_a_face_that_crosses_itself) {
  RawMesh raw = make_box(BoxCells::hexahedra, {1, 1, 1}, Vec3::Zero(), Vec3::Ones());
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  EXPECT_FALSE(find_crossed(mesh, geometry).has_value());
  std::vector<Vec3> twisted(geometry.points);
  for (Vec3& x : twisted)
    if (x.z() > 0.5 && x.x() > 0.5) x.y() = 1 - x.y();
  EXPECT_TRUE(find_crossed(mesh, compute_geometry(mesh, twisted)).has_value());
}

TEST(FindInverted, is_silent_for_a_good_mesh) {
  const auto [mesh, geometry] = square_box();
  EXPECT_FALSE(find_inverted(mesh, geometry).has_value());
}

TEST(FindInverted, names_the_worst_cell_and_its_place_on_every_rank) {
  const auto [mesh, geometry] = square_box();
  std::vector<Vec3> points(geometry.points);
  // The point (1, 1) far out to the right: cell 1 (and its neighbour above) turn over.
  for (Vec3& x : points)
    if ((x - Vec3(1, 1, 0)).norm() < 0.1) x = Vec3(5, 0.5, 0);
  const auto trouble = find_inverted(mesh, compute_geometry(mesh, points));
  ASSERT_TRUE(trouble.has_value());
  // Cell 1 is (1,0) (2,0) (2,1) (5,0.5): by the shoelace formula its area is (0 + 2 + (1 - 5) - 0.5) / 2.
  EXPECT_EQ(trouble->cell_id, 1);
  EXPECT_NEAR(trouble->volume, -1.25, 1e-14);
  EXPECT_LT((trouble->centre - Vec3(2.5, 0.375, 0)).norm(), 1e-14);
}

TEST(FindInverted, takes_a_volume_that_is_not_a_number_for_the_worst) {
  const auto [mesh, geometry] = square_box();
  Geometry g = geometry;
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    if (mesh.cell_id[c] == 3) g.volume[c] = std::numeric_limits<double>::quiet_NaN();
    if (mesh.cell_id[c] == 6) g.volume[c] = -1;
  }
  const auto trouble = find_inverted(mesh, g);
  ASSERT_TRUE(trouble.has_value());
  EXPECT_EQ(trouble->cell_id, 3);
}

}  // namespace couplet::quality_test
