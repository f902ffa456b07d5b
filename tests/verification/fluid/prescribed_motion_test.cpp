// SPDX-License-Identifier: Apache-2.0
// A mesh that moves as the case says, in a fluid on its own.
#include "common/mesh/load.hpp"
#include "common/mesh/quality.hpp"
#include "fluid_case.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid::test::prescribed_motion_test {
using namespace mesh;

constexpr double rho = 1.3;

FluidParameters box_of_fluid() {
  FluidParameters p = fluid_of(rho, 0.02, 1e-12, "box");
  p.motion.emplace();
  return p;
}

class Alone {
 public:
  explicit Alone(const FluidParameters& p, int n = 16)
      : participant_(std::make_unique<FluidParticipant<2>>(
            distribute(MPI_COMM_WORLD,
                       parallel::comm_rank(MPI_COMM_WORLD) == 0 ? mesh(n, periodic_patches(p)) : RawMesh{}),
            p, FluidContext{}, MotionLink{})) {
    participant_->initialise();
  }
  void step(double dt) {
    participant_->begin_step({participant_->fluid().state().time, dt, coupling::Scheme::standalone, 0});
    participant_->solve({});
    participant_->accept_step();
  }
  const State<2>& state() const { return participant_->fluid().state(); }
  const Mesh& mesh() const { return participant_->fluid().mesh(); }
  const std::vector<Vec3>& points_at_rest() const { return participant_->fluid().points_at_rest(); }
  double largest(const std::function<double(Index)>& error) const {
    double worst = 0;
    for (Index c = 0; c < mesh().cells.n_owned(); ++c) worst = std::max(worst, std::abs(error(c)));
    return parallel::max(mesh().comm, worst);
  }

 private:
  static RawMesh mesh(int n, std::vector<std::array<std::string, 2>> periodic) {
    RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 1));
    perturb_interior(raw, 0.15, 5);
    raw.periodic = std::move(periodic);
    return raw;
  }
  std::unique_ptr<FluidParticipant<2>> participant_;
};

TEST(PrescribedMotion, fluid_in_a_box_that_swings_moves_with_it) {
  FluidParameters p = box_of_fluid();
  p.motion->translation = {{"0.1*(1-cos(6*t))"}, {"0.05*t^2"}};
  all_sides(p, 2, boundary(BoundaryType::body));
  Alone run(p);
  for (int i = 0; i < 20; ++i) run.step(0.01);
  const double t = run.state().time, u = 0.6 * std::sin(6 * t), v = 0.1 * t;
  EXPECT_LT(run.largest([&](Index c) { return (run.state().u[c] - Vec<2>(u, v)).norm(); }), 1e-5);
  // p = -rho a.x at the middle of the step, up to a constant
  const double middle = t - 0.005, a = (0.6 * std::sin(6 * t) - 0.6 * std::sin(6 * (t - 0.01))) / 0.01;
  EXPECT_NEAR(a, 3.6 * std::cos(6 * middle), 1e-2);
  const auto& gradient = run.state().pressure[0]->gradient;
  EXPECT_LT(run.largest([&](Index c) { return (gradient[c] + rho * Vec<2>(a, 0.1)).norm(); }), 1e-3);
}

TEST(PrescribedMotion, a_uniform_flow_does_not_feel_a_mesh_that_moves_and_turns) {
  FluidParameters p = box_of_fluid();
  p.motion->translation = {{"0.1*sin(3*t)"}, {"0.2*t"}};
  p.motion->angle = {"sin(2*t)"};
  p.motion->centre = Vec3(0.3, 0.4, 0);
  all_sides(p, 2, boundary(BoundaryType::inlet, {"1", "0.5"}));
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.initial_velocity = {{"1"}, {"0.5"}};
  Alone run(p);
  for (int i = 0; i < 20; ++i) run.step(0.02);
  EXPECT_GT((run.state().points[0] - run.points_at_rest()[0]).norm(), 0.05);
  EXPECT_LT(run.largest([&](Index c) { return (run.state().u[c] - Vec<2>(1, 0.5)).norm(); }), 1e-11);
}

