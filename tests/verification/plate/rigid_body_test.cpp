// SPDX-License-Identifier: Apache-2.0
// Rigid bodies: closed forms, conservation of energy and momentum, order in time, stops, surfaces and loads.
#include "plate_modal/body/rigid_body.hpp"

#include "common/config/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::plate::rigid_body_test {

constexpr double pi = std::numbers::pi;

/// A body that moves on its own, without surface and loads.
struct BodyRun {
  BodyMotion motion;
  BodyState now, next;

  explicit BodyRun(const BodyParameters& p, const Vec3& gravity = Vec3::Zero(),
                   const Vec3& velocity = Vec3::Zero())
      : motion(p, gravity), now(motion.start(velocity)), next(now) {}
  void step(double dt, const BodyLoad& load = {}) {
    motion.step(now, dt, load, next);
    std::swap(now, next);
  }
  void advance(double until, int steps) {
    for (int i = 0; i < steps; ++i) step(until / steps);
  }
};

BodyParameters free_body() {
  BodyParameters p;
  p.mass = 2;
  p.inertia = {1, 2, 3};
  return p;
}

/// Orders between runs with n, 2 n, 4 n steps.
template <class ErrorOf>
double slope_of(const ErrorOf& error_of, int n) {
  const double coarse = error_of(n), fine = error_of(4 * n);
  return std::log2(coarse / fine) / 2;
}

TEST(RigidBody, free_fall_is_exact) {
  BodyRun run(free_body(), Vec3(0, 0, -9.81), Vec3(1, 2, 3));
  run.advance(2, 7);
  EXPECT_NEAR(run.now.translation.x(), 2, 1e-13);
  EXPECT_NEAR(run.now.translation.y(), 4, 1e-13);
  EXPECT_NEAR(run.now.translation.z(), 6 - 0.5 * 9.81 * 4, 1e-12);
  EXPECT_LT(std::abs(run.now.energies.mismatch()), 1e-12 * run.now.energies.kinetic);
}

TEST(RigidBody, a_tumbling_body_keeps_energy_and_angular_momentum) {
  BodyParameters p = free_body();
  p.initial_angular_velocity = Vec3(0.01, 2, 0.02);  // about the axis of the middle moment, which is unstable
  BodyRun run(p);
  const Vec3 momentum = run.motion.angular_momentum(run.now);
  const double energy = run.now.energies.kinetic;
  double lost = 0, turned_over = 1, worst_momentum = 0, quaternion = 0;
  for (int i = 0; i < 4000; ++i) {
    run.step(0.02);
    lost = std::max(lost, std::abs(run.now.energies.kinetic / energy - 1));
    worst_momentum =
        std::max(worst_momentum, (run.motion.angular_momentum(run.now) - momentum).norm() / momentum.norm());
    quaternion = std::max(quaternion, std::abs(run.now.orientation.norm() - 1));
    turned_over = std::min(turned_over, run.now.spin.y() / 2);
  }
  EXPECT_LT(turned_over, -0.99);  // the body flips (Dzhanibekov)
  EXPECT_LT(lost, 1e-11);
  EXPECT_LT(worst_momentum, 1e-11);
  EXPECT_LT(quaternion, 1e-15);
  RecordProperty("energy", fmt::format("{:.1e}", lost));
  RecordProperty("momentum", fmt::format("{:.1e}", worst_momentum));
}

TEST(RigidBody, the_rotation_of_a_free_body_is_of_second_order) {
  BodyParameters p = free_body();
  p.initial_angular_velocity = Vec3(0.5, 2, 0.3);
  const auto at_end = [&](int steps) {
    BodyRun run(p);
    run.advance(10, steps);
    return run.now.rotation();
  };
  const Tensor3 fine = at_end(64000);
  const double slope = slope_of([&](int n) { return (at_end(n) - fine).norm(); }, 1000);
  EXPECT_NEAR(slope, 2, 0.05);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
}

