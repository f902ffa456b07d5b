// SPDX-License-Identifier: Apache-2.0
// Ranks, repetition, coupling schemes and step sizes.
#include "fluid_case.hpp"
#include "participant_case.hpp"
#include "tests/support/saved_state.hpp"

namespace couplet::fluid::test::steps_test {
using namespace mesh;

double bump(double x) { return 0.1 * std::pow(std::sin(std::numbers::pi * x / 2), 2); }
Vec3 floor_place(const Vec3& x, GlobalIndex, double t) {
  return x + Vec3(0, (1 - x.y()) * bump(x.x()) * (1 - std::cos(4 * t)), 0);
}
Vec3 floor_speed(const Vec3& x, double t) { return Vec3(0, 4 * bump(x.x()) * std::sin(4 * t), 0); }

/// Sums over all ranks that tell two runs apart: momentum, kinetic energy, pressure load on the floor.
std::vector<double> fingerprint(FluidCase<2>& c) {
  std::vector<double> sums(6, 0.0);
  const State<2>& s = c.state();
  for (Index i = 0; i < c.mesh().cells.n_owned(); ++i) {
    const double v = s.placement->volume[i];
    const double weight = 1 + std::sin(double(c.mesh().cell_id[i]));
    sums[0] += weight * v * s.u[i].x();
    sums[1] += weight * v * s.u[i].y();
    sums[2] += weight * v * s.pressure[0]->p[i];
  }
  for (std::size_t b = 0; b < s.w.size(); ++b)
    if (c.fluid().boundary().is_interface(b)) {
      const double weight = 1 + s.placement->boundary_centre[b].x();
      sums[3] += weight * c.fluid().pressure_force()[b].y();
      sums[4] += weight * c.fluid().pressure_force()[b].x();
      sums[5] += weight * c.fluid().viscous_force()[b].x();
    }
  for (double& value : sums) value = parallel::sum(c.mesh().comm, value);
  return sums;
}

/// Shear layers that decay, in steps of 2 h and h by turns: with the weights of constant steps AB2 is of
/// first order.
TEST(VariableSteps, keep_second_order_where_every_step_has_another_size) {
  FluidParameters p = fluid_of(1, 0.05, 1e-12);
  p.viscous = ViscousTreatment::explicit_;
  p.time_step = 1;
  all_sides(p, 2, boundary(BoundaryType::slip));
  p.initial_velocity = {{"cos(pi*y)"}, {"0"}};
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::periodic);
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 8, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  raw.periodic = {{"xmin", "xmax"}};
  const auto energy = [&](int pairs) {
    FluidCase<2> c(MPI_COMM_WORLD, raw, p);
    const double h = 2.0 / (3 * pairs);
    for (int i = 0; i < pairs; ++i) c.step(2 * h), c.step(h);
    return c.state().ledger.energy;
  };
  const double exact = energy(640), coarse = energy(20) - exact, fine = energy(40) - exact;
  const double slope = std::log2(coarse / fine);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, 1.8);
  EXPECT_LT(slope, 2.3);
}

/// rho L du/dt = p_in - p_out: the middle of a step has the mean of what grows with time. So slow that the head of what
/// flows in does not count.
TEST(Openings, whose_pressure_grows_with_time_move_a_fluid_without_walls_at_the_middle_of_a_step) {
  FluidParameters p = fluid_of(2, 0.5, 1e-12);
  all_sides(p, 2, boundary(BoundaryType::slip));
  p.boundaries["xmin"] = boundary(BoundaryType::outlet, {}, "3e-5*t");
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "0");
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {6, 4, 1}, Vec3::Zero(), Vec3::Ones()),
                 p);
  c.run(1, 8);
  EXPECT_LT(c.largest_velocity_error([](const Vec3&) { return Vec3(0.75e-5, 0, 0); }), 1e-3 * 0.75e-5);
}

TEST(Ranks, give_the_same_flow_as_one_rank) {
  FluidCase<2> all(MPI_COMM_WORLD, channel_mesh(), channel(), floor_place);
  FluidCase<2> one(MPI_COMM_SELF, channel_mesh(), channel(), floor_place);
  all.run(0.3, 6, floor_speed);
  one.run(0.3, 6, floor_speed);
  const auto a = fingerprint(all), b = fingerprint(one);
  EXPECT_EQ(all.fluid().statistics().all_sub_steps, one.fluid().statistics().all_sub_steps);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-8 * std::abs(b[i])) << "sum " << i;
}

