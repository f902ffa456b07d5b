// SPDX-License-Identifier: Apache-2.0
// A fluid seen from a frame that turns: against exact flows, and against a mesh that turns.
#include <Eigen/Geometry>

#include "fluid_case.hpp"
#include "participant_case.hpp"
#include "ring_mesh.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::rotating_frame_test {
using namespace mesh;
using namespace parallel;

constexpr double mu = 0.1;

BoundaryParameters turning_wall(const std::string& speed) {
  BoundaryParameters wall = boundary(BoundaryType::moving_wall);
  wall.rotation.emplace();
  wall.rotation->speed.text = speed;
  return wall;
}

void set_frame(FluidParameters& p, const std::string& speed) {
  p.rotating_frame.emplace();
  p.rotating_frame->speed.text = speed;
}

/// A fluid at rest outside the frame goes around in it, u = -omega x r; all forces together are the centripetal ones,
/// omega x (omega x r), and with a frame that spins up the fluid falls behind by d omega/dt.
TEST(RotatingFrame, forces_on_a_fluid_at_rest_outside_of_it) {
  RotationParameters p;
  p.speed.text = "0.5+2*t";
  p.centre = Vec3(0.2, -0.1, 0.4);
  p.axis = Vec3(1, 2, 2);
  const RotatingFrame<3> frame(p);
  const double t = 0.3, dt = 0.1;
  const Vec3 axis = Vec3(1, 2, 2) / 3, omega = (0.5 + 2 * (t + dt / 2)) * axis, x(0.7, 0.3, -0.2),
             r = x - p.centre;
  const Vectors<3> u{-omega.cross(r)};
  Vectors<3> force{Vec3::Zero()};
  frame.add(t, dt, std::vector<Vec3>{x}, u, force);
  Vec3 all = force[0];
  const auto potential = frame.potential(t + dt / 2);
  for (int c = 0; c < 3; ++c)  // the slope of the potential, which is quadratic
    all[c] += (potential(x + Vec3::Unit(c)) - potential(x - Vec3::Unit(c))) / 2;
  EXPECT_LT((all - omega.cross(omega.cross(r)) + 2 * axis.cross(r)).norm(), 1e-13);
  EXPECT_DOUBLE_EQ(frame.rate(t, dt), 2 * 1.3);
}

/// Between circles of which the inner turns with 1 rad/s, from the frame of the inner one (Couette 1890): torque and
/// the pressure of the centripetal force are those seen from outside. The outer wall goes by at twice the speed here,
/// which costs accuracy: of second order in the mesh.
struct BetweenCircles {
  double inner, outer, pressure;  ///< errors; relative for the torques
};
BetweenCircles between_circles(int n) {
  FluidParameters p = fluid_of(1, mu, 1e-8);
  p.mesh = "ring";
  p.viscous = ViscousTreatment::implicit;
  set_frame(p, "1");
  p.initial_velocity = {{"-y*(-4/3+4/3/(x*x+y*y))"}, {"x*(-4/3+4/3/(x*x+y*y))"}};
  p.boundaries["inner"] = boundary(BoundaryType::no_slip);
  p.boundaries["outer"] = turning_wall("-1");
  FluidCase<2> c(MPI_COMM_WORLD, ring_mesh(n), p);
  c.run(1, 10);
  const double exact = 16 * std::numbers::pi * mu / 3;
  return {std::abs(moment(c.fluid(), {"inner"}) / exact + 1),
          std::abs(moment(c.fluid(), {"outer"}) / exact - 1), c.pressure_error([](const Vec3& x) {
            const double r = x.norm();
            return r * r / 18 - 8.0 / 9 * std::log(r) - 8 / (9 * r * r);
          })};
}

TEST(RotatingFrame, flow_between_circles_has_the_torque_and_the_pressure_seen_from_outside) {
  const BetweenCircles coarse = between_circles(10), fine = between_circles(20);
  RecordProperty("inner", std::to_string(fine.inner));
  RecordProperty("outer", std::to_string(fine.outer));
  RecordProperty("pressure", std::to_string(fine.pressure));
  EXPECT_LT(fine.inner, 0.003);
  EXPECT_LT(fine.outer, 0.01);
  EXPECT_LT(fine.outer, 0.4 * coarse.outer);
  EXPECT_LT(fine.pressure, 0.006);  // the range is 1.2 Pa
  EXPECT_LT(fine.pressure, 0.4 * coarse.pressure);
}