/// A body of 3 kg whose center is 0.5 m from a hinge about z, at this angle from the downward vertical.
BodyParameters pendulum(double angle) {
  BodyParameters p;
  p.dimension = 2;
  p.mass = 3;
  p.inertia = {0.2};
  p.hinge.emplace().point = Vec3(1, 2, 0);
  p.center_of_mass = p.hinge->point + 0.5 * Vec3(std::sin(angle), -std::cos(angle), 0);
  return p;
}

TEST(RigidBody, a_pendulum_has_the_period_of_the_elliptic_integral_at_large_swings) {
  const double angle = 150 * pi / 180, about_hinge = 0.2 + 3 * 0.25, g = 9.81;
  const double period = 4 * std::sqrt(about_hinge / (3 * g * 0.5)) * std::comp_ellint_1(std::sin(angle / 2));
  double lost = 0;
  const auto error_of = [&](int steps) {
    BodyRun run(pendulum(angle), Vec3(0, -g, 0));
    // Time of the fifth passage of the lowest point, 9/4 periods, by Newton's step within the time step.
    const double dt = period / steps;
    double time = 0, passed = 0;
    for (int passages = 0; passages < 5; time += dt) {
      const double before = angle + run.now.turned.z();
      run.step(dt);
      const double after = angle + run.now.turned.z();
      lost = std::max(lost, std::abs(run.now.energies.mismatch()) / (3 * g * 0.5));
      if (before * after > 0) continue;
      ++passages;
      passed = time + dt - after / run.now.spin.z();
    }
    return std::abs(passed / (2.25 * period) - 1);
  };
  const double slope = slope_of(error_of, 200);
  EXPECT_NEAR(slope, 2, 0.1);
  EXPECT_LT(error_of(800), 2e-4);
  EXPECT_LT(lost, 1e-10);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
  RecordProperty("period-800", fmt::format("{:.2e}", error_of(800)));
  RecordProperty("energy", fmt::format("{:.1e}", lost));
}

TEST(RigidBody, a_damped_spring_follows_its_closed_form) {
  BodyParameters p = free_body();
  p.held = {"x", "z", "rotation-x", "rotation-y", "rotation-z"};
  p.springs.emplace().translation = Vec3(0, 50, 0);
  p.springs->rest_translation = Vec3(0, 0.1, 0);
  p.dampers.emplace().translation = Vec3(0, 2, 0);
  const double decay = 2. / (2 * 2), omega = std::sqrt(50. / 2 - decay * decay), t = 3;
  const double exact =
      0.1 - 0.1 * std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
  double mismatch = 0;
  const auto error_of = [&](int steps) {
    BodyRun run(p);
    run.advance(t, steps);
    mismatch = std::max(mismatch, std::abs(run.now.energies.mismatch()));
    return std::abs(run.now.translation.y() - exact);
  };
  const double slope = slope_of(error_of, 200);
  EXPECT_NEAR(slope, 2, 0.05);
  EXPECT_LT(error_of(800), 1e-4 * 0.1);
  EXPECT_LT(mismatch, 1e-13);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
}

TEST(RigidBody, a_torsional_spring_is_linear_in_the_angle_beyond_half_a_turn) {
  BodyParameters p = pendulum(0);
  p.springs.emplace().rotation = {4};
  p.springs->rest_rotation = {1.5 * pi};  // swings to a turn and a half
  p.dampers.emplace().rotation = {0.3};
  const double inertia = 0.95, decay = 0.3 / (2 * inertia), omega = std::sqrt(4 / inertia - decay * decay),
               t = 5;
  const double exact =
      1.5 * pi * (1 - std::exp(-decay * t) * (std::cos(omega * t) + decay / omega * std::sin(omega * t)));
  double mismatch = 0;
  const auto error_of = [&](int steps) {
    BodyRun run(p);
    run.advance(t, steps);
    mismatch = std::max(mismatch, std::abs(run.now.energies.mismatch()));
    return std::abs(run.now.turned.z() - exact);
  };
  const double slope = slope_of(error_of, 500);
  EXPECT_NEAR(slope, 2, 0.1);
  EXPECT_LT(mismatch, 1e-10);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
}

