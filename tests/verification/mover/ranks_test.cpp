// SPDX-License-Identifier: Apache-2.0
// Every way to move a mesh on one rank and several, and from a checkpoint.
#include "common/io/checkpoint.hpp"
#include "common/mesh/load.hpp"
#include "mesh_mover/methods.hpp"
#include "mesh_mover/patches.hpp"
#include "plate_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::mesh_mover::test::ranks_test {
using namespace mesh;
using std::numbers::pi;

class EveryMethodInParallel : public ::testing::TestWithParam<Method> {};

TEST_P(EveryMethodInParallel, goes_on_from_a_checkpoint_bit_for_bit) {
  Parameters p = plate_in_a_square(GetParam());
  turn_by(p, "0.5*t");
  p.boundaries["plate"].prescribed.displacement = {{"0.1*t*y"}, {"0.1*t*x^2"}};
  Mover mover(p, context());
  mover.initialise();
  run(mover, 0, 0.4, 2);
  const support::SavedState checkpoint(mover);
  const std::vector<double> then = mover.displacement();
  run(mover, 0.4, 1, 2);
  const std::vector<double> end = mover.displacement();
  EXPECT_NE(end, then);
  checkpoint.load_into(mover);
  EXPECT_EQ(mover.displacement(), then);
  run(mover, 0.4, 1, 2);
  EXPECT_EQ(mover.displacement(), end);
}

TEST_P(EveryMethodInParallel, is_not_changed_by_checkpoints) {
  Parameters p = plate_in_a_square(GetParam());
  turn_by(p, "0.5*t");
  Mover never(p, context()), always(p, context());
  for (Mover* mover : {&never, &always}) mover->initialise();
  for (int i = 0; i < 4; ++i) {
    for (Mover* mover : {&never, &always}) run(*mover, 0.1 * i, 0.1 * (i + 1), 1);
    io::StateInMemory memory;
    io::CheckpointWriter writer(memory);
    always.save(writer);
    writer.close();
  }
  EXPECT_EQ(never.displacement(), always.displacement());
}

TEST_P(EveryMethodInParallel, is_the_same_on_any_number_of_ranks) {
  Parameters p = plate_in_a_square(GetParam());
  turn_by(p, "0.4*t");
  p.boundaries["plate"].prescribed.displacement = {{"0"}, {"0.1*t*x^2"}};
  Mover mover(p, context()), reference(p, alone());
  mover.initialise();
  reference.initialise();
  run(mover, 0, 1, 3);
  run(reference, 0, 1, 3);
  EXPECT_LT(difference_to(reference, mover, mover.displacement()), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(All, EveryMethodInParallel,
                         ::testing::Values(Method::laplacian, Method::pseudo_solid, Method::barrier));

// Points that slide along a curved patch stay on it: half a ring whose inner circle moves.

constexpr double outer = 2;
constexpr int around = 24;

/// 1 < r < 2 over half a turn; in 3-D a half tube of height 1.
LoadedMesh half_ring(BoxCells cells, int dim) {
  RawMesh raw;
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
    raw = make_box(cells, {6, around, 2}, Vec3::Zero(), Vec3::Ones());
    for (Vec3& x : raw.points)
      x = Vec3((1 + x[0]) * std::cos(pi * x[1]), (1 + x[0]) * std::sin(pi * x[1]), dim == 3 ? x[2] : 0);
  }
  return distribute(MPI_COMM_WORLD, raw);
}

Parameters sliding(const Mesh& mesh) {
  Parameters p;
  p.dimension = mesh.dim;
  p.method = Method::pseudo_solid;
  for (const Patch& patch : mesh.patches) p.boundaries[patch.name].motion = BoundaryMotion::slip;
  p.boundaries["xmin"].motion = BoundaryMotion::moving;
  return p;
}

struct Far {
  double off = 0, along = 0;  // of the outer points: largest distance from the circle, largest way
};

Far of_outer_points(const Mesh& mesh, const Geometry& geometry, const std::vector<double>& d) {
  Far far;
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    const Vec3& x = geometry.points[v];
    if (x.head<2>().norm() < outer - 1e-9) continue;
    const Eigen::Map<const Vec<2>> moved(d.data() + std::size_t(v) * mesh.dim);
    far.off = std::max(far.off, std::abs((x.head<2>() + moved).norm() - outer));
    far.along = std::max(far.along, moved.norm());
  }
  return {parallel::max(mesh.comm, far.off), parallel::max(mesh.comm, far.along)};
}