/// A box that is spun up with its fluid at rest: its own frame and a mesh that turns see the same flow and loads.
struct SpunUp {
  double moment, force, pressure;  ///< largest difference over the largest value
};
SpunUp spun_up(int n) {
  FluidParameters p = fluid_of(1.3, 0.02, 1e-9, "box");
  const auto mesh = [n] {
    if (comm_rank(MPI_COMM_WORLD) > 0) return RawMesh{};
    return make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3(-0.4, -0.5, 0), Vec3(0.6, 0.5, 0));
  };
  FluidParameters of_frame = p;
  set_frame(of_frame, "2*(1-cos(3*t))");
  all_sides(of_frame, 2, boundary(BoundaryType::no_slip));
  p.motion.emplace();
  p.motion->angle = {"2*(t-sin(3*t)/3)"};
  all_sides(p, 2, boundary(BoundaryType::body));
  FluidParticipant<2> frame(distribute(MPI_COMM_WORLD, mesh()), of_frame, FluidContext{}, MotionLink{}),
      turning(distribute(MPI_COMM_WORLD, mesh()), p, FluidContext{}, MotionLink{});
  SpunUp gap{0, 0, 0};
  double largest = 0, largest_force = 0;
  const auto force = [](const Fluid<2>& fluid) {  // on all walls, whichever way the frame has turned [N]
    Vec<2> whole = Vec<2>::Zero();
    for (const Vec<2>& f : fluid.pressure_force()) whole += f;
    MPI_Allreduce(MPI_IN_PLACE, whole.data(), 2, MPI_DOUBLE, MPI_SUM, fluid.mesh().comm);
    return whole.norm();
  };
  const std::vector<std::string> all{"xmin", "xmax", "ymin", "ymax"};
  const double dt = 0.32 / n;
  for (int i = 0; i * dt < 0.6; ++i) {
    for (FluidParticipant<2>* run : {&frame, &turning}) {
      take_steps(*run, i, i + 1, dt);
    }
    const double a = moment(frame.fluid(), all), b = moment(turning.fluid(), all);
    largest = std::max(largest, std::abs(b));
    const double fa = force(frame.fluid()), fb = force(turning.fluid());
    largest_force = std::max(largest_force, fb);
    if (i * dt > 0.1) {
      gap.moment = std::max(gap.moment, std::abs(a - b));
      gap.force = std::max(gap.force, std::abs(fa - fb));
    }
  }
  const auto in_frame = frame.fluid().pressure()->p, outside = turning.fluid().pressure()->p;
  const Index cells = frame.fluid().mesh().cells.n_owned();
  double mean = 0, difference = 0, range = 0;  // a closed fluid fixes no level
  for (Index c = 0; c < cells; ++c) mean += (in_frame[c] - outside[c]) / (n * n);
  mean = sum(MPI_COMM_WORLD, mean);
  for (Index c = 0; c < cells; ++c) {
    difference = std::max(difference, std::abs(in_frame[c] - outside[c] - mean));
    range = std::max(range, std::abs(outside[c]));
  }
  gap.moment /= largest;
  gap.force /= largest_force;
  gap.pressure = max(MPI_COMM_WORLD, difference) / max(MPI_COMM_WORLD, range);
  return gap;
}

TEST(RotatingFrame, loads_are_those_of_a_mesh_that_turns) {
  const SpunUp coarse = spun_up(8), fine = spun_up(16);
  RecordProperty("gap_of_moment", std::to_string(fine.moment));
  RecordProperty("gap_of_pressure", std::to_string(fine.pressure));
  EXPECT_LT(fine.moment, 0.02);
  RecordProperty("gap_of_force", std::to_string(fine.force));
  EXPECT_LT(fine.force, 0.03);
  EXPECT_LT(fine.pressure, 0.04);
  EXPECT_LT(fine.moment, 0.5 * coarse.moment);
  EXPECT_LT(fine.pressure, 0.5 * coarse.pressure);
}