TEST(RigidBody, springs_about_three_axes_conserve_energy) {
  BodyParameters p = free_body();
  p.springs.emplace().rotation = {3, 5, 8};
  p.springs->translation = Vec3(10, 20, 5);
  p.initial_angular_velocity = Vec3(1.5, -1, 2);
  BodyRun run(p, Vec3(0, 0, -9.81), Vec3(0.3, 0, 0));
  double lost = 0, largest = 0;
  for (int i = 0; i < 2000; ++i) {
    run.step(0.02);
    lost = std::max(lost, std::abs(run.now.energies.mismatch()));
    largest = std::max(largest, run.now.turned.norm());
  }
  EXPECT_GT(largest, 1);  // rotations are large
  EXPECT_LT(lost / run.now.energies.total(), 1e-10);
  RecordProperty("energy", fmt::format("{:.1e}", lost / run.now.energies.total()));
}

/// An airfoil section: plunge along y and pitch about a point ahead of the center of mass.
BodyParameters section() {
  BodyParameters p;
  p.dimension = 2;
  p.mass = 5;
  p.inertia = {0.6};
  p.center_of_mass = Vec3(0.3, 0, 0);
  p.reference_point = {0.1, 0, 0};
  p.held = {"x"};
  p.springs.emplace().translation = Vec3(0, 200, 0);
  p.springs->rotation = {40};
  return p;
}

TEST(RigidBody, a_section_that_plunges_and_pitches_has_its_coupled_frequencies) {
  // [m, m d; m d, I + m d^2] q'' + diag(k, kt) q = 0 at small amplitudes.
  const double m = 5, d = 0.2, about = 0.6 + m * d * d, k = 200, kt = 40;
  const double a = m * about - m * m * d * d, b = -(m * kt + about * k), c = k * kt;
  const double slow = std::sqrt((-b - std::sqrt(b * b - 4 * a * c)) / (2 * a));
  // In the slow mode the angle is (k - m w^2) / (m d w^2) times the deflection.
  const double ratio = (k - m * slow * slow) / (m * d * slow * slow);
  BodyParameters p = section();
  p.springs->rest_translation = Vec3(0, -1e-6, 0);
  p.springs->rest_rotation = {-1e-6 * ratio};
  const auto error_of = [&](int steps) {
    BodyRun run(p);
    run.advance(2.25 * 2 * pi / slow, steps);
    const double y = run.now.translation.y() + 1e-6, phi = run.now.turned.z() + 1e-6 * ratio;  // both are 0
    return std::abs(y) / 1e-6 + std::abs(phi / ratio) / 1e-6;
  };
  const double slope = slope_of(error_of, 400);
  EXPECT_NEAR(slope, 2, 0.1);
  EXPECT_LT(error_of(1600), 1e-3);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
}

TEST(RigidBody, large_pitch_and_plunge_conserve_energy_in_second_order) {
  BodyParameters p = section();
  p.springs->rest_translation = Vec3(0, 0.5, 0);
  p.springs->rest_rotation = {1.2};
  double lost = 0;
  const auto at_end = [&](int steps) {
    BodyRun run(p, Vec3(0, -9.81, 0));
    for (int i = 0; i < steps; ++i) {
      run.step(2. / steps);
      lost = std::max(
          lost, std::abs(run.now.energies.mismatch()) / (run.now.energies.kinetic + run.now.energies.strain));
    }
    EXPECT_EQ(run.now.translation.x(), 0);
    return Vec3(run.now.translation.y(), run.now.turned.z(), run.motion.reference_velocity(run.now).y());
  };
  const Vec3 fine = at_end(64000);
  const double slope = slope_of([&](int n) { return (at_end(n) - fine).norm(); }, 1000);
  EXPECT_NEAR(slope, 2, 0.1);
  EXPECT_LT(lost, 1e-9);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
  RecordProperty("energy", fmt::format("{:.1e}", lost));
}

