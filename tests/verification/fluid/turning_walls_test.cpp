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

// A thin body that is wet on both sides: the Robin condition lets its two sides move together.

constexpr double thickness = 0.1, mass = 0.4, push = 7, dt = 0.01;  // [m], [kg/m^2] of both sides, [Pa], [s]

/// Two boxes of height 1 m above each other; between them is the body. Patches of the upper one begin with "up".
RawMesh two_boxes(int dim, int below, int above) {
  const BoxCells cells = dim == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra;
  RawMesh raw = mesh::make_box(cells, {below, 5, dim == 2 ? 1 : below}, Vec3::Zero(), Vec3::Ones());
  const RawMesh upper = mesh::make_box(cells, {above, 5, dim == 2 ? 1 : above}, Vec3(0, 1 + thickness, 0),
                                       Vec3(1, 2 + thickness, 1));
  const auto patches = static_cast<int>(raw.patches.size());
  const std::size_t first = raw.boundary_patch.size();
  raw = support::beside(std::move(raw), upper);
  for (std::size_t b = first; b < raw.boundary_patch.size(); ++b) raw.boundary_patch[b] += patches;
  for (const std::string& name : upper.patches) raw.patches.push_back("up" + name);
  return raw;
}

FluidParameters parameters(int dim, Sides sides) {
  FluidParameters p = fluid_of(1.3, 1e-6, 1e-12);
  for (const std::string box : {"", "up"})
    for (const std::string side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
      if (dim == 3 || side[0] != 'z') p.boundaries[box + side] = boundary(BoundaryType::slip);
  p.boundaries["ymin"] = boundary(BoundaryType::outlet, {}, std::to_string(push));
  p.boundaries["upymax"] = boundary(BoundaryType::outlet);
  for (const char* wall : {"ymax", "upymin"}) {
    p.boundaries[wall] = boundary(BoundaryType::interface);
    p.boundaries[wall].surface_density = mass / 2;
    p.boundaries[wall].sides = sides;
  }
  return p;
}

struct Speeds {
  double least = 1e9, largest = -1e9, mean = 0;
};

/// Of the two sides after one step, if the structure has answered to no load with rest.
template <int D>
std::array<Speeds, 2> speeds(const RawMesh& raw, Sides sides) {
  FluidCase<D> c(MPI_COMM_WORLD, raw, parameters(D, sides));
  c.fluid().begin_step(0, dt);
  c.fluid().yield_from(std::vector<double>(std::size_t(c.mesh().boundary.n_owned()), 0.));
  c.fluid().solve({}, {});
  c.fluid().accept();
  std::array<Speeds, 2> result;
  for (const mesh::Patch& patch : c.mesh().patches) {
    if (patch.name != "ymax" && patch.name != "upymin") continue;
    Speeds& side = result[patch.name == "ymax" ? 0 : 1];
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const double area = c.geometry().face_area[f][1], w = c.state().phi[f] / area;
      side.least = std::min(side.least, w), side.largest = std::max(side.largest, w);
      side.mean += std::abs(area) * w;  // over 1 m^2
    }
  }
  for (Speeds& side : result)
    side = {parallel::min(MPI_COMM_WORLD, side.least), parallel::max(MPI_COMM_WORLD, side.largest),
            parallel::sum(MPI_COMM_WORLD, side.mean)};
  return result;
}

// The body and the two columns of fluid are one mass: w = p dt/(m + 2 rho H).
constexpr double together = push * dt / (mass + 2 * 1.3);

template <int D>
void expect_one_body(const RawMesh& raw) {
  for (const Speeds& side : speeds<D>(raw, Sides::together)) {
    EXPECT_NEAR(side.least, together, 1e-9);
    EXPECT_NEAR(side.largest, together, 1e-9);
  }
}

TEST(TwoSidedWalls, move_as_one_body) {
  expect_one_body<2>(two_boxes(2, 6, 6));
  expect_one_body<3>(two_boxes(3, 4, 4));
}

// Faces that do not match share their areas by samples: each moves a little otherwise, which the structure's answer
// cures; both sides push the same volume.
template <int D>
void expect_one_volume(const RawMesh& raw) {
  const auto w = speeds<D>(raw, Sides::together);
  EXPECT_NEAR(w[0].mean, together, 0.01 * together);
  EXPECT_NEAR(w[1].mean, w[0].mean, 0.01 * together);
  EXPECT_GT(w[0].least, 0.5 * together);
  EXPECT_LT(w[1].largest, 1.5 * together);
}

TEST(TwoSidedWalls, faces_that_do_not_match) {
  expect_one_volume<2>(two_boxes(2, 6, 9));
  expect_one_volume<3>(two_boxes(3, 4, 6));
}