FluidParameters in_a_box(const std::string& speed) {
  FluidParameters p = fluid_of(1, 0.01, 1e-10, "box");
  set_frame(p, speed);
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  return p;
}

std::unique_ptr<FluidParticipant<2>> box_run(const FluidParameters& p, MPI_Comm comm = MPI_COMM_WORLD) {
  RawMesh raw;
  if (comm_rank(comm) == 0) {
    raw = make_box(BoxCells::quadrilaterals, {10, 8, 1}, Vec3(-0.4, -0.5, 0), Vec3(0.6, 0.5, 0));
    perturb_interior(raw, 0.15, 5);
  }
  return std::make_unique<FluidParticipant<2>>(distribute(comm, raw), p, FluidContext{}, MotionLink{});
}

TEST(RotatingFrame, goes_on_from_a_checkpoint_bit_for_bit_and_alike_on_any_number_of_ranks) {
  const FluidParameters p = in_a_box("3*sin(5*t)");
  const auto straight = box_run(p), first = box_run(p), second = box_run(p),
             alone = box_run(p, MPI_COMM_SELF);
  take_steps(*first, 0, 4);
  support::SavedState(*first).load_into(*second);
  take_steps(*first, 4, 8);
  take_steps(*second, 4, 8);
  EXPECT_EQ(first->fluid().state().u, second->fluid().state().u);
  EXPECT_EQ(first->fluid().pressure_force(), second->fluid().pressure_force());
  take_steps(*alone, 0, 8);
  double largest = 0;
  for (Index c = 0; c < first->fluid().mesh().cells.n_owned(); ++c)
    largest = std::max(largest, first->fluid().state().u[c].norm());
  EXPECT_LT(apart(*first, *alone), 1e-8);
  EXPECT_GT(max(MPI_COMM_WORLD, largest), 0.05);
}

/// The step obeys the Coriolis force: a frame at 40 rad/s cuts it. The force does no work, not even on skewed cells where it
/// dominates friction (omega h^2 / nu = 4, 40): friction slows the fluid down.
TEST(RotatingFrame, its_forces_bound_the_step_and_do_no_work) {
  FluidParameters p = in_a_box("40");
  p.initial_velocity = {{"0.1*y"}, {"-0.1*x"}};
  for (const double viscosity : {0.1, 0.01}) {
    p.viscosity = viscosity;
    const auto run = box_run(p);
    take_steps(*run, 0, 1, 0.05);
    const double first = run->fluid().state().ledger.energy;
    take_steps(*run, 1, 20, 0.05);
    EXPECT_GE(run->fluid().statistics().sub_steps, 20);  // 2 * 40 * 0.05 / (0.8 * 0.25)
    EXPECT_LT(run->fluid().state().ledger.energy, 0.5 * first);
  }
}

std::string refusal(const FluidParameters& p, const std::vector<std::array<std::string, 2>>& periodic = {}) {
  return support::error_of([&] {
    RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3::Ones());
    raw.periodic = periodic;
    FluidParticipant<2>(distribute(MPI_COMM_SELF, raw), p, FluidContext{}, MotionLink{});
  });
}

TEST(RotatingFrame, what_does_not_go_with_it_is_refused_by_name) {
  const FluidParameters good = in_a_box("1");
  EXPECT_EQ(refusal(good), "");
  FluidParameters p = good;
  p.motion.emplace();
  EXPECT_THAT(refusal(p), ::testing::HasSubstr("rotating-frame: the mesh is at rest in the frame"));
  p = good;
  p.rotating_frame->speed.text = "x";
  EXPECT_THAT(refusal(p), ::testing::HasSubstr("rotating-frame.speed: it may depend on t only"));
  p = good;
  for (const auto& [side, other] : {std::pair{"xmin", "xmax"}, {"xmax", "xmin"}}) {
    p.boundaries[side] = boundary(BoundaryType::periodic);
    p.boundaries[side].partner = other;
  }
  EXPECT_THAT(refusal(p, periodic_patches(p)), ::testing::HasSubstr("not shifted along the axis"));
}

}  // namespace couplet::fluid::test::rotating_frame_test