/// Speed after an impact on a stop of the rotation over that before it.
double rebound(double restitution, double steps_per_impact, double* penetration = nullptr) {
  BodyParameters p = pendulum(0);
  Stop& stop = p.stops.emplace().rotation.emplace();
  stop.most = 0.01;
  stop.stiffness = 950;
  stop.restitution = restitution;
  p.initial_angular_velocity = Vec3(0, 0, 1);
  BodyRun run(p);
  const double dt = pi * std::sqrt(0.95 / 950) / steps_per_impact;
  for (int i = 0; i < 100000; ++i) {
    run.step(dt);
    if (penetration) *penetration = std::max(*penetration, run.now.turned.z() - 0.01);
    EXPECT_LT(std::abs(run.now.energies.mismatch()), 1e-12);
    if (run.now.spin.z() < 0 && run.now.turned.z() < 0.01) break;
  }
  EXPECT_NEAR(run.now.energies.impact_work, run.now.energies.total() - run.now.energies.initial, 1e-12);
  return -run.now.spin.z();
}

TEST(RigidBody, an_elastic_stop_returns_the_energy_and_a_damped_one_its_restitution) {
  double depth = 0;
  EXPECT_NEAR(rebound(1, 20, &depth), 1, 1e-12);
  EXPECT_NEAR(rebound(1, 0.7), 1, 1e-12);  // at any step
  EXPECT_NEAR(depth, std::sqrt(0.95 / 950), 0.02 * std::sqrt(0.95 / 950));
  for (const double restitution : {0.8, 0.5, 0.2}) {
    const double coarse = std::abs(rebound(restitution, 20) - restitution);
    const double fine = std::abs(rebound(restitution, 320) - restitution);
    EXPECT_LT(coarse, 0.02) << restitution;
    EXPECT_LT(fine, 0.002) << restitution;
    const double slope = std::log2(coarse / fine) / 4;
    EXPECT_NEAR(slope, 2, 0.1) << restitution;
    RecordProperty(fmt::format("restitution-{:.0f}-percent", 100 * restitution),
                   fmt::format("{:.1e}", coarse));
    RecordProperty(fmt::format("restitution-{:.0f}-slope", 100 * restitution), fmt::format("{:.3f}", slope));
  }
}

TEST(RigidBody, a_bouncing_body_settles_on_a_stop_and_loses_no_more_than_its_energy) {
  BodyParameters p = free_body();
  Stop& stop = p.stops.emplace().z.emplace();
  stop.least = -0.5;
  stop.stiffness = 2e4;
  stop.restitution = 0.5;
  BodyRun run(p, Vec3(0, 0, -9.81));
  for (int i = 0; i < 4000; ++i) {
    run.step(0.001);
    ASSERT_LT(std::abs(run.now.energies.mismatch()), 1e-10) << i;
    ASSERT_LT(run.now.energies.total(), 1e-12) << i;
  }
  EXPECT_NEAR(run.now.translation.z(), -0.5 - 2 * 9.81 / 2e4, 1e-8);
  EXPECT_NEAR(run.now.velocity.z(), 0, 1e-6);
}

/// Participant with a box of the unit cube as its surface.
Parameters boxed(int dimension) {
  Parameters p;
  BodyParameters& body = p.body.emplace();
  body.dimension = dimension;
  body.mass = 2;
  body.inertia =
      dimension == 2 ? std::vector<double>{0.5} : std::vector<double>{0.3, 0.4, 0.5, 0.05, 0, -0.02};
  body.center_of_mass = Vec3(0.5, 0.4, dimension == 2 ? 0 : 0.6);
  body.surface = {"xmin", "xmax", "ymin", "ymax"};
  if (dimension == 3) body.surface.insert(body.surface.end(), {"zmin", "zmax"});
  return p;
}

