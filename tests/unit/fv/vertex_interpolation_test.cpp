// SPDX-License-Identifier: Apache-2.0
#include "common/fv/vertex_interpolation.hpp"
#include "common/fv/gradients.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::interpolation_test {
using namespace fv;
using namespace mesh;

/// Every boundary point stays, every inner point moves: skewed cells and warped faces.
LoadedMesh distorted(BoxCells cells, const Vec3& upper = Vec3(1, 0.7, 0.4)) {
  RawMesh raw = make_box(cells, {4, 3, 3}, Vec3::Zero(), upper);
  perturb_interior(raw, 0.25, 7);
  return distribute(MPI_COMM_WORLD, raw);
}

/// A linear scalar or vector field sampled at cell and boundary face centres.
struct NodeValues {
  std::vector<double> cells, boundary;
  template <class Field>
  NodeValues(const Mesh& mesh, const Geometry& geometry, int components, Field&& field) {
    const auto put = [&](std::vector<double>& to, const Vec3& x) {
      for (int c = 0; c < components; ++c) to.push_back(field(x)[c]);
    };
    for (const Vec3& x : geometry.cell_centre) put(cells, x);
    for (Index f = mesh.n_interior; f < mesh.n_faces(); ++f) put(boundary, geometry.face_centre[f]);
  }
};

class OnEveryCellType : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Interpolation, OnEveryCellType,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

TEST_P(OnEveryCellType, linear_fields_are_exact_at_all_open_vertices) {
  const auto [mesh, geometry] = distorted(GetParam());
  const VertexInterpolation interpolation(mesh, geometry,
                                          std::vector(mesh.patches.size(), PatchStencil::open));
  const auto field = [](const Vec3& x) { return Vec3(1 + 2 * x[0] - 3 * x[1] + 5 * x[2], 0, 0); };
  const NodeValues values(mesh, geometry, 1, field);
  for (Index v = 0; v < mesh.points.n_owned(); ++v)
    EXPECT_NEAR(interpolation.scalar_at<1>(v, values.cells, values.boundary)[0], field(geometry.points[v])[0],
                1e-11);
}

TEST_P(OnEveryCellType, linear_fields_stay_exact_where_cells_are_a_thousand_times_longer_than_thick) {
  const auto [mesh, geometry] = distorted(GetParam(), Vec3(1, 1e-3, 0.5));
  const VertexInterpolation interpolation(mesh, geometry,
                                          std::vector(mesh.patches.size(), PatchStencil::open));
  const auto field = [](const Vec3& x) { return Vec3(1 + 2 * x[0] - 3e3 * x[1] + 5 * x[2], 0, 0); };
  const NodeValues values(mesh, geometry, 1, field);
  for (Index v = 0; v < mesh.points.n_owned(); ++v)
    EXPECT_NEAR(interpolation.scalar_at<1>(v, values.cells, values.boundary)[0], field(geometry.points[v])[0],
                1e-8);
}

// The corners of these boxes belong to one or two cells, whose nodes alone would be magnified 9 to 17 times.
TEST_P(OnEveryCellType, corners_in_few_cells_take_a_wider_row_that_does_not_magnify) {
  const LoadedMesh part = distorted(GetParam()), whole = [] {
    RawMesh raw = make_box(GetParam(), {4, 3, 3}, Vec3::Zero(), Vec3(1, 0.7, 0.4));
    perturb_interior(raw, 0.25, 7);
    return distribute(MPI_COMM_SELF, raw);
  }();
  const auto magnified = [](const LoadedMesh& on, std::int64_t& nodes) {
    const Mesh& m = on.mesh;
    const VertexInterpolation interpolation(m, on.geometry,
                                            std::vector(m.patches.size(), PatchStencil::open));
    double most = 0;
    for (Index v = 0; v < m.points.n_owned(); ++v) {
      double size = 0;
      for (const double w : interpolation.weights(v)) size += std::abs(w);
      most = std::max(most, size);
      nodes += std::ssize(interpolation.nodes(v));
    }
    return most;
  };
  std::int64_t here = 0, in_all = 0;
  EXPECT_LT(parallel::max(part.mesh.comm, magnified(part, here)), 6);
  magnified(whole, in_all);
  EXPECT_EQ(parallel::sum(part.mesh.comm, here), in_all);
  const bool has_small_corners = GetParam() == BoxCells::tetrahedra || GetParam() == BoxCells::prisms;
  if (has_small_corners || GetParam() == BoxCells::hexahedra) {
    EXPECT_EQ(whole.mesh.wide_points.empty(), !has_small_corners);
  }
}

