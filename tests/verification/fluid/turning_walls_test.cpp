// SPDX-License-Identifier: Apache-2.0
// Friction on walls that turn: the whole of mu (grad u + grad u^T).
#include <Eigen/Geometry>

#include "fluid_case.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "participant_case.hpp"
#include "ring_mesh.hpp"
#include "tests/support/apart.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/fluid/fluid_case.hpp"

namespace couplet::fluid::test::turning_walls_test {
using namespace mesh;
using mesh::BoxCells;
using mesh::RawMesh;

constexpr double mu = 0.1;

template <int D>
RawMesh box(BoxCells cells) {
  if (parallel::comm_rank(MPI_COMM_WORLD) > 0) return {};
  RawMesh raw = make_box(cells, D == 2 ? std::array<Index, 3>{8, 8, 1} : std::array<Index, 3>{3, 3, 3},
                         Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.5, 0.5));
  perturb_interior(raw, 0.15, 5);
  return raw;
}

TEST(TurningWalls, stokes_theorem_gives_minus_omega_cross_the_area) {
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, box<3>(BoxCells::tetrahedra));
  const Vec3 omega(0.3, -1.1, 0.7), shift(2, 1, -1);
  for (const Patch& patch : mesh.patches) {
    std::vector<Vec3> velocities;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      for (const Index v : mesh.face_points[f]) velocities.push_back(shift + omega.cross(geometry.points[v]));
    Vectors<3> turn(mesh.boundary.n_owned(), Vec3::Zero());
    set_turn<3>(mesh, patch, geometry.points, velocities, turn);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec3& area = geometry.face_area[f];
      EXPECT_LT((turn[f - mesh.n_interior] + omega.cross(area)).norm(), 1e-14);
      EXPECT_NEAR(turning_force<3>(mu, turn[f - mesh.n_interior]).dot(area), 0, 1e-16);
    }
  }
}

/// A wall that stretches, u = (x, -y): du/dn on y = const is -1 along the normal, twice mu of it the stress, once in the flux.
TEST(TurningWalls, a_wall_that_stretches_feels_the_normal_slope_beside_the_flux) {
  const std::vector<Vec3> corners{Vec3(0, 0, 0), Vec3(0.2, 0, 0)}, velocities{Vec3(0, 0, 0), Vec3(0.2, 0, 0)};
  const Vec<2> force = turning_force<2>(mu, turn_of<2>(corners, velocities));
  EXPECT_NEAR(force[0], 0, 1e-16);
  EXPECT_NEAR(force[1], -mu * 0.2, 1e-16);  // -mu (dv/dy) S_y = -mu (-1)(-0.2)
}

FluidParameters turning(int dim) {
  FluidParameters p = fluid_of(1, mu, 1e-12);
  p.mesh = "box";
  p.dimension = dim;
  p.initial_velocity = {{"-0.5*y"}, {"0.5*x"}};
  if (dim == 3) p.initial_velocity.push_back({"0"});
  return p;
}

/// Largest friction on a face, over its area [Pa].
template <int D>
double largest_friction(const Fluid<D>& fluid) {
  double worst = 0;
  for (std::size_t b = 0; b < fluid.viscous_force().size(); ++b)
    worst = std::max(
        worst, fluid.viscous_force()[b].norm() /
                   fluid.state().placement->area[fluid.mesh().n_interior + static_cast<Index>(b)].norm());
  return parallel::max(MPI_COMM_WORLD, worst);
}

/// Fluid and walls turn as one, the fluid goes through those of the box: no friction. du/dn alone gives mu omega = 0.05 Pa.
template <int D>
void no_friction_in_a_fluid_that_turns_as_a_whole() {
  FluidParameters p = turning(D);
  BoundaryParameters wall = boundary(BoundaryType::moving_wall);
  wall.rotation.emplace();
  wall.rotation->speed.text = "0.5";
  all_sides(p, D, wall);
  FluidCase<D> c(MPI_COMM_WORLD, box<D>(D == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra), p);
  c.run(0.06, 3);
  EXPECT_LT(largest_friction(c.fluid()), 0.008);  // what the mesh leaves
}
TEST(TurningWalls, no_friction_in_a_plane_fluid_that_turns_as_a_whole) {
  no_friction_in_a_fluid_that_turns_as_a_whole<2>();
}
TEST(TurningWalls, no_friction_in_a_fluid_that_turns_as_a_whole) {
  no_friction_in_a_fluid_that_turns_as_a_whole<3>();
}