TEST(Repetition, of_a_step_gives_the_same_result_and_leaves_the_accepted_state_alone) {
  FluidCase<2> c(MPI_COMM_WORLD, channel_mesh(), channel(), floor_place);
  c.run(0.1, 2, floor_speed);
  Fluid<2>& fluid = c.fluid();
  const Vectors<2> u = c.state().u;
  const double t = 0.1, dt = 0.05;
  fluid.begin_step(t, dt);
  fluid.solve(c.points(t + dt), c.wall(floor_speed, t + dt));
  const Vectors<2> first = fluid.pressure_force();
  fluid.solve(c.points(t + dt / 2), c.wall(floor_speed, t));  // another input in between
  fluid.solve(c.points(t + dt), c.wall(floor_speed, t + dt));
  const Vectors<2> again = fluid.pressure_force();
  fluid.begin_step(t, dt / 2);  // and another step size
  fluid.solve(c.points(t + dt / 2), c.wall(floor_speed, t + dt / 2));
  fluid.begin_step(t, dt);
  fluid.solve(c.points(t + dt), c.wall(floor_speed, t + dt));
  double scale = 0;
  for (const Vec<2>& f : first) scale = std::max(scale, f.norm());
  for (std::size_t b = 0; b < first.size(); ++b) {
    EXPECT_LT((again[b] - first[b]).norm(), 1e-8 * scale);
    EXPECT_LT((fluid.pressure_force()[b] - first[b]).norm(), 1e-8 * scale);
  }
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_EQ(c.state().u[i], u[i]);
}

// A small motion of an orthogonal mesh: the non-orthogonal parts of the pressure equation are extrapolated,
// so that a pressure that jumps in the last sub-step (prediction error) leaves a first-order rest on strongly
// distorted meshes.
constexpr double small = 0.04;
Vec3 small_place(const Vec3& x, GlobalIndex id, double t) { return x + small * (floor_place(x, id, t) - x); }
Vec3 small_speed(const Vec3& x, double t) { return small * floor_speed(x, t); }
RawMesh straight_mesh() {
  return make_box(BoxCells::quadrilaterals, {24, 12, 1}, Vec3::Zero(), Vec3(2, 1, 1));
}

/// Load of the last step with the semi-implicit sequence: mesh, sub-steps and predictor with an extrapolated
/// wall velocity (wrong by O(dt^2)), the last pressure equation with the true one.
std::vector<double> semi_implicit_run(int steps, double end) {
  const double dt = end / steps;
  FluidParameters p = channel();
  p.time_step = dt / 4;
  FluidCase<2> c(MPI_COMM_WORLD, straight_mesh(), p, small_place);
  for (int i = 0; i < steps; ++i) {
    const double t = i * dt;
    c.fluid().begin_step(t, dt);
    const WallVelocity predicted = [&](const Vec3& x, double) {
      return Vec3(i == 0 ? small_speed(x, t) : Vec3(2 * small_speed(x, t) - small_speed(x, t - dt)));
    };
    c.fluid().prepare(c.points(t + dt), c.wall(predicted, t + dt));
    c.fluid().solve_pressure(c.wall(predicted, t + dt));
    c.fluid().solve_pressure(c.wall(small_speed, t + dt));
    c.fluid().accept();
  }
  return fingerprint(c);
}

TEST(SemiImplicitStep, gives_the_load_of_the_implicit_one_to_second_order) {
  const double end = 0.4;
  double gap[2];
  for (int i = 0; i < 2; ++i) {
    const int steps = 10 << i;
    const auto semi = semi_implicit_run(steps, end);
    FluidParameters p = channel();
    p.time_step = end / steps / 4;
    FluidCase<2> c(MPI_COMM_WORLD, straight_mesh(), p, small_place);
    c.run(end, steps, small_speed);
    gap[i] = std::abs(semi[3] / fingerprint(c)[3] - 1);
  }
  printf("semi-implicit against implicit load: %.2e, half the step %.2e\n", gap[0], gap[1]);
  EXPECT_LT(gap[0], 1e-2);
  EXPECT_LT(gap[1], gap[0] / 3);
}

TEST(AddedMass, impulse_does_not_depend_on_the_number_of_sub_steps) {
  // A closed box that is set in motion within one step: the force is the mass of the fluid times the change
  // of velocity.
  for (const double own_step : {1.0, 0.3, 0.07}) {
    FluidParameters p = fluid_of(2, 0, 1e-12);
    p.viscous = ViscousTreatment::explicit_;
    p.time_step = own_step;
    all_sides(p, 2, boundary(BoundaryType::interface));
    FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {8, 8, 1}, Vec3::Zero(), Vec3::Ones()),
                   p,
                   [](const Vec3& x, GlobalIndex, double t) { return Vec3(x + Vec3(0.05 * t * t, 0, 0)); });
    c.fluid().begin_step(0, 1);
    // Prepared with a wall velocity that is quite wrong, as a prediction may be.
    c.fluid().prepare(c.points(1), c.wall([](const Vec3&, double) { return Vec3(0.06, 0, 0); }, 1));
    c.fluid().solve_pressure(c.wall([](const Vec3&, double) { return Vec3(0.1, 0, 0); }, 1));
    double force = 0;
    for (const Vec<2>& f : c.fluid().pressure_force()) force += f.x();
    EXPECT_NEAR(parallel::sum(MPI_COMM_WORLD, force), -2 * 0.1, 1e-9) << "own step " << own_step;
  }
}