TEST(PrescribedMotion, a_body_turns_rigidly_and_what_is_outside_rests) {
  fv::MotionParameters m;
  m.angle = {"t"};
  m.translation = {{"0.02*t"}, {"0"}};
  m.centre = Vec3(0.5, 0.5, 0);
  m.inner_radius = 0.1;
  m.outer_radius = 0.45;
  const fv::PrescribedMotion motion(m, 2);
  const auto [mesh, geometry] =
      distribute(MPI_COMM_SELF, make_box(BoxCells::quadrilaterals, {40, 40, 1}, Vec3::Zero(), Vec3(1, 1, 1)));
  const std::vector<Vec3>& before = geometry.points;
  for (const double angle : {-std::numbers::pi / 3, std::numbers::pi / 3}) {
    const std::vector<Vec3> after = motion.places(before, angle);
    Vec3 centre = m.centre + Vec3(0.02 * angle, 0, 0);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Vec3 d = before[i] - m.centre;
      if (d.norm() > 0.45) {
        EXPECT_EQ(after[i], before[i]);
      } else if (d.norm() < 0.1) {
        const Vec3 turned(std::cos(angle) * d.x() - std::sin(angle) * d.y(),
                          std::sin(angle) * d.x() + std::cos(angle) * d.y(), 0);
        EXPECT_LT((after[i] - centre - turned).norm(), 1e-14);
      }
    }
    EXPECT_FALSE(find_inverted(mesh, compute_geometry(mesh, after)).has_value()) << angle;
  }
  // v = (-w y, w x) + translation about the centre as it is at that time
  const std::vector<Vec3> corner{Vec3(0.55, 0.5, 0)};
  const Vec3 v = motion.velocities(corner, 0.2, 0.1)[0];
  EXPECT_LT((v - Vec3(0.02 - 0.05 * std::sin(0.2), 0.05 * std::cos(0.2), 0)).norm(), 1e-8);
}

/// A frame that is only translated keeps its geometry and its pressure matrix; given as a field of displacements the same motion is
/// that of any mesh.
TEST(PrescribedMotion, of_a_frame_does_what_the_same_motion_of_a_mesh_does) {
  const std::vector<config::ExpressionText> path{{"0.1*(1-cos(6*t))"}, {"0.05*t^2"}};
  const auto run = [&](bool frame) {
    FluidParameters p = box_of_fluid();
    (frame ? p.motion->translation : p.motion->displacement) = path;
    all_sides(p, 2, boundary(BoundaryType::body));
    p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"1+0.6*sin(6*t)", "0.1*t+0.1*sin(20*t)"});
    p.boundaries["xmax"] = boundary(BoundaryType::outlet);
    auto alone = std::make_unique<Alone>(p);
    EXPECT_EQ(p.motion->translates(), frame);
    for (int i = 0; i < 12; ++i) alone->step(0.02);
    return alone;
  };
  const auto frame = run(true), mesh = run(false);
  EXPECT_LT(frame->largest([&](Index c) { return (frame->state().u[c] - mesh->state().u[c]).norm(); }), 1e-7);
  EXPECT_GT(frame->largest([&](Index c) { return frame->state().u[c][1]; }), 0.05);
  EXPECT_LT((frame->state().placement->centre[0] - mesh->state().placement->centre[0]).norm(), 1e-14);
}

/// A box and its fluid that move evenly from the start on: given the fluid's velocity there is no impulse. The walls
/// begin with the velocity of the motion, not at rest, which would make 1.3 * 0.3 / 0.01 Pa/m of it.
TEST(PrescribedMotion, that_goes_on_at_the_start_takes_its_fluid_along) {
  FluidParameters p = box_of_fluid();
  p.motion->translation = {{"0.3*t"}, {"-0.1*t"}};
  p.initial_velocity = {{"0.3"}, {"-0.1"}};
  all_sides(p, 2, boundary(BoundaryType::body));
  Alone run(p);
  for (const double dt : {0.01, 0.02}) {
    run.step(dt);
    EXPECT_LT(run.largest([&](Index c) { return (run.state().u[c] - Vec<2>(0.3, -0.1)).norm(); }), 1e-10);
    EXPECT_LT(run.largest([&](Index c) { return run.state().pressure[0]->p[c]; }), 1e-7);
  }
}

/// Of a motion that grows from rest however slowly there is none; of one that goes on, whatever its time scale.
TEST(PrescribedMotion, velocity_at_the_start) {
  const std::vector<Vec3> at{Vec3(0.5, 0, 0)};
  const auto start = [&](const std::string& x, const std::string& angle) {
    fv::MotionParameters m;
    m.translation = {{x}, {"0"}};
    m.angle = {angle};
    return fv::PrescribedMotion(m, 2).starting_velocities(at, 0, 1)[0];
  };
  EXPECT_LT((start("0.3*t", "0") - Vec3(0.3, 0, 0)).norm(), 1e-9);
  EXPECT_LT((start("0.1*sin(1e6*t)", "0") - Vec3(1e5, 0, 0)).norm(), 1);
  EXPECT_LT((start("max(0,t)", "2*t") - Vec3(1, 1, 0)).norm(), 1e-5);
  for (const char* x : {"0", "t^2", "1-cos(7*t)", "t^1.5", "max(0,t-0.2)", "1e-3*t^3"})
    EXPECT_EQ(start(x, "0").norm(), 0) << x;
}