mesh::RawMesh box(int dimension) {
  const auto cells = dimension == 2 ? mesh::BoxCells::quadrilaterals : mesh::BoxCells::hexahedra;
  mesh::RawMesh raw =
      mesh::make_box(cells, {3, 4, 2}, Vec3::Zero(), dimension == 2 ? Vec3(1, 1, 0) : Vec3(1, 1, 1));
  return raw;
}

TEST(RigidBody, the_work_of_forces_on_the_faces_is_that_of_the_motion) {
  for (const int dimension : {2, 3})
    for (const bool hinged : {false, true}) {
      Parameters p = boxed(dimension);
      if (hinged) {
        p.body->hinge.emplace().point = Vec3(0.1, 0.2, 0);
        if (dimension == 3) p.body->hinge->axis = Vec3(1, 2, -2);
      }
      const mesh::RawMesh raw = box(dimension);
      RigidBody body(p, {}, &raw);
      const coupling::Interface interface = body.initialise();
      std::mt19937 random(3);
      std::uniform_real_distribution<double> some(-4, 4);
      const BodySurface& surface = body.surface();
      double work = 0, size = 0;
      for (int step = 0; step < 30; ++step) {
        coupling::Exchange in;
        for (const char* name : {"pressure-force", "viscous-force"})
          for (std::size_t i = 0; i < interface.face_centres.size() * std::size_t(dimension); ++i)
            in[name].push_back(0.2 + some(random));
        const BodyState before = body.state();
        body.begin_step({.time = 0.1 * step, .dt = 0.1, .number = step});
        body.solve(in);
        body.accept_step();
        for (std::size_t f = 0; f < surface.centres.size(); ++f) {
          const Vec3 arm = surface.centres[f] - p.body->reference();
          const Vec3 moved =
              body.motion().displacement(body.state(), arm) - body.motion().displacement(before, arm);
          for (int c = 0; c < dimension; ++c) {
            const std::size_t i = f * std::size_t(dimension) + std::size_t(c);
            const double one = (in["pressure-force"][i] + in["viscous-force"][i]) * moved[c];
            work += one, size += std::abs(one);
          }
        }
      }
      const Energies& e = body.state().energies;
      EXPECT_GT(body.state().turned.norm(), 0.3);
      EXPECT_NEAR(e.load_work, work, 1e-12 * size) << dimension << hinged;
      EXPECT_NEAR(e.kinetic, work, 1e-12 * size) << dimension << hinged;
    }
}

TEST(RigidBody, the_surface_points_out_of_the_body_whichever_mesh_it_comes_from) {
  // A square hole in a ring of fluid: the cells of a 3 x 3 box around the middle one.
  mesh::RawMesh around =
      mesh::make_box(mesh::BoxCells::quadrilaterals, {3, 3, 1}, Vec3::Zero(), Vec3(3, 3, 0));
  mesh::RawMesh ring = around;
  ring.cell_points = {}, ring.cell_type.clear(), ring.cell_zone.clear();
  std::vector<Index> hole;
  for (Index c = 0; c < around.cell_points.size(); ++c) {
    Vec3 middle = Vec3::Zero();
    for (const Index p : around.cell_points[c]) middle += around.points[std::size_t(p)] / 4;
    if ((middle - Vec3(1.5, 1.5, 0)).norm() < 0.1) {
      hole.assign(around.cell_points[c].begin(), around.cell_points[c].end());
      continue;
    }
    ring.cell_points.push_row(around.cell_points[c]);
    ring.cell_type.push_back(around.cell_type[std::size_t(c)]);
    ring.cell_zone.push_back(0);
  }
  ring.patches.push_back("body");
  for (std::size_t i = 0; i < 4; ++i) {
    ring.boundary_points.push_row(std::array{hole[i], hole[(i + 1) % 4]});
    ring.boundary_patch.push_back(int(ring.patches.size()) - 1);
  }
  for (const BodySurface& s : {surface_of(ring, {"body"}, 2, "surface"),
                               surface_of(around, {"xmin", "xmax", "ymin", "ymax"}, 2, "surface")}) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& x : s.centres) middle += x / double(s.centres.size());
    for (std::size_t f = 0; f < s.areas.size(); ++f) EXPECT_GT(s.areas[f].dot(s.centres[f] - middle), 0);
  }
  EXPECT_NEAR(surface_of(ring, {"body"}, 2, "surface").enclosed, 1, 1e-12);
  EXPECT_THAT(support::error_of([&] { surface_of(ring, {"bodi"}, 2, "participants.b.body.surface"); }),
              ::testing::HasSubstr("participants.b.body.surface: the mesh has no patch 'bodi'"));
  EXPECT_THAT(support::error_of([&] { surface_of(ring, {"body"}, 3, "s"); }),
              ::testing::HasSubstr("has 2 dimensions"));
}

