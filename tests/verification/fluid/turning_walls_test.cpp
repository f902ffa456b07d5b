// SPDX-License-Identifier: Apache-2.0
// Friction on walls that turn: the whole of mu (grad u + grad u^T).
#include <gmock/gmock.h>
#include <Eigen/Geometry>

#include <numbers>

#include "common/parallel/collective.hpp"
#include "fluid_case.hpp"
#include "fluid_solver/derived.hpp"
#include "fluid_solver/participant.hpp"
#include "fluid_solver/turning_walls.hpp"

namespace couplet::fluid::test {
namespace {

constexpr double mu = 0.1;

template <int D>
RawMesh box(BoxCells cells) {
  if (comm_rank(MPI_COMM_WORLD) > 0) return {};
  RawMesh raw = make_box(cells, D == 2 ? std::array<Index, 3>{8, 8, 1} : std::array<Index, 3>{3, 3, 3},
                         Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.5, 0.5));
  perturb_interior(raw, 0.15, 5);
  return raw;
}

/// Between circles of radius 1 and 2, n cells across.
RawMesh ring(int n) {
  if (comm_rank(MPI_COMM_WORLD) > 0) return {};
  const int around = 8 * n;
  RawMesh raw;
  raw.dim = 2;
  raw.patches = {"inner", "outer"};
  raw.zones = {"fluid"};
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i < around; ++i) {
      const double r = 1 + double(j) / n, angle = 2 * std::numbers::pi * i / around;
      raw.points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0);
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < around; ++i) {
      const Index a = j * around + i, b = j * around + (i + 1) % around;
      raw.cell_type.push_back(CellType::quadrilateral);
      raw.cell_points.push_row(std::vector<Index>{a, a + around, b + around, b});
      raw.cell_zone.push_back(0);
    }
  for (const int j : {0, n})
    for (int i = 0; i < around; ++i) {
      raw.boundary_points.push_row(std::vector<Index>{j * around + i, j * around + (i + 1) % around});
      raw.boundary_patch.push_back(j == 0 ? 0 : 1);
    }
  return raw;
}

TEST(TurningWalls, stokes_theorem_gives_minus_omega_cross_the_area) {
  const Mesh mesh = distribute(MPI_COMM_WORLD, box<3>(BoxCells::tetrahedra));
  const Vec3 omega(0.3, -1.1, 0.7), shift(2, 1, -1);
  for (const Patch& patch : mesh.patches) {
    std::vector<Vec3> velocities;
    for (Index f = patch.first; f < patch.first + patch.count; ++f)
      for (const Index v : mesh.face_points[f])
        velocities.push_back(shift + omega.cross(mesh.reference_points[v]));
    Vectors<3> turn(mesh.boundary.n_owned(), Vec3::Zero());
    set_turn<3>(mesh, patch, mesh.reference_points, velocities, turn);
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const Vec3& area = mesh.reference.face_area[f];
      EXPECT_LT((turn[f - mesh.n_interior] + omega.cross(area)).norm(), 1e-14);
      EXPECT_NEAR(turning_force<3>(mu, turn[f - mesh.n_interior], area).dot(area), 0, 1e-16);
    }
  }
}

/// A wall that stretches, u = (x, -y): du/dn on y = const is -1 along the normal, twice mu of it the stress.
TEST(TurningWalls, a_wall_that_stretches_feels_twice_the_normal_slope) {
  const std::vector<Vec3> corners{Vec3(0, 0, 0), Vec3(0.2, 0, 0)}, velocities{Vec3(0, 0, 0), Vec3(0.2, 0, 0)};
  const Vec<2> area(0, -0.2);
  const Vec<2> force = turning_force<2>(mu, turn_of<2>(corners, velocities), area);
  EXPECT_NEAR(force[0], 0, 1e-16);
  EXPECT_NEAR(force[1], -2 * mu * 0.2, 1e-16);  // -mu 2 (dv/dy) S_y = -mu 2 (-1)(-0.2)
}

FluidParameters turning(int dim) {
  FluidParameters p;
  p.mesh = "box";
  p.dimension = dim;
  p.density = 1;
  p.viscosity = mu;
  p.pressure_tolerance = 1e-12;
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
  return max(MPI_COMM_WORLD, worst);
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

double moment(const Fluid<2>& fluid, const char* patch) {
  CoefficientParameters wanted;
  wanted.patches = {patch};
  wanted.speed = std::sqrt(2.0);  // rho/2 U^2 A L = 1
  return force_coefficients(fluid, wanted).moment;
}

/// The same with a mesh that turns, and its walls as bodies; du/dn alone gives -2 mu omega A = -0.314, 1.257.
TEST(TurningWalls, no_friction_between_bodies_that_turn_with_their_fluid) {
  FluidParameters p = turning(2);
  p.motion.emplace();
  p.motion->angle = {"0.5*t"};
  p.boundaries["inner"] = p.boundaries["outer"] = boundary(BoundaryType::body);
  FluidParticipant<2> run(distribute(MPI_COMM_WORLD, ring(6)), p, FluidContext{}, MotionLink{});
  run.initialise();
  for (int i = 0; i < 20; ++i) {  // until the impulse of the start is forgotten
    run.begin_step({0.02 * i, 0.02, Scheme::standalone, i});
    run.solve({});
    run.accept_step();
  }
  EXPECT_NEAR(moment(run.fluid(), "inner"), 0, 0.02);
  EXPECT_NEAR(moment(run.fluid(), "outer"), 0, 0.06);
}

/// Steady flow between circles of which the inner turns with omega = 1: torque 4 pi mu omega / (1/R1^2 - 1/R2^2),
/// on both walls the same (Couette 1890); du/dr alone gives 2 mu omega A = 0.6283 less on the inner one.
std::array<double, 2> torques(int n) {
  FluidParameters p;
  p.mesh = "ring";
  p.density = 1;
  p.viscosity = mu;
  p.pressure_tolerance = 1e-8;
  p.viscous = ViscousTreatment::implicit;
  p.initial_velocity = {{"-y*(-1/3+4/3/(x*x+y*y))"}, {"x*(-1/3+4/3/(x*x+y*y))"}};
  p.boundaries["inner"] = boundary(BoundaryType::moving_wall);
  p.boundaries["inner"].rotation.emplace();
  p.boundaries["inner"].rotation->speed.text = "1";
  p.boundaries["outer"] = boundary(BoundaryType::no_slip);
  FluidCase<2> c(MPI_COMM_WORLD, ring(n), p);
  c.run(1, 10);
  return {moment(c.fluid(), "inner"), moment(c.fluid(), "outer")};
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

}  // namespace
}  // namespace couplet::fluid::test