/// Only the side that is pushed moves, with half the mass.
void expect_apart(const std::array<Speeds, 2>& w) {
  const double alone = push * dt / (mass / 2 + 1.3);
  EXPECT_NEAR(w[0].least, alone, 1e-9);
  EXPECT_NEAR(w[0].largest, alone, 1e-9);
  EXPECT_NEAR(w[1].least, 0, 1e-9);
  EXPECT_NEAR(w[1].largest, 0, 1e-9);
}

// The neighbour: each side for itself.
TEST(TwoSidedWalls, apart_each_has_its_own_motion) {
  expect_apart(speeds<2>(two_boxes(2, 6, 6), Sides::apart));
}

/// A box of 8 x 8 cells, closed, without the cells that a plate takes in its midst.
RawMesh box_around_plate() {
  RawMesh raw = mesh::make_box(BoxCells::quadrilaterals, {8, 8, 1}, Vec3::Zero(), Vec3::Ones());
  const auto in_plate = [&](const Vec3& x) {
    return std::abs(x[0] - 0.5) < 0.3 && std::abs(x[1] - 0.5625) < 0.1;
  };
  std::map<std::set<Index>, int> sides;  // edges of the plate's cells: how many of these
  RawMesh kept = raw;
  kept.cell_points = {};
  kept.cell_type.clear(), kept.cell_zone.clear();
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    const auto corners = raw.cell_points[c];
    Vec3 centre = Vec3::Zero();
    for (const Index v : corners) centre += raw.points[std::size_t(v)] / 4;
    if (in_plate(centre)) {
      for (std::size_t i = 0; i < 4; ++i) ++sides[{corners[i], corners[(i + 1) % 4]}];
      continue;
    }
    kept.cell_points.push_row(corners);
    kept.cell_type.push_back(raw.cell_type[std::size_t(c)]),
        kept.cell_zone.push_back(raw.cell_zone[std::size_t(c)]);
  }
  for (const auto& [side, count] : sides)
    if (count == 1) {
      kept.boundary_points.push_row(std::vector<Index>(side.begin(), side.end()));
      kept.boundary_patch.push_back(int(kept.patches.size()));
    }
  kept.patches.push_back("plate");
  return kept;
}

// Two sides that move as one say nothing of the level of the pressure: without an outlet each side yields by itself.
TEST(TwoSidedWalls, closed_fluids_keep_their_sides_apart) {
  const auto pressure = [](Sides sides) {
    FluidParameters p = fluid_of(1.3, 1e-6, 1e-12);
    all_sides(p, 2, boundary(BoundaryType::slip));
    p.boundaries["plate"] = boundary(BoundaryType::interface);
    p.boundaries["plate"].surface_density = mass / 2;
    p.boundaries["plate"].sides = sides;
    FluidCase<2> c(MPI_COMM_WORLD, box_around_plate(), p);
    std::vector<double> loads(std::size_t(c.mesh().boundary.n_owned()), 0.);
    for (std::size_t b = 0; b < loads.size(); ++b)
      loads[b] = push * std::max(0., c.geometry().face_area[c.mesh().n_interior + Index(b)][1]);
    c.fluid().begin_step(0, dt);
    c.fluid().yield_from(loads);
    c.fluid().solve({}, {});
    return c.fluid().boundary_pressure();
  };
  const std::vector<double> as_one = pressure(Sides::automatic);
  EXPECT_EQ(as_one, pressure(Sides::apart));
  EXPECT_THROW(pressure(Sides::together), Error);
  double most = 0;
  for (const double p : as_one) most = std::max(most, std::abs(p));
  most = parallel::max(MPI_COMM_WORLD, most);
  EXPECT_GT(most, 0.01 * push);
  EXPECT_LT(most, 10 * push);
}

// Another body's wet side, further along, is not this one's.
TEST(TwoSidedWalls, bodies_side_by_side_do_not_see_each_other) {
  RawMesh raw = two_boxes(2, 6, 6);
  for (Vec3& x : raw.points)
    if (x[1] > 1 + thickness / 2) x[0] += 1.02;
  expect_apart(speeds<2>(raw, Sides::automatic));
  EXPECT_THROW(speeds<2>(raw, Sides::together), Error);
}

// A body that is thicker than a quarter of the walls' extent is not seen through: sides apart.
TEST(TwoSidedWalls, thick_body_has_two_sides_of_its_own) {
  RawMesh raw = two_boxes(2, 6, 6);
  for (Vec3& x : raw.points)
    if (x[1] > 1 + thickness / 2) x[1] += 0.5;
  expect_apart(speeds<2>(raw, Sides::automatic));
  EXPECT_THROW(speeds<2>(raw, Sides::together), Error);
}

}  // namespace couplet::fluid::test::turning_walls_test