/// Errors of reading these keys of a body.
std::string said_of(const std::string& keys) {
  Parameters p;
  return support::error_of([&] {
    const auto document = config::Document::parse("gravity: [0, 0, 0]\n" + keys, "case.yaml");
    std::string all;
    for (const auto& problem : config::load(document, "", [&](config::Section& s) { declare(s, p); }))
      all += fmt::format("{}\n", problem);
    if (!all.empty()) throw Error("{}", all);
  });
}

TEST(RigidBody, keys_that_fit_no_body_are_refused) {
  using ::testing::HasSubstr;
  EXPECT_EQ(said_of("body: {mass: 1, inertia: [1, 1, 1]}"), "");
  EXPECT_THAT(said_of("body: {mass: 1}"), HasSubstr("a body that rotates needs it"));
  EXPECT_THAT(said_of("body: {mass: 1, inertia: [1]}"), HasSubstr("one axis of rotation"));
  EXPECT_THAT(said_of("body: {mass: 1, inertia: [1, 1, 3]}"), HasSubstr("at most the sum of the others"));
  EXPECT_THAT(said_of("body: {mass: 1, inertia: [1, 1, 1], held: [x, w]}"),
              HasSubstr("'w' is no degree of freedom"));
  EXPECT_THAT(said_of("body: {mass: 1, inertia: [1, 1, 1], held: [rotation-x]}"),
              HasSubstr("hold no rotation, two"));
  EXPECT_THAT(said_of("body: {dimension: 2, mass: 1, held: [x, y, rotation-z]}"),
              HasSubstr("no degree of freedom is left"));
  EXPECT_THAT(said_of("body: {dimension: 2, mass: 1, inertia: [1], hinge: {point: [0, 0], axis: [1, 0, 0]}}"),
              HasSubstr("the axis of a planar body"));
  EXPECT_THAT(said_of("body: {mass: 1, inertia: [1, 1, 1], stops: {rotation: {most: 1 rad, stiffness: 1}}}"),
              HasSubstr("one axis of rotation"));
  EXPECT_THAT(
      said_of(
          "body: {dimension: 2, mass: 1, inertia: [1], hinge: {point: [0, 0]}, stops: {rotation: {most: -1 deg, stiffness: 1}}}"),
      HasSubstr("would start beyond it"));
  EXPECT_THAT(said_of("body: {mass: 1, inertia: [1, 1, 1], held: [x]}\ninitial-velocity: [1, 0, 0]"),
              HasSubstr("held against this translation"));
  EXPECT_THAT(said_of("thickness: 1\nbody: {mass: 1, inertia: [1, 1, 1]}"),
              HasSubstr("it has no effect with 'body'"));
  EXPECT_THAT(said_of("mesh: a.geo\nbody: {mass: 1, inertia: [1, 1, 1]}"),
              HasSubstr("needs both 'mesh' and 'body.surface'"));
}

}  // namespace couplet::plate::rigid_body_test