/// One line says what the first step is.
TEST(PrescribedMotion, an_impulse_at_the_start_is_said) {
  const auto said = [](const std::string& x, bool flows) {
    FluidParameters p = box_of_fluid();
    p.motion->translation = {{x}, {"0"}};
    if (flows) p.initial_velocity = {{"0.3"}, {"0"}};
    all_sides(p, 2, boundary(BoundaryType::body));
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    Alone(p).step(0.01);
    return testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
  };
  const std::string moving = said("0.3*t", false);
  if (parallel::comm_rank(MPI_COMM_WORLD) == 0) {
    EXPECT_THAT(moving, testing::HasSubstr("its bodies already move at 0.3 m/s"));
  }
  EXPECT_THAT(said("0.3*t^2", false), testing::Not(testing::HasSubstr("already")));
  EXPECT_THAT(said("0.3*t", true), testing::Not(testing::HasSubstr("already")));
}

std::string refusal(const FluidParameters& p) {
  return support::error_of([&] { Alone run(p); });
}

TEST(PrescribedMotion, what_cannot_be_is_refused_by_name) {
  FluidParameters p = box_of_fluid();
  all_sides(p, 2, boundary(BoundaryType::body));
  FluidParameters none = p;
  none.motion.reset();
  EXPECT_THAT(refusal(none), testing::HasSubstr("the section 'motion'"));
  p.motion->translation = {{"0.1*cos(t)"}, {"0"}};
  EXPECT_THAT(refusal(p), testing::HasSubstr("displaces the mesh by up to 0.1 m"));
}

/// Volume of a closed unit square after walls and mesh have been displaced by these fields of x, y and t.
double volume_after(const char* x, const char* y) {
  FluidParameters p = box_of_fluid();
  all_sides(p, 2, boundary(BoundaryType::body));
  p.motion->displacement = {{x}, {y}};
  Alone run(p);
  for (int i = 0; i < 10; ++i) run.step(0.02);
  double volume = 0;
  for (Index c = 0; c < run.mesh().cells.n_owned(); ++c) volume += run.state().placement->volume[c];
  return parallel::sum(MPI_COMM_WORLD, volume);
}

/// Cavalieri and Jacobi: shears, rotations and fields of determinant 1 keep the area. Of the bulges the chords of the mesh alone
/// would lose up to 0.3 % of what they displace.
TEST(ClosedFluid, keeps_its_volume_where_the_motion_closes) {
  const std::pair<const char*, const char*> closing[] = {
      {"0.1*(1-cos(6*t))", "0"},
      {"0.3*t*y", "0"},
      {"0", "0.3*t*x"},
      {"0.3*t*x", "-y*0.3*t/(1+0.3*t)"},
      {"x*(cos(t)-1)-y*sin(t)", "x*sin(t)+y*(cos(t)-1)"},
      {"0", "0.2*t*sin(pi*x)"},
      {"0.2*t*sin(pi*y)", "0"},
      {"0", "0.2*t*sin(2*pi*x)*(1-y)"},
      {"0.2*t*y^2", "0.1*t"},
      {"x*(0.4*t/pi)/(1-0.4*t/pi)", "0.2*t*sin(pi*x)*(1-y)"},
      {"0", "0.2*t*(1-y)*(x*(1-x)-1/6)"},
      {"0.2*t*(1-x)*(y^3-1/4)", "0"}};
  for (const auto& [x, y] : closing) EXPECT_NEAR(volume_after(x, y), 1, 1e-10) << x << ", " << y;
}

TEST(ClosedFluid, that_would_change_its_volume_is_refused) {
  const std::pair<const char*, const char*> leaking[] = {
      {"0.1*t*x", "0"},          {"0.2*t*(1-0.18*x)", "0"},
      {"0.2*t*(1-0.05*x)", "0"}, {"0", "0.2*t*sin(pi*x)*(1-y)"},
      {"0.1*t*x", "0.1*t*y"},    {"0", "-0.1*t*y"}};
  for (const auto& [x, y] : leaking) EXPECT_THROW(volume_after(x, y), Error) << x << ", " << y;
}

/// After rest there is only round-off to measure by: nothing diverges when the motion begins.
TEST(PrescribedMotion, may_begin_after_rest) {
  for (const bool turns : {false, true}) {
    FluidParameters p = box_of_fluid();
    p.body_force = {{"0"}, {"-9.81"}};
    if (turns)
      p.motion->angle = {"max(0,t-0.1)^2"};
    else
      p.motion->translation = {{"0.1*max(0,t-0.1)"}, {"0"}};
    all_sides(p, 2, boundary(BoundaryType::body));
    Alone run(p);
    for (int i = 0; i < 15; ++i) run.step(0.02);
    EXPECT_GT(run.largest([&](Index c) { return run.state().u[c].norm(); }), turns ? 0.1 : 0.099);
  }
}