TEST(CurvedSlide, points_stay_on_the_polygon_of_the_patch_however_far_they_slide) {
  for (const int dim : {2, 3}) {
    const auto [mesh, geometry] = half_ring(dim == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra, dim);
    const Parameters p = sliding(mesh);
    std::vector<double> given(std::size_t(mesh.points.n_local()) * dim, 0.0);
    for (Index v = 0; v < mesh.points.n_local(); ++v)
      if (geometry.points[v].head<2>().norm() < 1 + 1e-9) given[std::size_t(v) * dim] = 0.6;
    const auto solid = make_pseudo_solid(mesh, geometry, p);
    std::vector<double> d = solid->solve(given);
    const Far tangent = of_outer_points(mesh, geometry, d);
    CurvedSlide(mesh, geometry, p).put_back(d);
    const Far after = of_outer_points(mesh, geometry, d);
    const double sagitta = outer * (1 - std::cos(pi / around / 2));
    EXPECT_GT(tangent.off, 2 * sagitta) << "the tangent alone leaves the circle";
    EXPECT_LE(after.off, sagitta * (1 + 1e-9)) << dim;
    EXPECT_GT(after.along, 0.1) << "they do slide";
  }
}

TEST(CurvedSlide, flat_patches_and_points_that_do_not_move_are_left_alone) {
  const auto [mesh, geometry] = half_ring(BoxCells::quadrilaterals, 2);
  Parameters p = sliding(mesh);
  std::vector<double> rest(std::size_t(mesh.points.n_local()) * 2, 0.0);
  CurvedSlide(mesh, geometry, p).put_back(rest);
  for (const double value : rest) EXPECT_EQ(value, 0);
  EXPECT_FALSE(CurvedSlide(mesh, geometry, p).empty());
  p.boundaries["xmax"].motion = BoundaryMotion::fixed;
  EXPECT_TRUE(CurvedSlide(mesh, geometry, p).empty());
}

/// Both sides of a slice as one patch, whose face vectors add up to nothing: its points may go where it was not, which those of a
/// patch that counts as curved could not.
TEST(CurvedSlide, two_parallel_planes_are_flat) {
  RawMesh raw;
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
    raw = make_box(BoxCells::hexahedra, {4, 3, 1}, Vec3::Zero(), Vec3::Ones());
    const auto index = [&](const char* name) {
      return static_cast<int>(std::ranges::find(raw.patches, name) - raw.patches.begin());
    };
    std::ranges::replace(raw.boundary_patch, index("zmax"), index("zmin"));
    raw.patches[index("zmin")] = "sides";
    raw.patches.pop_back();
  }
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  ASSERT_TRUE(mesh.find_patch("sides"));
  EXPECT_TRUE(CurvedSlide(mesh, geometry, sliding(mesh)).empty());
}

TEST(CurvedSlide, is_refused_by_the_laplacian_with_what_to_use) {
  const auto [mesh, geometry] = half_ring(BoxCells::quadrilaterals, 2);
  EXPECT_THAT(support::error_of([&] { Laplacian laplacian(mesh, geometry, sliding(mesh)); }),
              ::testing::HasSubstr("use 'method: pseudo-solid', which slides along any surface"));
}

}  // namespace couplet::mesh_mover::test::ranks_test