/// By stability alone one implicit sub-step would do.
TEST(ImplicitStretch, bounds_an_implicit_sub_step_in_limits_of_the_explicit_one) {
  FluidParameters p;
  p.density = p.viscosity = 1;
  p.viscous = ViscousTreatment::implicit;
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {8, 8, 1}, Vec3::Zero(), Vec3(1, 1, 1));
  const auto sub_steps = [&](std::optional<double> stretch) {
    p.implicit_stretch = stretch;
    FluidCase<2> c(MPI_COMM_WORLD, raw, p);
    c.step(0.1);
    const StepLimits limits = c.fluid().sizes().limits();
    EXPECT_GT(0.1, 10 * limits.explicit_viscous);
    return std::pair(c.fluid().statistics().sub_steps, 0.1 / (p.safety_factor * limits.explicit_viscous));
  };
  EXPECT_EQ(sub_steps({}).first, 1);
  for (const double stretch : {1., 4.}) {
    const auto [parts, explicit_parts] = sub_steps(stretch);
    EXPECT_EQ(parts, std::ceil(explicit_parts / stretch - 1e-9)) << stretch;
  }
  EXPECT_EQ(sub_steps(1e6).first, 1);
}

/// Vortices carried by a mean flow through columns that are up to 40 times thinner than the mean one. In steps of 0.02 s the
/// Courant number is 15 there and 0.2 elsewhere.
FluidParameters carried_vortices(std::optional<double> courant, std::optional<double> step = {}) {
  FluidParameters p = fluid_of(1, 0.002, 1e-11, "box");
  p.viscous = ViscousTreatment::implicit;
  p.courant = courant;
  p.time_step = step;
  p.initial_velocity = {{"1+0.3*sin(2*pi*x)*cos(pi*y)"}, {"-0.6*cos(2*pi*x)*sin(pi*y)"}};
  all_sides(p, 2, boundary(BoundaryType::slip));
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::periodic);
  return p;
}
RawMesh thin_columns(double share = 0.99) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {20, 12, 1}, Vec3::Zero(), Vec3::Ones());
  raw.periodic = {{"xmin", "xmax"}};
  for (Vec3& x : raw.points) x.x() += share * std::sin(2 * std::numbers::pi * x.x()) / (2 * std::numbers::pi);
  return raw;
}
Vec3 inner_swing(const Vec3& x, GlobalIndex, double t) {
  const double shape = std::sin(std::numbers::pi * x.x()) * std::sin(std::numbers::pi * x.y());
  return x + Vec3(0, 0.05 * shape * shape * std::sin(5 * t), 0);
}

TEST(ImplicitConvection, is_of_second_order_in_time_where_explicit_one_fails) {
  const double end = 0.4;
  const auto after = [&](int steps, const PointMotion& motion, std::optional<double> courant) {
    auto c = std::make_unique<FluidCase<2>>(MPI_COMM_SELF, thin_columns(),
                                            carried_vortices(courant, end / steps), motion);
    c->run(end, steps);
    return c;
  };
  EXPECT_THROW(after(20, {}, {}), SolveFailure);
  for (const PointMotion& motion : {PointMotion(), PointMotion(inner_swing)}) {
    std::vector<std::unique_ptr<FluidCase<2>>> runs;
    for (const int steps : {20, 40, 80, 160}) runs.push_back(after(steps, motion, 20));
    const double d[3] = {difference(*runs[0], *runs[1]), difference(*runs[1], *runs[2]),
                         difference(*runs[2], *runs[3])};
    printf("implicit convection: %.2e %.2e %.2e\n", d[0], d[1], d[2]);
    RecordProperty(motion ? "slope_moving" : "slope", std::to_string(std::log2(d[1] / d[2])));
    EXPECT_GE(std::log2(d[1] / d[2]), 1.8);
  }
}