/// The same for an inlet in a fluid that was at rest.
TEST(PrescribedMotion, or_an_inlet_may_begin_after_rest) {
  FluidParameters p = box_of_fluid();
  p.motion.reset();
  p.body_force = {{"0"}, {"-9.81"}};
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, {"max(0,t-0.1)", "0"});
  p.boundaries["xmax"] = boundary(BoundaryType::outlet, {}, "1.3*9.81*(1-y)");
  Alone run(p);
  for (int i = 0; i < 10; ++i) run.step(0.02);
  EXPECT_GT(run.largest([&](Index c) { return run.state().u[c].norm(); }), 0.05);
}

/// Sides that are joined stay so on a mesh that moves: a uniform flow is kept. A motion that parts them is refused.
TEST(PrescribedMotion, of_periodic_sides_repeats_itself) {
  FluidParameters p = box_of_fluid();
  p.initial_velocity = {{"1"}, {"0.5"}};
  for (const auto& [side, other] :
       {std::pair{"xmin", "xmax"}, {"xmax", "xmin"}, {"ymin", "ymax"}, {"ymax", "ymin"}}) {
    p.boundaries[side] = boundary(BoundaryType::periodic);
    p.boundaries[side].partner = other;
  }
  p.motion->displacement = {{"0.04*sin(9*t)*cos(2*pi*x)*sin(2*pi*y)"}, {"0.04*sin(7*t)*sin(2*pi*(x-y))"}};
  Alone run(p);
  for (int i = 0; i < 10; ++i) run.step(0.02);
  EXPECT_LT(run.largest([&](Index c) { return (run.state().u[c] - Vec<2>(1, 0.5)).norm(); }), 1e-11);
  p.motion->displacement = {};
  p.motion->angle = {"0.1*t"};
  Alone torn(p);
  EXPECT_THAT([&] { torn.step(0.02); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("separates the two sides")));
}

TEST(PrescribedMotion, that_turns_cells_over_fails_in_solve) {
  FluidParameters p = box_of_fluid();
  p.motion->displacement = {{"t*sin(40*x)"}, {"0"}};
  all_sides(p, 2, boundary(BoundaryType::no_slip));
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  Alone run(p);
  EXPECT_THROW(run.step(0.5), SolveFailure);
  EXPECT_EQ(run.state().time, 0);
}

/// A plate presses a film out of a gap that it closes to 28 % by 0.8 s: mu V L^3/H^3 per width, in the middle of the step.
TEST(PrescribedMotion, a_squeezed_film_has_the_force_of_lubrication_theory_also_after_a_restart) {
  const double pi = std::numbers::pi, dt = 0.01;
  const auto gap = [&](double t) { return 0.1 * (1 - 0.4 * (1 - std::cos(pi * t))); };
  FluidParameters p = fluid_of(1, 5, 1e-8);
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  p.boundaries["ymin"] = boundary(BoundaryType::no_slip);
  p.boundaries["ymax"] = boundary(BoundaryType::body);
  FluidCase<2> film(
      MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {40, 8, 1}, Vec3::Zero(), Vec3(1, 0.1, 1)), p,
      [&](const Vec3& x, GlobalIndex, double t) { return Vec3(x.x(), x.y() / 0.1 * gap(t), 0); });
  const auto plate = [&](const Vec3&, double t) { return Vec3(0, (gap(t) - gap(t - dt)) / dt, 0); };
  while (film.state().time < 0.79 - 1e-9) film.step(dt, plate);
  const double t = film.state().time;
  Fluid<2> other(film.mesh(), film.geometry(), film.fluid().parameters(), true);
  io::StateInMemory memory;
  {
    io::CheckpointWriter writer(memory);
    film.fluid().solvers().save(writer);
    writer.close();
  }
  other.restore(film.state());
  io::CheckpointReader reader(memory);
  other.solvers().load(reader);
  for (Fluid<2>* fluid : {&film.fluid(), &other}) {
    fluid->begin_step(t, dt);
    fluid->solve(film.points(t + dt), film.wall(plate, t + dt));
    fluid->accept();
    double force = 0;
    const Patch& top = *film.mesh().find_patch("ymax");
    for (Index f = top.first; f < top.first + top.count; ++f)
      force += fluid->pressure_force()[f - film.mesh().n_interior].y();
    const double middle = t + dt / 2, speed = 0.04 * pi * std::sin(pi * middle),
                 theory = 5 * speed / std::pow(gap(middle), 3);
    EXPECT_NEAR(parallel::sum(MPI_COMM_WORLD, force), theory, 0.05 * theory);
  }
  double apart = 0;
  for (std::size_t c = 0; c < other.state().u.size(); ++c)
    apart = std::max(apart, (other.state().u[c] - film.state().u[c]).norm());
  EXPECT_EQ(parallel::max(MPI_COMM_WORLD, apart), 0);
}

}  // namespace couplet::fluid::test::prescribed_motion_test
