// SPDX-License-Identifier: Apache-2.0
#include "common/io/probes/probe.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/world.hpp"

namespace couplet::probe_test {
using namespace io;
using namespace mesh;

using ::testing::HasSubstr;

LoadedMesh make_stretched(BoxCells cells, double distortion = 0.2) {
  const bool flat = cells == BoxCells::quadrilaterals || cells == BoxCells::triangles;
  RawMesh raw;
  if (parallel::comm_rank(world) == 0) {
    raw = make_box(cells, {5, 4, flat ? 1 : 3}, Vec3(0.5, 0, 0), Vec3(2.5, 1, flat ? 0 : 0.75));
    perturb_interior(raw, distortion, 7);
  }
  return distribute(world, raw);
}

double linear(const Vec3& x) { return 3 + 2 * x[0] - 5 * x[1] + 0.5 * x[2]; }

std::vector<double> linear_values(const Geometry& geometry) {
  std::vector<double> values;
  for (const Vec3& x : geometry.points) {
    values.push_back(linear(x));
    values.push_back(-2 * linear(x));
  }
  return values;
}

class ProbeIn : public ::testing::TestWithParam<BoxCells> {};

TEST_P(ProbeIn, a_cell_is_exact_for_linear_fields) {
  const auto [mesh, geometry] = make_stretched(GetParam());
  const std::vector<double> values = linear_values(geometry);
  for (const double s : {0.13, 0.31, 0.52, 0.77, 0.99}) {
    const Vec3 x(0.5 + 2 * s, 1 - s * s, mesh.dim == 2 ? 0 : 0.75 * s * (1.3 - s));
    const Probe probe(mesh, geometry.points, "p", x);
    const auto got = probe.sample(values, 2);
    EXPECT_EQ(got.size(), parallel::comm_rank(world) == 0 ? 2u : 0u);
    if (got.empty()) continue;
    EXPECT_NEAR(got[0], linear(x), 1e-12) << s;
    EXPECT_NEAR(got[1], -2 * linear(x), 1e-12) << s;
  }
}

TEST_P(ProbeIn, a_mesh_point_is_exactly_that_point) {
  const auto [mesh, geometry] = make_stretched(GetParam());
  // A value per point that no interpolation of neighbours would give.
  std::vector<double> values;
  for (const GlobalIndex id : mesh.point_id) values.push_back(double((id * 7919) % 101) + 1.0 / 3);
  for (const Vec3& corner : {Vec3(0.5, 0, 0), Vec3(2.5, 1, 0), Vec3(0.9, 0.25, 0)}) {
    double wanted = 0;
    for (Index p = 0; p < mesh.points.n_owned(); ++p)
      if ((geometry.points[p] - corner).norm() < 1e-12) wanted = values[p];
    wanted = parallel::sum(world, wanted);
    if (wanted == 0) continue;  // the interior point was moved by the distortion
    const auto got = Probe(mesh, geometry.points, "p", corner).sample(values, 1);
    if (!got.empty()) {
      EXPECT_EQ(got[0], wanted);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(every_cell_type, ProbeIn,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

TEST(Probe, just_outside_goes_to_the_nearest_place_of_the_boundary) {
  const auto [mesh, geometry] = make_stretched(BoxCells::quadrilaterals);
  const Probe probe(mesh, geometry.points, "tip", Vec3(1.03, 1.01, 0), 0.02);
  EXPECT_NEAR((probe.place() - Vec3(1.03, 1, 0)).norm(), 0, 1e-14);
  const auto got = probe.sample(linear_values(geometry), 2);
  if (!got.empty()) {
    EXPECT_NEAR(got[0], linear(Vec3(1.03, 1, 0)), 1e-12);
  }
}

TEST(Probe, just_outside_of_a_solid_body_goes_to_its_surface) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::prisms}) {
    const auto [mesh, geometry] = make_stretched(cells, 0);
    const Probe probe(mesh, geometry.points, "tip", Vec3(1.03, 0.37, 0.76), 0.02);
    EXPECT_NEAR((probe.place() - Vec3(1.03, 0.37, 0.75)).norm(), 0, 1e-13);
    const auto got = probe.sample(linear_values(geometry), 2);
    if (!got.empty()) {
      EXPECT_NEAR(got[0], linear(Vec3(1.03, 0.37, 0.75)), 1e-12);
    }
  }
}

TEST(Probe, far_outside_is_an_error_with_the_distance_on_every_rank) {
  const auto [mesh, geometry] = make_stretched(BoxCells::quadrilaterals);
  EXPECT_EQ(
      support::error_of([&] { Probe(mesh, geometry.points, "tip", Vec3(1.5, 1.25, 0)); }),
      "The probe 'tip' at (1.5, 1.25, 0) is outside the mesh: the nearest point of the mesh is (1.5, 1, 0), "
      "0.25 m away. Move the probe there or into the mesh.");
}

TEST(Probe, lives_on_exactly_one_rank) {
  const auto [mesh, geometry] = make_stretched(BoxCells::triangles, 0);
  // On a face between cells: several ranks could claim it.
  const Probe probe(mesh, geometry.points, "p", Vec3(1.3, 0.6, 0));
  double total = 0;
  for (const double w : probe.weights()) total += w;
  EXPECT_NEAR(parallel::sum(world, total), 1, 1e-14);
}

}  // namespace couplet::probe_test