// On x = 0 and y = 0 the field is symmetric: u_n vanishes and u_t does not change across.
TEST_P(OnEveryCellType, symmetric_linear_fields_are_exact_at_symmetry_planes_and_their_edge) {
  const auto [mesh, geometry] = distorted(GetParam());
  std::vector<PatchStencil> stencils;
  for (const Patch& patch : mesh.patches)
    stencils.push_back(patch.name == "xmin" || patch.name == "ymin" ? PatchStencil::symmetry
                                                                    : PatchStencil::open);
  const VertexInterpolation interpolation(mesh, geometry, stencils);
  const auto field = [](const Vec3& x) { return Vec3(2 * x[0], -3 * x[1], 1 + 5 * x[2]); };
  const NodeValues values(mesh, geometry, 3, field);
  int on_planes = 0;
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    on_planes += interpolation.on_symmetry(v);
    EXPECT_LT(
        (interpolation.vector_at<3>(v, values.cells, values.boundary) - field(geometry.points[v])).norm(),
        1e-11);
  }
  EXPECT_GT(parallel::sum(mesh.comm, GlobalIndex(on_planes)), 0);
}

TEST_P(OnEveryCellType, fixed_vertices_see_faces_of_fixed_patches_only) {
  const auto [mesh, geometry] = distorted(GetParam());
  std::vector<PatchStencil> stencils(mesh.patches.size(), PatchStencil::open);
  for (std::size_t p = 0; p < mesh.patches.size(); ++p)
    if (mesh.patches[p].name == "xmax") stencils[p] = PatchStencil::fixed;
  const VertexInterpolation interpolation(mesh, geometry, stencils);
  // 7 on the fixed patch x = 1, something else everywhere else.
  const NodeValues values(mesh, geometry, 1,
                          [](const Vec3& x) { return Vec3(x[0] > 1 - 1e-9 ? 7 : -100, 0, 0); });
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    const bool there = geometry.points[v][0] > 1 - 1e-9;
    EXPECT_EQ(interpolation.is_fixed(v), there);
    const double value = interpolation.scalar_at<1>(v, values.cells, values.boundary)[0];
    EXPECT_EQ(std::abs(value - 7) < 1e-12, there);
  }
}

TEST_P(OnEveryCellType, face_gradients_of_linear_fields_are_exact_on_skewed_and_warped_faces) {
  const auto [mesh, geometry] = distorted(GetParam());
  const FaceGradient faces(mesh, geometry);
  const Vec3 slope(2, -3, mesh.dim == 3 ? 5 : 0);
  std::vector<double> points;
  for (const Vec3& x : geometry.points) points.insert(points.end(), {slope.dot(x), 0, 0});
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    const Vec3 tangential = faces.tangential_gradient<3>(mesh, f, points).col(0);
    const Vec3& there =
        f < mesh.n_interior ? geometry.cell_centre[mesh.neighbour[f]] : geometry.face_centre[f];
    const double normal = slope.dot(there - geometry.cell_centre[mesh.owner[f]]) * faces.inverse_dn[f] +
                          faces.skew[f].dot(tangential);
    EXPECT_LT((tangential + normal * faces.normal[f] - slope).norm(), 1e-11);
  }
}

TEST(VertexInterpolation, points_that_the_nodes_around_cannot_reach_are_reported) {
  const auto [mesh, geometry] = distorted(BoxCells::quadrilaterals);
  VertexInterpolation interpolation(mesh, geometry, std::vector(mesh.patches.size(), PatchStencil::open));
  EXPECT_TRUE(interpolation.inexact_points().empty());
  // All nodes in one line, the points beside it.
  Geometry flat = geometry;
  for (Vec3& x : flat.cell_centre) x[1] = -1;
  for (Vec3& x : flat.face_centre) x[1] = -1;
  interpolation.update(flat);
  EXPECT_EQ(std::ssize(interpolation.inexact_points()), mesh.points.n_owned());
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    double total = 0;
    for (const double w : interpolation.weights(v)) total += w;
    EXPECT_NEAR(total, 1, 1e-12);
  }
  interpolation.update(geometry);
  EXPECT_TRUE(interpolation.inexact_points().empty());
}

TEST(VertexInterpolation, follows_a_moved_mesh) {
  const auto [mesh, geometry] = distorted(BoxCells::quadrilaterals);
  VertexInterpolation interpolation(mesh, geometry, std::vector(mesh.patches.size(), PatchStencil::open));
  std::vector<Vec3> moved = geometry.points;
  for (Vec3& x : moved) x += 0.1 * Vec3(std::sin(3 * x[1]), std::cos(2 * x[0]), 0);
  const Geometry there = compute_geometry(mesh, moved);
  interpolation.update(there);
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < interpolation.nodes(v).size(); ++i) {
      const Index node = interpolation.nodes(v)[i];
      mean +=
          interpolation.weights(v)[i] *
          (node < mesh.cells.n_local() ? there.cell_centre[node]
                                       : there.face_centre[mesh.n_interior + node - mesh.cells.n_local()]);
    }
    EXPECT_LT((mean - moved[v]).norm(), 1e-12);
  }
}

}  // namespace couplet::interpolation_test
