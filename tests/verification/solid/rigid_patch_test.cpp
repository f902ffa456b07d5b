// SPDX-License-Identifier: Apache-2.0
// Patches that move as rigid bodies under a remote load: rigid to round-off, in equilibrium, on any ranks, at rest and in motion.
#include <Eigen/Dense>

#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/loads_support.hpp"

namespace couplet::testing::rigid_patch_test {
using namespace mesh;

/// U, w of the faces of a patch by least squares about a point, and the largest deviation from them. Collective.
struct Motion {
  Vec3 shift, turn;
  double deviation = 0;
};
Motion motion_of(const Solid& solid, const std::string& name, const Vec3& about,
                 const std::vector<double>& field) {
  const Mesh& mesh = solid.body().mesh();
  const Geometry& geometry = solid.body().geometry();
  const int dim = mesh.dim;
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  if (dim == 2) normal(2, 2) = normal(3, 3) = normal(4, 4) = 1;
  const auto visit = [&](const auto& use) {
    const Patch* patch = mesh.find_patch(name);
    for (Index f = patch->first; f < patch->first + patch->count; ++f) {
      Vec3 u = Vec3::Zero();
      for (int a = 0; a < dim; ++a) u[a] = field[std::size_t(f - mesh.n_interior) * dim + a];
      use(Vec3(geometry.face_centre[f] - about), u);
    }
  };
  visit([&](const Vec3& r, const Vec3& u) {
    Eigen::Matrix<double, 3, 6> basis = Eigen::Matrix<double, 3, 6>::Zero();
    basis.leftCols<3>().setIdentity();
    for (int k = 0; k < 3; ++k) basis.col(3 + k) = Vec3(Vec3::Unit(k)).cross(r);
    if (dim == 2) basis.col(2).setZero(), basis.col(3).setZero(), basis.col(4).setZero();
    normal += basis.transpose() * basis;
    right += basis.transpose() * u;
  });
  // The added ones of 2-D count once a rank, which is no matter.
  for (int i = 0; i < 6; ++i) {
    right[i] = parallel::sum(mesh.comm, right[i]);
    for (int j = 0; j < 6; ++j) normal(i, j) = parallel::sum(mesh.comm, normal(i, j));
  }
  const Eigen::Matrix<double, 6, 1> q = normal.ldlt().solve(right);
  Motion motion{q.head<3>(), q.tail<3>()};
  visit([&](const Vec3& r, const Vec3& u) {
    motion.deviation = std::max(motion.deviation, (u - motion.shift - motion.turn.cross(r)).norm());
  });
  motion.deviation = parallel::max(mesh.comm, motion.deviation);
  return motion;
}

SolidBoundary rigid(const Vec3& force, const Vec3& point, int dim) {
  SolidBoundary b = with_force(Type::remote_load, force, dim);
  b.load.point = point;
  b.load.is_rigid = true;
  return b;
}

class RigidPatch : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Solid, RigidPatch, ::testing::ValuesIn(all_cells),
                         [](const auto& info) { return std::string(name(info.param)); });

TEST_P(RigidPatch, moves_as_a_rigid_body_in_equilibrium_with_its_load) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = box_parameters(dim);
  p.method.relative_tolerance = 1e-13;
  p.boundaries["xmin"] = clamped(dim);
  const Vec3 force(2e6, -1e6, dim == 3 ? 3e6 : 0), point(1.5, 0.9, dim == 3 ? 0.1 : 0);
  p.boundaries["xmax"] = rigid(force, point, dim);
  const auto solid = stepped(distorted_box(GetParam()), p);
  const SolidState& state = solid->stepper().state();
  const Motion motion = motion_of(*solid, "xmax", point, state.face_u);
  EXPECT_LT(motion.deviation, 1e-12 * motion.shift.norm());
  // The work of the load is its force on the displacement of its point, twice the strain energy, but for what the trial functions
  // of a face give to its vertices, which are not rigid: less with each refinement.
  const std::vector<double> u = solid->body().unknowns_of(state.cell_u, state.face_u);
  const double energy = parallel::sum(
      MPI_COMM_WORLD,
      solid->body().kernel().product(elastic::ElasticPart::stiffness, {u, state.known}, {u, state.known}));
  EXPECT_NEAR(force.dot(motion.shift), energy, 0.005 * energy);
  for (const auto& r : solid->fields().reactions(solid->fields().point_displacement())) {
    if (r.patch == "xmin") {
      EXPECT_LT((r.force + force).norm(), 1e-8 * force.norm());
    }
  }
}