TEST(ImplicitConvection, keeps_a_uniform_flow_on_a_moving_mesh_and_cells_that_do_not_need_it) {
  FluidParameters uniform = carried_vortices(20, 0.04);
  uniform.initial_velocity = {{"1"}, {"0"}};
  FluidCase<2> c(MPI_COMM_WORLD, thin_columns(), uniform, inner_swing);
  c.run(0.4, 10);
  EXPECT_LT(c.largest_velocity_error([](const Vec3&) { return Vec3(1, 0, 0); }), 1e-9);
  const auto few = [](std::optional<double> courant) {
    auto slow =
        std::make_unique<FluidCase<2>>(MPI_COMM_WORLD, thin_columns(0), carried_vortices(courant, 0.01));
    slow->run(0.1, 10);
    return slow->state().u;
  };
  EXPECT_EQ(few(20), few({}));
}

TEST(ImplicitConvection, goes_on_from_a_checkpoint_bit_for_bit_and_alike_on_any_number_of_ranks) {
  const auto make = [](std::optional<double> courant, MPI_Comm comm = MPI_COMM_WORLD) {
    return std::make_unique<FluidParticipant<2>>(
        distribute(comm, parallel::comm_rank(comm) == 0 ? thin_columns() : RawMesh()),
        carried_vortices(courant), FluidContext{}, MotionLink{});
  };
  const auto first = make(20), second = make(20), alone = make(20, MPI_COMM_SELF), many = make({});
  take_steps(*first, 0, 4);
  support::SavedState(*first).load_into(*second);
  take_steps(*first, 4, 8);
  take_steps(*second, 4, 8);
  EXPECT_EQ(first->fluid().state().u, second->fluid().state().u);
  take_steps(*alone, 0, 8);
  take_steps(*many, 0, 8);
  EXPECT_EQ(first->fluid().statistics().all_sub_steps, 8);
  EXPECT_GT(many->fluid().statistics().all_sub_steps, 8 * 10);
  const double ranks = apart(*first, *alone);
  double steps = 0;
  for (Index c = 0; c < first->fluid().mesh().cells.n_owned(); ++c)
    steps = std::max(steps, (first->fluid().state().u[c] - many->fluid().state().u[c]).norm());
  printf("implicit convection: %.2e from one rank, %.2e from %ld sub-steps\n", ranks, steps,
         many->fluid().statistics().all_sub_steps);
  EXPECT_LT(ranks, 1e-7);
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, steps), 0.02);
}

TEST(ImpulsiveStart, loads_the_first_step_with_the_impulse_of_the_fluid_set_in_motion) {
  // A plug of fluid, 2 m long, set in motion by an inlet that is switched on at t = 0; the floor feels its
  // pressure.
  FluidParameters p = fluid_of(3, 0, 1e-12);
  p.viscous = ViscousTreatment::explicit_;
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"0.5", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymin"] = boundary(BoundaryType::interface);
  p.boundaries["ymax"] = boundary(BoundaryType::slip);
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {20, 4, 1}, Vec3::Zero(), Vec3(2, 1, 1)),
                 p);
  for (const double dt : {1e-3, 1e-4}) {  // the impulse does not depend on the step it is spread over
    c.fluid().begin_step(0, dt);
    c.fluid().solve({}, c.wall({}, dt));
    double impulse = 0;
    for (std::size_t b = 0; b < c.state().w.size(); ++b)
      if (c.fluid().boundary().is_interface(b)) impulse += dt * c.fluid().pressure_force()[b].y();
    // psi falls linearly from rho U L at the inlet to 0: on the floor, length L, downwards.
    EXPECT_NEAR(parallel::sum(MPI_COMM_WORLD, impulse), -3 * 0.5 * 2 * 2 / 2, 1e-6);
  }
  c.fluid().accept();
  c.step(1e-4);  // from then on the flow is steady
  double force = 0;
  for (const Vec<2>& f : c.fluid().pressure_force()) force = std::max(force, f.norm());
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, force), 1e-6);
}

TEST(Poiseuille, profile_and_pressure_drop_are_kept_in_a_channel) {
  FluidParameters p = fluid_of(1.3, 0.4, 1e-8);
  p.initial_velocity = {{"4*y*(1-y)"}, {"0"}};
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"4*y*(1-y)", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  FluidCase<2> c(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {40, 20, 1}, Vec3::Zero(), Vec3(2, 1, 1)),
                 p);
  c.run(3, 10);
  EXPECT_LT(c.velocity_error([](const Vec3& x) { return Vec3(4 * x.y() * (1 - x.y()), 0, 0); }), 3e-3);
  EXPECT_LT(c.pressure_error([](const Vec3& x) { return 8 * 0.4 * (2 - x.x()); }), 0.02 * 8 * 0.4);
}

}  // namespace couplet::fluid::test::steps_test
