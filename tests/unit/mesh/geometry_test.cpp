// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/load.hpp"
#include "support.hpp"

namespace couplet::geometry_test {
using namespace mesh;

class GeometryOf : public ::testing::TestWithParam<test::Box> {
 protected:
  RawMesh raw = test::distorted_box(GetParam().cells);
  const LoadedMesh loaded = distribute(MPI_COMM_WORLD, raw);
  const Mesh& mesh = loaded.mesh;
  const Geometry& geometry = loaded.geometry;
};

INSTANTIATE_TEST_SUITE_P(Boxes, GeometryOf, ::testing::ValuesIn(test::boxes()),
                         [](const auto& info) { return info.param.name; });

/// Sum over the faces of each owned cell, with the sign that makes the face look outwards.
template <class T>
std::vector<T> outward_sums(const Mesh& mesh, const std::vector<T>& per_face, const T& zero) {
  std::vector<T> sums(mesh.cells.n_local(), zero);
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    sums[mesh.owner[f]] += per_face[f];
    if (f < mesh.n_interior) sums[mesh.neighbour[f]] -= per_face[f];
  }
  sums.resize(mesh.cells.n_owned(), zero);
  return sums;
}

/// The same random displacement of a point on every rank.
std::vector<Vec3> shaken(const Mesh& mesh, const Geometry& geometry, double amount, unsigned seed) {
  std::vector<Vec3> moved(geometry.points);
  for (std::size_t p = 0; p < moved.size(); ++p) {
    std::mt19937 random(seed + 1000 * unsigned(mesh.point_id[p]));
    for (int axis = 0; axis < mesh.dim; ++axis)
      moved[p][axis] += amount * (random() / double(random.max()) - 0.5);
  }
  return moved;
}

TEST_P(GeometryOf, cells_are_closed) {
  const auto points = shaken(mesh, geometry, 0.1, 3);
  const Geometry g = compute_geometry(mesh, points);
  for (const Vec3& s : outward_sums<Vec3>(mesh, g.face_area, Vec3::Zero())) EXPECT_LT(s.norm(), 1e-14);
}

TEST_P(GeometryOf, volumes_are_positive_and_add_up) {
  double total = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    EXPECT_GT(geometry.volume[c], 0);
    total += geometry.volume[c];
  }
  const double exact = test::box_volume(mesh.dim);
  EXPECT_NEAR(parallel::sum(mesh.comm, total), exact, 1e-13 * exact);
}

TEST_P(GeometryOf, first_moments_add_up_to_those_of_the_box) {
  Vec3 moment = Vec3::Zero();
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) moment += geometry.volume[c] * geometry.cell_centre[c];
  const Vec3 exact = test::box_volume(mesh.dim) * 0.5 * (test::lower + test::upper);
  for (int axis = 0; axis < mesh.dim; ++axis)
    EXPECT_NEAR(parallel::sum(mesh.comm, moment[axis]), exact[axis], 1e-12);
}

TEST_P(GeometryOf, face_vectors_point_out_of_the_owner) {
  for (Index f = 0; f < mesh.n_faces(); ++f) {
    const Vec3 out = geometry.face_centre[f] - geometry.cell_centre[mesh.owner[f]];
    EXPECT_GT(out.dot(geometry.face_area[f]), 0);
  }
}

TEST_P(GeometryOf, does_not_depend_on_the_partition) {
  const auto [whole, there] = distribute(MPI_COMM_SELF, raw);
  std::vector<Index> cell_of(whole.cell_id.size()), face_of(whole.boundary_id.size());
  for (std::size_t c = 0; c < cell_of.size(); ++c) cell_of[whole.cell_id[c]] = Index(c);
  for (std::size_t b = 0; b < face_of.size(); ++b)
    face_of[whole.boundary_id[b]] = whole.n_interior + Index(b);
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const Index w = cell_of[mesh.cell_id[c]];
    EXPECT_NEAR(geometry.volume[c], there.volume[w], 1e-15);
    EXPECT_LT((geometry.cell_centre[c] - there.cell_centre[w]).norm(), 1e-14);
  }
  for (Index b = 0; b < mesh.boundary.n_local(); ++b) {
    const Index f = mesh.n_interior + b, w = face_of[mesh.boundary_id[b]];
    EXPECT_EQ(geometry.face_area[f], there.face_area[w]);
    EXPECT_EQ(geometry.face_centre[f], there.face_centre[w]);
  }
}

TEST_P(GeometryOf, swept_volumes_add_up_to_the_change_of_volume) {
  const auto from = shaken(mesh, geometry, 0.15, 11), to = shaken(mesh, geometry, 0.15, 12);
  const Geometry before = compute_geometry(mesh, from), after = compute_geometry(mesh, to);
  const auto change = outward_sums(mesh, swept_volumes(mesh, from, to), 0.0);
  double largest = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double expected = after.volume[c] - before.volume[c];
    largest = std::max(largest, std::abs(expected));
    EXPECT_NEAR(change[c], expected, 1e-14);
  }
  EXPECT_GT(largest, 1e-4) << "the motion should change volumes";
}

TEST_P(GeometryOf, translation_sweeps_face_vector_times_distance) {
  const Vec3 d(0.3, -0.2, mesh.dim == 3 ? 0.7 : 0);
  std::vector<Vec3> to(geometry.points);
  for (Vec3& x : to) x += d;
  const auto swept = swept_volumes(mesh, geometry.points, to);
  for (Index f = 0; f < mesh.n_faces(); ++f) EXPECT_NEAR(swept[f], d.dot(geometry.face_area[f]), 1e-14);
}

TEST(Geometry, of_a_face_without_area_has_its_centre_between_its_corners) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_SELF, make_box(BoxCells::hexahedra, {1, 1, 1}, Vec3::Zero(), Vec3::Ones()));
  std::vector<Vec3> wedge(geometry.points);
  for (Vec3& x : wedge)
    if (x.x() > 0.5) x.y() = 0.5;
  const Geometry g = compute_geometry(mesh, wedge);
  int found = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (g.face_area[f].norm() > 1e-15) continue;
    ++found;
    EXPECT_LT((g.face_centre[f] - Vec3(1, 0.5, 0.5)).norm(), 1e-15);
  }
  EXPECT_EQ(found, 1);
}

}  // namespace couplet::geometry_test
