// SPDX-License-Identifier: Apache-2.0
// Mesh motion that cannot fold, each case beside a method that does fold there.
#include <Eigen/Geometry>

#include "common/mesh/load.hpp"
#include "mesh_mover/barrier.hpp"
#include "plate_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::mesh_mover::test::barrier_test {
using namespace mesh;

using std::numbers::pi;

template <class T>
class DistortionOf : public ::testing::Test {};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(DistortionOf, Dimensions);

template <int D>
Eigen::Matrix<double, D, D> some_gradient() {
  Eigen::Matrix<double, D, D> f;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      f(i, j) = (i == j ? 0.7 + 0.4 * i : 0) + 0.3 * std::sin(1 + 2.3 * i + 5.1 * j);
  return f;
}

/// d2W/dF2 : G of the tangent in the frame of the stretches.
template <int D>
Eigen::Matrix<double, D, D> apply(const typename Distortion<D>::Tangent& t,
                                  const Eigen::Matrix<double, D, D>& g) {
  const Eigen::Matrix<double, D, D> turned = t.u.transpose() * g * t.v;
  return t.u * (t.own.cwiseProduct(turned) + t.across.cwiseProduct(turned.transpose())) * t.v.transpose();
}

template <int D>
Eigen::Matrix<double, D, D> apply(const Eigen::Matrix<double, D, D>& f,
                                  const Eigen::Matrix<double, D, D>& g) {
  const typename Distortion<D>::SecondDerivative blocks(f, Eigen::Matrix<double, D, D>::Identity());
  Eigen::Matrix<double, D, D> change = Eigen::Matrix<double, D, D>::Zero();
  for (int k = 0; k < D; ++k)
    for (int l = 0; l < D; ++l) change.col(k) += blocks(k, l) * g.col(l);
  return change;
}

TYPED_TEST(DistortionOf, stress_and_tangent_are_the_derivatives_of_the_energy) {
  constexpr int D = TypeParam::value;
  using Matrix = Eigen::Matrix<double, D, D>;
  const Matrix f = some_gradient<D>();
  const Matrix g = some_gradient<D>().transpose() * some_gradient<D>() - 0.5 * Matrix::Identity();
  const double h = 1e-5;
  const double slope = (Distortion<D>::energy(f + h * g) - Distortion<D>::energy(f - h * g)) / (2 * h);
  EXPECT_NEAR(Distortion<D>::stress(f).cwiseProduct(g).sum(), slope, 1e-6 * std::abs(slope));
  const Matrix change = (Distortion<D>::stress(f + h * g) - Distortion<D>::stress(f - h * g)) / (2 * h);
  EXPECT_LT((apply<D>(f, g) - change).norm(), 1e-6 * change.norm());
  const Matrix wide = 1.2 * Matrix::Identity() + 0.1 * f,
               all = apply<D>(wide, g);  // nothing negative to remove
  EXPECT_LT((apply<D>(Distortion<D>::tangent(wide), g) - all).norm(), 1e-12 * all.norm());
}

TYPED_TEST(DistortionOf, is_zero_for_rotations_alone_and_projected_has_no_negative_curvature) {
  constexpr int D = TypeParam::value;
  using Matrix = Eigen::Matrix<double, D, D>;
  const Tensor3 turn = Eigen::AngleAxisd(1.1, Vec3::UnitZ()).toRotationMatrix();
  const Matrix r = turn.topLeftCorner<D, D>();
  EXPECT_NEAR(Distortion<D>::energy(r), 0, 1e-14);
  EXPECT_LT(Distortion<D>::stress(r).norm(), 1e-14);
  Matrix squeezed = r;
  squeezed.col(0) *= 0.3;
  EXPECT_NEAR(Distortion<D>::energy(squeezed), 0.09 + 1 / 0.09 - 2, 1e-12);
  Matrix odd = Matrix::Zero();  // turns what is squeezed
  odd(0, 1) = 1, odd(1, 0) = -1;
  const Matrix g = r * odd;
  EXPECT_LT(apply<D>(squeezed, g).cwiseProduct(g).sum(), -1);
  EXPECT_GE(apply<D>(Distortion<D>::tangent(squeezed), g).cwiseProduct(g).sum(), -1e-12);
}