/// The same with a mesh that turns, and its walls as bodies; du/dn alone gives -2 mu omega A = -0.314, 1.257.
TEST(TurningWalls, no_friction_between_bodies_that_turn_with_their_fluid) {
  FluidParameters p = turning(2);
  p.motion.emplace();
  p.motion->angle = {"0.5*t"};
  p.boundaries["inner"] = p.boundaries["outer"] = boundary(BoundaryType::body);
  FluidParticipant<2> run(distribute(MPI_COMM_WORLD, ring_mesh(6)), p, FluidContext{}, MotionLink{});
  run.initialise();
  take_steps(run, 0, 20);  // until the impulse of the start is forgotten
  EXPECT_NEAR(moment(run.fluid(), {"inner"}), 0, 0.02);
  EXPECT_NEAR(moment(run.fluid(), {"outer"}), 0, 0.06);
}

/// Walls that turn unevenly, by the case and with their mesh: a run that goes on from a checkpoint has every load of
/// one that never stopped. The turn of the step before is half of what the friction sees.
TEST(TurningWalls, go_on_from_a_checkpoint_bit_for_bit) {
  for (const bool with_mesh : {false, true}) {
    FluidParameters p = turning(2);
    p.initial_velocity.clear();
    if (with_mesh) {
      p.motion.emplace();
      p.motion->angle = {"3*t^2"};
      p.boundaries["inner"] = p.boundaries["outer"] = boundary(BoundaryType::body);
    } else {
      for (const char* name : {"inner", "outer"}) {
        p.boundaries[name] = boundary(BoundaryType::moving_wall);
        p.boundaries[name].rotation.emplace();
        p.boundaries[name].rotation->speed.text = "6*t";
      }
    }
    const auto make = [&] {
      auto run = std::make_unique<FluidParticipant<2>>(distribute(MPI_COMM_WORLD, ring_mesh(4)), p,
                                                       FluidContext{}, MotionLink{});
      run->initialise();
      return run;
    };
    const auto first = make(), second = make();
    take_steps(*first, 0, 3);
    support::SavedState(*first).load_into(*second);
    take_steps(*first, 3, 4);
    take_steps(*second, 3, 4);
    EXPECT_EQ(first->fluid().viscous_force(), second->fluid().viscous_force()) << with_mesh;
    EXPECT_EQ(first->fluid().pressure_force(), second->fluid().pressure_force()) << with_mesh;
    EXPECT_EQ(first->fluid().state().turn, second->fluid().state().turn) << with_mesh;
    EXPECT_NE(moment(first->fluid(), {"inner"}), 0) << with_mesh;
  }
}

/// Steady flow between circles of which the inner turns with omega = 1: torque 4 pi mu omega / (1/R1^2 - 1/R2^2),
/// on both walls the same (Couette 1890); du/dr alone gives 2 mu omega A = 0.6283 less on the inner one.
std::array<double, 2> torques(int n) {
  FluidParameters p = fluid_of(1, mu, 1e-8);
  p.mesh = "ring";
  p.viscous = ViscousTreatment::implicit;
  p.initial_velocity = {{"-y*(-1/3+4/3/(x*x+y*y))"}, {"x*(-1/3+4/3/(x*x+y*y))"}};
  p.boundaries["inner"] = boundary(BoundaryType::moving_wall);
  p.boundaries["inner"].rotation.emplace();
  p.boundaries["inner"].rotation->speed.text = "1";
  p.boundaries["outer"] = boundary(BoundaryType::no_slip);
  FluidCase<2> c(MPI_COMM_WORLD, ring_mesh(n), p);
  c.run(1, 10);
  return {moment(c.fluid(), {"inner"}), moment(c.fluid(), {"outer"})};
}

TEST(TurningWalls, torque_between_circles) {
  const double exact = 16 * std::numbers::pi * mu / 3;
  const auto coarse = torques(6), fine = torques(12);
  for (const int i : {0, 1}) {
    const double sign = i == 0 ? -1 : 1;
    RecordProperty(i == 0 ? "inner" : "outer", std::to_string(fine[i]));
    EXPECT_NEAR(sign * fine[i], exact, 0.004 * exact) << i;
    EXPECT_LT(std::abs(sign * fine[i] - exact), 0.7 * std::abs(sign * coarse[i] - exact)) << i;
  }
}

}  // namespace couplet::fluid::test::turning_walls_test
