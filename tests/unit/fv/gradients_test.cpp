// SPDX-License-Identifier: Apache-2.0
#include "common/fv/gradients.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::point_gradient_test {
using namespace mesh;

LoadedMesh box(BoxCells cells, double amount) {
  RawMesh raw = make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.7, 0.4));
  perturb_interior(raw, amount, 11);
  return distribute(MPI_COMM_WORLD, raw);
}

template <class Field>
std::vector<double> at_points(const Mesh& mesh, const Geometry& geometry, Field&& field) {
  std::vector<double> values;
  for (const Vec3& x : geometry.points) {
    const Vec3 u = field(x);
    values.insert(values.end(), u.data(), u.data() + mesh.dim);
  }
  return values;
}

/// (i, j): derivative of component j along i.
Tensor3 in_plane(int dim, Tensor3 slope) {
  if (dim == 2) {
    slope.row(2).setZero();
    slope.col(2).setZero();
  }
  return slope;
}

class PointGradient : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Cells, PointGradient,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

TEST_P(PointGradient, linear_fields_are_exact_on_warped_cells_whatever_the_common_slope) {
  const auto [mesh, geometry] = box(GetParam(), 0.25);
  Tensor3 wanted;
  wanted << 1, -2, 3, 0.5, 4, -1, 2, 0.7, -3;
  wanted = in_plane(mesh.dim, wanted);
  const auto values =
      at_points(mesh, geometry, [&](const Vec3& x) { return Vec3(Vec3(7, 8, 9) + wanted.transpose() * x); });
  for (const Tensor3& slope : {Tensor3(Tensor3::Zero()), wanted}) {
    const std::vector<Tensor3> slopes(mesh.points.n_local(), slope);
    const std::vector<Tensor3> gradients = fv::gradients_from_points(mesh, geometry, values, slopes);
    ASSERT_EQ(std::ssize(gradients), mesh.cells.n_owned());
    for (const Tensor3& g : gradients) EXPECT_LT((g - wanted).norm(), 1e-11);
  }
}

// The mean of a linear gradient is its value at the centre; flat faces, so that the mesh's centres are meant.
TEST_P(PointGradient, quadratic_fields_are_exact_at_the_centres) {
  const auto [mesh, geometry] = box(GetParam(), 0);
  const auto slope_at = [&](const Vec3& x) {
    Tensor3 slope;
    slope << 2 * x[0] + x[1], x[1], x[2], x[0], x[0] - 4 * x[1], 3 * x[1], 0, 0, x[0];
    slope(1, 2) = 6 * x[1];
    return in_plane(mesh.dim, slope);
  };
  const auto values = at_points(mesh, geometry, [](const Vec3& x) {
    return Vec3(x[0] * x[0] + x[0] * x[1], x[0] * x[1] - 2 * x[1] * x[1], x[0] * x[2] + 3 * x[1] * x[1]);
  });
  std::vector<Tensor3> slopes;
  for (const Vec3& x : geometry.points) slopes.push_back(slope_at(x));
  const std::vector<Tensor3> gradients = fv::gradients_from_points(mesh, geometry, values, slopes);
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    EXPECT_LT((gradients[c] - slope_at(geometry.cell_centre[c])).norm(), 1e-11);
}

}  // namespace couplet::point_gradient_test