TEST(FeasibleStep, finds_the_first_zero_and_stays_before_it) {
  EXPECT_EQ(first_root({1, 1, 1, 1}, 1), 1);
  EXPECT_EQ(first_root({1, -0.9, 0, 0}, 1), 1);
  EXPECT_NEAR(first_root({1, -4, 0, 0}, 1), 0.25, 3e-4);
  EXPECT_LE(first_root({1, -4, 0, 0}, 1), 0.25);
  // (1 - a / 0.2) (1 - a / 0.3) (1 - a / 0.9): falls, rises, falls.
  const double p = 1 / 0.2, q = 1 / 0.3, r = 1 / 0.9;
  EXPECT_NEAR(first_root({1, -(p + q + r), p * q + p * r + q * r, -p * q * r}, 1), 0.2, 3e-4);
  EXPECT_EQ(first_root({1, -(p + q + r), p * q + p * r + q * r, -p * q * r}, 0.19), 0.19);
  // Touches nothing between its extrema.
  EXPECT_EQ(first_root({1, -4, 4.1, 0}, 1), 1);
}

Parameters block(int kind, Method method, BoundaryMotion walls) {
  Parameters p;
  p.mesh = "frame.geo";
  p.mesh_parameters = {{"kind", kind}, {"n", kind == 2 ? 2 : 6}};
  p.dimension = kind == 2 ? 3 : 2;
  p.method = method;
  for (const char* wall : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    if (p.dimension == 3 || wall[0] != 'z') p.boundaries[wall].motion = walls;
  p.boundaries["block"].motion = BoundaryMotion::moving;
  const bool slides = walls == BoundaryMotion::slip;
  p.boundaries["block"].prescribed.translation = {{slides ? "0.475*t" : "0"}, {"0.475*t"}};
  if (p.dimension == 3) p.boundaries["block"].prescribed.translation.push_back({"0"});
  return p;
}

app::ParticipantContext in_test_data() {
  app::ParticipantContext c = context();
  c.case_folder = COUPLET_TEST_DATA;
  return c;
}

class BlockInAFrame : public ::testing::TestWithParam<std::pair<int, BoundaryMotion>> {};

/// To 5 % of its gaps: to the wall above, or, where walls slide, into a corner.
TEST_P(BlockInAFrame, closes_its_gaps_to_a_twentieth_where_the_laplacian_folds) {
  const auto [kind, walls] = GetParam();
  Mover mover(block(kind, Method::barrier, walls), in_test_data());
  mover.initialise();
  run(mover, 0, 1, 20);
  EXPECT_GT(mover.state().worst[MeshState::scaled_jacobian].value, 0);
  EXPECT_GT(mover.state().worst[MeshState::volume_ratio].value, 1e-4);
  RecordProperty("least scaled Jacobian",
                 std::to_string(mover.state().worst[MeshState::scaled_jacobian].value));
  Mover laplacian(block(kind, Method::laplacian, walls), in_test_data());
  laplacian.initialise();
  EXPECT_THAT(support::error_of<SolveFailure>([&] { run(laplacian, 0, 1, 20); }),
              ::testing::ContainsRegex("inverts cell|intersect itself"));
}

INSTANTIATE_TEST_SUITE_P(All, BlockInAFrame,
                         ::testing::Values(std::pair{0, BoundaryMotion::fixed},
                                           std::pair{1, BoundaryMotion::fixed},
                                           std::pair{2, BoundaryMotion::fixed},
                                           std::pair{0, BoundaryMotion::slip},
                                           std::pair{1, BoundaryMotion::slip}));

/// The corner of the block would pass the diagonal of the fixed corner cell: no mesh has such cells.
TEST(Barrier, refuses_what_no_mesh_can_follow) {
  Parameters p = block(1, Method::barrier, BoundaryMotion::fixed);
  p.boundaries["block"].prescribed.translation = {{"0.475*t"}, {"0.475*t"}};
  Mover mover(p, in_test_data());
  mover.initialise();
  EXPECT_THAT(support::error_of<SolveFailure>([&] { run(mover, 0, 1, 20); }),
              ::testing::ContainsRegex("no valid mesh was found.*near \\(1.9"));
}

TEST(Barrier, turns_a_plate_by_half_a_turn_and_back_where_the_laplacian_folds) {
  for (const Method method : {Method::barrier, Method::laplacian}) {
    Parameters p = plate_in_a_square(method);
    turn_by(p, "pi*t");
    Mover mover(p, context());
    mover.initialise();
    if (method == Method::laplacian) {
      EXPECT_THROW(run(mover, 0, 1, 36), SolveFailure);
      continue;
    }
    run(mover, 0, 1, 36);
    EXPECT_GT(mover.state().worst[MeshState::scaled_jacobian].value, 0.02);
    run(mover, 1, 0, 36);
    EXPECT_LT(largest_difference(MPI_COMM_WORLD, mover.displacement(),
                                 std::vector<double>(mover.displacement().size())),
              1e-2 / 16);  // of the edges
  }
}

Parameters reed(bool deep, Method method) {
  Parameters p;
  p.mesh = deep ? "reed_slice.geo" : "reed_plane.geo";
  p.dimension = deep ? 3 : 2;
  p.method = method;
  for (const char* wall : {"inlet", "outlet", "walls", "seat"})
    p.boundaries[wall].motion = BoundaryMotion::fixed;
  if (deep) p.boundaries["sides"].motion = BoundaryMotion::slip;
  p.boundaries["plate"].motion = BoundaryMotion::moving;
  const char* lift = "0.0039*t*(x/0.06)^2*(3-x/0.06)/2";
  p.boundaries["plate"].prescribed.displacement = {{"0"}};
  if (deep) p.boundaries["plate"].prescribed.displacement.push_back({"0"});
  p.boundaries["plate"].prescribed.displacement.push_back({lift});
  return p;
}

TEST(Barrier, lifts_the_tip_of_a_reed_by_ten_times_its_thickness_where_the_laplacian_folds) {
  for (const bool deep : {false, true}) {
    Mover mover(reed(deep, Method::barrier), in_test_data());
    mover.initialise();
    run(mover, 0, 1, 10);
    EXPECT_GT(mover.state().worst[MeshState::scaled_jacobian].value, 0.15);
    Mover laplacian(reed(deep, Method::laplacian), in_test_data());
    laplacian.initialise();
    EXPECT_THROW(run(laplacian, 0, 1, 10), SolveFailure);
  }
}

/// In three dimensions the steps are solved by multigrid, whose preconditioner a checkpoint makes again.
TEST(Barrier, in_three_dimensions_goes_on_from_a_checkpoint_and_hardly_depends_on_the_ranks) {
  const Parameters p = reed(true, Method::barrier);
  Mover mover(p, in_test_data());
  mover.initialise();
  run(mover, 0, 0.4, 4);
  const support::SavedState checkpoint(mover);
  run(mover, 0.4, 0.6, 2);
  const std::vector<double> end = mover.displacement();
  checkpoint.load_into(mover);
  run(mover, 0.4, 0.6, 2);
  EXPECT_EQ(mover.displacement(), end);

  Mover reference(p, alone(in_test_data()));
  reference.initialise();
  run(reference, 0, 0.6, 6);
  EXPECT_LT(difference_to(reference, mover, end), 1e-4 * 0.0039);
}

TEST(Barrier, follows_two_cylinders_that_pass_each_other_where_the_laplacian_folds) {
  for (const Method method : {Method::barrier, Method::laplacian}) {
    Parameters p;
    p.mesh = "pair.geo";
    p.mesh_parameters = {{"gap", 0.1}};
    p.dimension = 2;
    p.method = method;
    for (const char* wall : {"ends", "sides"}) p.boundaries[wall].motion = BoundaryMotion::slip;
    for (const char* body : {"upper", "lower"}) p.boundaries[body].motion = BoundaryMotion::moving;
    p.boundaries["upper"].prescribed.translation = {{"sin(2*pi*t)"}, {"0"}};
    p.boundaries["lower"].prescribed.translation = {{"-sin(2*pi*t)"}, {"0"}};
    app::ParticipantContext c = context();
    c.case_folder = COUPLET_CONFIGS "/passing-cylinders";
    Mover mover(p, c);
    mover.initialise();
    if (method == Method::laplacian) {
      EXPECT_THROW(run(mover, 0, 0.25, 12), SolveFailure);
      continue;
    }
    run(mover, 0, 0.75, 36);
    EXPECT_GT(mover.state().worst[MeshState::scaled_jacobian].value, 0.002);
  }
}

/// The Laplacian while it serves; the barrier from the start where a prescribed motion would fold the mesh later on.
TEST(Barrier, auto_chooses_it_where_the_laplacian_would_fold) {
  Parameters p = block(0, Method::automatic, BoundaryMotion::fixed);
  app::ParticipantContext c = in_test_data();
  c.simulation.end_time = 1;
  Mover mover(p, c);
  mover.initialise();
  run(mover, 0, 0.1, 2);
  const std::vector<double> chosen = mover.displacement();
  p.method = Method::barrier;
  Mover barrier(p, c);
  barrier.initialise();
  run(barrier, 0, 0.1, 2);
  EXPECT_EQ(chosen, barrier.displacement());
  run(mover, 0.1, 1, 18);
  EXPECT_GT(mover.state().worst[MeshState::scaled_jacobian].value, 0);

  p.method = Method::automatic;
  c.simulation.end_time = 0.1;
  Mover gentle(p, c);
  gentle.initialise();
  run(gentle, 0, 0.1, 2);
  p.method = Method::laplacian;
  Mover laplacian(p, c);
  laplacian.initialise();
  run(laplacian, 0, 0.1, 2);
  EXPECT_EQ(gentle.displacement(), laplacian.displacement());
  EXPECT_NE(gentle.displacement(), chosen);
  const support::SavedState early(gentle);
  run(gentle, 0.1, 1, 18);  // further than it was told: it leaves the Laplacian on the way
  EXPECT_GT(gentle.state().worst[MeshState::scaled_jacobian].value, 0);
  const std::vector<double> late = gentle.displacement();
  early.load_into(gentle);  // back to the Laplacian
  run(gentle, 0.1, 1, 18);
  EXPECT_EQ(gentle.displacement(), late);

  if (parallel::comm_size(MPI_COMM_WORLD) > 1)
    return;  // in one process a second mesh is shared out otherwise
  p.method = Method::automatic;
  c.simulation.end_time = 1;
  Mover later(p, c);  // a run that is resumed with a later end: the barrier at once
  later.initialise();
  early.load_into(later);
  EXPECT_EQ(later.displacement(), laplacian.displacement());
  run(later, 0.1, 0.15, 1);
  run(barrier, 0.1, 0.15, 1);
  double apart = 0;
  for (std::size_t i = 0; i < later.displacement().size(); ++i)
    apart = std::max(apart, std::abs(later.displacement()[i] - barrier.displacement()[i]));
  EXPECT_LT(apart, 1e-3);
}

/// Quadrilaterals fold at a corner before their volume vanishes; what a fluid computes there is wrong.
TEST(Barrier, auto_chooses_it_before_a_corner_folds) {
  for (const Method method : {Method::laplacian, Method::automatic}) {
    Mover mover(block(1, method, BoundaryMotion::slip), in_test_data());
    mover.initialise();
    try {
      run(mover, 0, 1, 200);
    } catch (const SolveFailure&) {  // the Laplacian, later on
      EXPECT_EQ(method, Method::laplacian);
    }
    EXPECT_EQ(*mover.least_jacobian() > 0, method == Method::automatic) << *mover.least_jacobian();
  }
}

/// On a turned box, so that no plane is normal to an axis: a corner point rests, one at an edge slides along it.
TEST(Barrier, slides_along_planes_and_edges_of_any_direction) {
  RawMesh raw = make_box(BoxCells::mixed, {4, 4, 4}, Vec3::Zero(), Vec3::Ones());
  const Tensor3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& x : raw.points) x = turn * x;
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, raw);
  Parameters p;
  p.dimension = 3;
  for (const Patch& patch : mesh.patches) p.boundaries[patch.name].motion = BoundaryMotion::slip;
  p.boundaries["xmin"].motion = BoundaryMotion::fixed;
  p.boundaries["xmax"].motion = BoundaryMotion::interface;
  p.stiffening = 0;
  const auto barrier = make_barrier(mesh, geometry, p);
  const auto pushed = [&](double way) {
    std::vector<double> d(std::size_t(mesh.points.n_local()) * 3, 0.0);
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      const Vec3 x = turn.transpose() * geometry.points[v];
      if (x.x() > 0.999) Eigen::Map<Vec3>(d.data() + 3 * v) = turn * Vec3(way, 0, 0);
    }
    return d;
  };
  const std::vector<double> d = barrier->solve(pushed(0.8));
  double across = 0, along = 0;
  for (Index v = 0; v < mesh.points.n_local(); ++v) {
    const Vec3 x = turn.transpose() * geometry.points[v];
    const Vec3 u = turn.transpose() * Eigen::Map<const Vec3>(d.data() + 3 * v);
    // Uniform stretch has least distortion.
    along = std::max(along, std::abs(u.x() - 0.8 * x.x()));
    across = std::max({across, std::abs(u.y()), std::abs(u.z())});
  }
  EXPECT_LT(parallel::max(mesh.comm, along), 1e-3);
  EXPECT_LT(parallel::max(mesh.comm, across), 1e-3);
}

TEST(Barrier, periodic_patches_are_refused_by_name) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_SELF, make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3::Ones()));
  Parameters p;
  p.dimension = 2;
  for (const Patch& patch : mesh.patches) p.boundaries[patch.name].motion = BoundaryMotion::fixed;
  p.boundaries["ymax"].motion = BoundaryMotion::periodic;
  EXPECT_THAT(support::error_of([&] { const auto barrier = make_barrier(mesh, geometry, p); }),
              ::testing::HasSubstr("boundaries.ymax"));
}

}  // namespace couplet::mesh_mover::test::barrier_test