TEST(RigidPatches, are_stiffer_than_patches_that_share_the_load_and_bend_as_beams_do) {
  SolidParameters p = box_parameters(3);
  p.method.relative_tolerance = 1e-11;
  p.boundaries["xmin"] = clamped(3);
  const RawMesh bar = make_box(BoxCells::hexahedra, {20, 4, 4}, Vec3::Zero(), Vec3(10, 1, 1));
  const Vec3 tip(10, 0.5, 0.5);
  double moved[2];
  for (const bool is_rigid : {false, true}) {
    p.boundaries["xmax"] = rigid(Vec3(0, 1e6, 0), Vec3(13, 0.5, 0.5), 3);
    p.boundaries["xmax"].load.is_rigid = is_rigid;
    const auto solid = stepped(bar, p);
    moved[is_rigid] = motion_of(*solid, "xmax", tip, solid->stepper().state().face_u).shift[1];
  }
  const double EI = 200e9 / 12, GA = 200e9 / 2.6 / 1.2;
  const double wanted = 1e6 * (1000 / (3 * EI) + 3 * 100 / (2 * EI) + 10 / GA);
  EXPECT_NEAR(moved[1], wanted, 0.015 * wanted);
  EXPECT_LT(moved[1], moved[0]);
  EXPECT_GT(moved[1], 0.98 * moved[0]);
}

TEST(RigidPatches, stay_rigid_in_motion_and_take_the_momentum_of_their_load) {
  for (const time::TimeScheme scheme :
       {time::TimeScheme::trapezoidal, time::TimeScheme::generalised_alpha, time::TimeScheme::bathe}) {
    SolidParameters p = box_parameters(2);
    p.analysis = SolidParameters::Analysis::dynamic;
    p.time_scheme.type = scheme;
    p.method.relative_tolerance = 1e-12;
    p.initial_velocity = {{"x*y"}, {"0.1*x"}};
    p.boundaries["xmax"] = rigid(Vec3(0, 7e4, 0), Vec3(2, 0.5, 0), 2);
    const auto solid = make_solid(make_box(BoxCells::triangles, {6, 6, 1}, Vec3::Zero(), Vec3::Ones()), p);
    EXPECT_TRUE(solid->body().kernel().is_symmetric());
    for (int n = 0; n < 20; ++n) step(*solid, 1e-4);
    for (const auto* field : {&solid->stepper().state().face_u, &solid->stepper().state().face_v}) {
      const Motion motion = motion_of(*solid, "xmax", Vec3(1, 0.5, 0), *field);
      EXPECT_LT(motion.deviation, 1e-10 * motion.shift.norm());
    }
  }
}

TEST(RigidPatches, continue_bit_for_bit_from_a_checkpoint) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = rigid(Vec3(0, 7e4, 0), Vec3(2, 0.5, 0), 2);
  const auto make = [&p] {
    return make_solid(make_box(BoxCells::triangles, {6, 6, 1}, Vec3::Zero(), Vec3::Ones()), p);
  };
  const auto whole = make(), begun = make(), continued = make();
  for (int n = 0; n < 6; ++n) step(*whole, 1e-4);
  for (int n = 0; n < 3; ++n) step(*begun, 1e-4);
  support::SavedState(*begun).load_into(*continued);
  for (int n = 0; n < 3; ++n) step(*continued, 1e-4);
  EXPECT_EQ(whole->stepper().state().cell_v, continued->stepper().state().cell_v);
}

TEST(RigidPatches, give_the_same_displacement_on_any_number_of_ranks) {
  SolidParameters p = box_parameters(3);
  p.method.relative_tolerance = 1e-13;
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = rigid(Vec3(1e6, 2e6, -1e6), Vec3(2, 1, 1), 3);
  p.boundaries["ymax"] = rigid(Vec3::Zero(), Vec3::Zero(), 3);
  expect_same_on_ranks(distorted_box(BoxCells::tetrahedra), p, 1e-9);
}

}  // namespace couplet::testing::rigid_patch_test
