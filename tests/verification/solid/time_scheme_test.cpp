// SPDX-License-Identifier: Apache-2.0
// Orders of the time schemes, measured against the exact solution of the semi-discrete equations: a clamped
// sheet that moves at its root, is pulled at its end and loaded over its volume, all as functions of time.
#include "common/time/time_scheme.hpp"
#include "common/app/loop/step_loop.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/semi_discrete.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::time_scheme_test {
using namespace time;

constexpr double end_time = 1.2;

SolidParameters driven_sheet(TimeScheme scheme) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.plane = SolidParameters::Plane::stress;
  p.material = {1000, 2e4, 0.3};
  p.time_scheme.type = scheme;
  p.method.face_gradient = FaceGradient::thesis;  // whose faces have no mass: SemiDiscrete
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"1e-3*sin(3*t)^2", "2e-3*sin(2*t)^2"});
  p.boundaries["xmax"] = boundary(Type::traction, {"400*sin(4*t)", "100*t*cos(3*t)"});
  p.body_force = {{"0"}, {"300*x*sin(2*t)"}};
  p.initial_velocity = {{"1e-2*x"}, {"2e-2*x^2"}};
  return p;
}

mesh::RawMesh sheet() {
  return mesh::make_box(mesh::BoxCells::quadrilaterals, {8, 3, 1}, Vec3::Zero(), Vec3(1, 0.4, 0));
}

/// The cells at the end time, exactly.
Eigen::VectorXd exact(const SolidParameters& p) {
  const auto solid = make_solid(sheet(), p);
  const SemiDiscrete model(*solid);
  const SolidBoundaries boundaries(solid->body().mesh(), solid->body().geometry(), p);
  const PrescribedDisplacement prescribed(solid->body().mesh(), boundaries, solid->body().elastic());
  const auto body = fv::make_expressions(p.body_force, 2, "body-force");
  const mesh::Mesh& mesh = solid->body().mesh();
  const mesh::Geometry& geometry = solid->body().geometry();
  const SolidDamping damping = p.damping.value_or(SolidDamping{});
  const auto force = [&](double t) {
    std::vector<double> rhs(solid->body().elastic().n_unknowns(), 0);
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      for (int a = 0; a < 2; ++a)
        rhs[std::size_t(c) * 2 + a] = body[a](geometry.cell_centre[c], t) * geometry.volume[c];
    std::vector<double> on_faces(std::size_t(mesh.boundary.n_owned()) * 2, 0);
    boundaries.add_forces(t, on_faces);
    const auto& faces = solid->body().elastic().unknown_faces();
    for (std::size_t i = 0; i < faces.size(); ++i)
      for (int a = 0; a < 2; ++a) {
        const double value = on_faces[std::size_t(faces[i] - mesh.n_interior) * 2 + a];
        rhs[std::size_t(mesh.owner[faces[i]]) * 2 + a] += value;
        rhs[std::size_t(mesh.cells.n_owned() + Index(i)) * 2 + a] += value;
      }
    std::vector<double> known(prescribed.size() * 2), rate(known.size());
    prescribed.evaluate(t, known);
    prescribed.evaluate_rate(t, 1e-2, rate);
    for (std::size_t i = 0; i < known.size(); ++i) known[i] += damping.stiffness * rate[i];
    solid->body().elastic().subtract_known(known, rhs);
    return model.reduced(rhs);
  };
  return model.integrate(force, damping, end_time, 6000);
}

/// Relative error of the cells' displacements with n steps; uneven: every second step is twice as long.
double error_with(const SolidParameters& p, const Eigen::VectorXd& reference, int n, bool uneven) {
  const auto solid = make_solid(sheet(), p);
  for (int i = 0; i < n; ++i) step(*solid, uneven ? end_time / (1.5 * n) * (1 + i % 2) : end_time / n);
  EXPECT_NEAR(solid->stepper().state().time, end_time, 1e-12);
  const Eigen::Map<const Eigen::VectorXd> u(solid->stepper().state().cell_u.data(), reference.size());
  return (u - reference).norm() / reference.norm();
}

struct Variant {
  TimeScheme scheme;
  bool uneven;
  SolidDamping damping;
};

class TimeSchemes : public ::testing::TestWithParam<Variant> {};

TEST_P(TimeSchemes, have_their_order) {
  const auto [scheme, uneven, damping] = GetParam();
  SolidParameters p = driven_sheet(scheme);
  if (damping.mass > 0 || damping.stiffness > 0) p.damping = damping;
  const Eigen::VectorXd reference = exact(p);
  std::vector<double> errors;
  for (const int n : {200, 400, 800}) errors.push_back(error_with(p, reference, n, uneven));
  // With uneven steps single pairs scatter by 0.15: the mean over both.
  const double slope = uneven ? 0.5 * std::log2(errors[0] / errors[2]) : std::log2(errors[1] / errors[2]);
  fmt::print("{}{}: errors {:.2e} {:.2e} {:.2e}, slope {:.3f}\n", name(scheme),
             uneven ? ", uneven steps" : "", errors[0], errors[1], errors[2], slope);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
  const double order = scheme == TimeScheme::euler ? 1 : 2;
  EXPECT_GT(slope, order - 0.1);
  EXPECT_LT(slope, order + 0.2);
  EXPECT_LT(errors[2], scheme == TimeScheme::euler ? 0.05 : 2e-3);
}

/// Of the symmetric gradient, whose faces have mass, against the same mesh's solution by steps a quarter as long.
TEST_P(TimeSchemes, have_their_order_where_faces_have_mass) {
  const auto [scheme, uneven, damping] = GetParam();
  SolidParameters p = driven_sheet(scheme), best = driven_sheet(TimeScheme::bathe);
  for (SolidParameters* q : {&p, &best}) {
    q->method.face_gradient = FaceGradient::symmetric;
    if (damping.mass > 0 || damping.stiffness > 0) q->damping = damping;
  }
  const auto fine = make_solid(sheet(), best);
  constexpr int steps = 3200;
  for (int i = 0; i < steps; ++i) step(*fine, end_time / steps);
  const std::vector<double>& cells = fine->stepper().state().cell_u;
  const Eigen::VectorXd reference =
      Eigen::Map<const Eigen::VectorXd>(cells.data(), Eigen::Index(cells.size()));
  std::vector<double> errors;
  for (const int n : {200, 400, 800}) errors.push_back(error_with(p, reference, n, uneven));
  const double slope = uneven ? 0.5 * std::log2(errors[0] / errors[2]) : std::log2(errors[1] / errors[2]);
  RecordProperty("slope", fmt::format("{:.3f}", slope));
  const double order = scheme == TimeScheme::euler ? 1 : 2;
  EXPECT_GT(slope, order - (uneven ? 0.2 : 0.1));
  EXPECT_LT(slope, order + 0.2);
  EXPECT_LT(errors[2], scheme == TimeScheme::euler ? 0.05 : 2e-3);
}

std::string variant_name(const ::testing::TestParamInfo<Variant>& info) {
  std::string text = name(info.param.scheme);
  std::replace(text.begin(), text.end(), '-', '_');
  return text + (info.param.uneven ? "_uneven" : "") + (info.param.damping.mass > 0 ? "_damped" : "");
}

std::vector<Variant> all_variants() {
  std::vector<Variant> all;
  for (const TimeScheme scheme : {TimeScheme::euler, TimeScheme::three_point, TimeScheme::trapezoidal,
                                  TimeScheme::bathe, TimeScheme::generalised_alpha}) {
    all.push_back({scheme, false, {}});
    all.push_back({scheme, true, {}});
    all.push_back({scheme, false, {0.5, 2e-3}});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Solid, TimeSchemes, ::testing::ValuesIn(all_variants()), variant_name);

TEST(TimeSchemes, continue_from_a_checkpoint_bit_for_bit) {
  for (const TimeScheme scheme : {TimeScheme::euler, TimeScheme::three_point, TimeScheme::trapezoidal,
                                  TimeScheme::bathe, TimeScheme::generalised_alpha}) {
    const SolidParameters p = driven_sheet(scheme);
    const auto run = make_solid(sheet(), p), restarted = make_solid(sheet(), p);
    for (const double dt : {0.02, 0.01, 0.02}) step(*run, dt);
    support::SavedState(*run).load_into(*restarted);
    for (const double dt : {0.02, 0.01, 0.01}) {
      step(*run, dt);
      step(*restarted, dt);
    }
    EXPECT_EQ(run->stepper().state().cell_u, restarted->stepper().state().cell_u) << name(scheme);
    EXPECT_EQ(run->fields().point_velocity(), restarted->fields().point_velocity()) << name(scheme);
  }
}

/// What is left of a vibration of circular frequency omega after a step: u of one spring and mass.
double kept(const TimeSchemeParameters& scheme, double omega_dt) {
  double u = 0, v = 1, a = 0, u_old = -1, v_old = 1, largest_before = 0, largest_after = 0;
  // Unit step; the level further back is that of no force. Growth is measured over many steps.
  constexpr int steps = 400;
  for (int n = 0; n < steps; ++n) {
    const double u_start = u, v_start = v;
    for (const Stage& s : second_order_stages(scheme, 1, {n, 1})) {
      const bool second = s.start > 0;
      const auto value = [&](const Levels& l, double x) {
        return l.x * x + l.u * u + l.v * v + l.a * a + l.u_old * (second ? u_start : u_old) +
               l.v_old * (second ? v_start : v_old);
      };
      const double x = -value(s.acceleration, 0) / (s.acceleration.x + omega_dt * omega_dt);
      const double end = value(s.end_value, x), rate = value(s.end_rate, x),
                   acc = value(s.end_acceleration, x);
      u = end, v = rate, a = acc;
    }
    u_old = u_start, v_old = v_start;
    const double size = std::hypot(omega_dt * u, v);
    if (n >= steps / 4 && n < steps / 2) largest_before = std::max(largest_before, size);
    if (n >= 3 * steps / 4) largest_after = std::max(largest_after, size);
  }
  return std::pow(largest_after / largest_before, 2.0 / steps);
}

TEST(TimeSchemes, keep_or_damp_vibrations_as_they_should) {
  EXPECT_NEAR(kept({TimeScheme::trapezoidal}, 0.1), 1, 1e-9);
  EXPECT_NEAR(kept({TimeScheme::trapezoidal}, 100), 1, 1e-9);
  for (const double rho : {0.3, 0.8}) {
    // Chung and Hulbert: the radius at infinity is rho; there it is reached from a triple root.
    EXPECT_NEAR(kept({TimeScheme::generalised_alpha, rho}, 1e4), rho, 0.05);
    EXPECT_GT(kept({TimeScheme::generalised_alpha, rho}, 0.05), 1 - 1e-4);
  }
  for (const TimeScheme scheme : {TimeScheme::euler, TimeScheme::three_point, TimeScheme::bathe})
    EXPECT_LT(kept({scheme}, 100), 0.2) << name(scheme);
  EXPECT_GT(kept({TimeScheme::bathe}, 0.1), 1 - 1e-5);
}

// Two sub-steps of Bathe share their factors: both have the same coefficient of the unknown.
TEST(TimeSchemes, both_parts_of_a_bathe_step_have_one_matrix) {
  const auto stages = second_order_stages({TimeScheme::bathe}, 0.37, {5, 0.2});
  ASSERT_EQ(stages.size(), 2u);
  EXPECT_NEAR(stages[0].acceleration.x / stages[1].acceleration.x, 1, 1e-14);
  EXPECT_NEAR(stages[0].rate.x / stages[1].rate.x, 1, 1e-14);
}

// First derivatives: y' = -y + sin(t), from the same coefficients.
TEST(TimeSchemes, have_their_order_for_first_derivatives) {
  const auto error = [](TimeScheme scheme, int n) {
    const double dt = 2. / n;
    double y = 1, old = 0;
    for (int i = 0; i < n; ++i) {
      const double start = y;
      for (const Stage& s : second_order_stages({scheme}, dt, {i, dt})) {
        const double before = s.start > 0 ? start : old;
        const double load = std::sin(i * dt + s.start + s.place * s.dt);
        const double x = (load - s.rate.u * y - s.rate.u_old * before) / (s.rate.x + 1);
        y = s.end_value.x * x + s.end_value.u * y + s.end_value.u_old * before;
      }
      old = start;
    }
    return std::abs(y - (1.5 * std::exp(-2.) + 0.5 * (std::sin(2.) - std::cos(2.))));
  };
  for (const TimeScheme scheme :
       {TimeScheme::euler, TimeScheme::three_point, TimeScheme::trapezoidal, TimeScheme::bathe})
    EXPECT_NEAR(std::log2(error(scheme, 100) / error(scheme, 200)), scheme == TimeScheme::euler ? 1 : 2, 0.1)
        << name(scheme);
}

}  // namespace couplet::testing::time_scheme_test

// A damped sheet is bent quickly and then left alone: short steps are needed at the start alone.
namespace couplet::testing::step_control_test {
using namespace time;

constexpr double end_time = 16, longest_step = 0.4;

SolidParameters bent_sheet() {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 2e5, 0.3};
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "t < 1 ? 200*sin(1.5707963*t)^2 : 200"});
  p.damping = SolidDamping{3, 1e-3};
  return p;
}

mesh::RawMesh sheet() {
  return mesh::make_box(mesh::BoxCells::quadrilaterals, {10, 3, 1}, Vec3::Zero(), Vec3(1, 0.3, 0));
}

using Visit = std::function<void(const Solid&)>;

/// Through the loop that a program runs; gives its accepted steps and how many were refused.
std::pair<int, int> run(Solid& solid, const Visit& visit, double time_step, int max_halvings) {
  app::SimulationParameters simulation;
  simulation.end_time = end_time;
  simulation.time_step = time_step;
  simulation.max_step_halvings = max_halvings;
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("couplet-step-control-{}", ::getpid());
  app::StepLoop loop(MPI_COMM_WORLD, simulation, coupling::Scheme::standalone, folder);
  double advised = std::numeric_limits<double>::infinity();
  app::StepActions actions;
  actions.attempt = [&](const coupling::Step& step) -> std::optional<std::string> {
    try {
      solid.begin_step(step);
      solid.solve({});
      return {};
    } catch (const SolveFailure& e) {
      return e.what();
    }
  };
  actions.accept = [&](double, int) {
    solid.accept_step();
    advised = solid.suggest_dt();
    visit(solid);
  };
  actions.write_start = [](int) {};
  actions.save = [](const std::filesystem::path&) {};
  actions.report = [](const coupling::Step&, double) {};
  actions.advised_dt = [&] { return advised; };
  EXPECT_EQ(loop.run(actions), "");
  std::filesystem::remove_all(folder);
  return {int(loop.steps()), loop.halvings()};
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / double(a.size() / 2));
}

TEST(StepControl, keeps_the_error_below_the_tolerance_with_fewer_steps) {
  constexpr double tolerance = 2e-4;  // of 24 mm
  for (const TimeScheme scheme :
       {TimeScheme::trapezoidal, TimeScheme::bathe, TimeScheme::three_point, TimeScheme::generalised_alpha}) {
    SolidParameters p = bent_sheet();
    p.time_scheme.type = scheme;
    // The truth at the times that all runs share.
    std::map<int, std::vector<double>> truth;
    const auto nominal = [](double t) { return int(std::lround(t / longest_step)); };
    const auto at_nominal = [&](double t) { return std::abs(t - nominal(t) * longest_step) < 1e-9; };
    const auto exact = make_solid(sheet(), p);
    run(
        *exact,
        [&](const Solid& s) {
          if (at_nominal(s.stepper().state().time))
            truth[nominal(s.stepper().state().time)] = s.stepper().state().cell_u;
        },
        longest_step / 512, 0);

    p.step_control = TimeStepControl{tolerance};
    const auto solid = make_solid(sheet(), p);
    double worst = 0, shortest = 1, longest = 0, largest = 0;
    const auto [steps, refused] = run(
        *solid,
        [&](const Solid& s) {
          shortest = std::min(shortest, s.stepper().state().dt);
          longest = std::max(longest, s.stepper().state().dt);
          EXPECT_LE(s.stepper().state().error, 0.1 * tolerance * (1 + 1e-12));
          if (!at_nominal(s.stepper().state().time)) return;
          const auto& expected = truth.at(nominal(s.stepper().state().time));
          worst = std::max(worst, distance(s.stepper().state().cell_u, expected));
          largest = std::max(largest, distance(expected, std::vector<double>(expected.size(), 0)));
        },
        longest_step, 8);
    const int fixed = int(std::lround(end_time / shortest));
    fmt::print(
        "{}: {} steps of {:.4f} to {:.4f} s, {} refused; with the shortest {}; error {:.1e} of {:.1e} m\n",
        name(scheme), steps, shortest, longest, refused, fixed, worst, largest);
    RecordProperty(name(scheme) + "_steps", steps);
    RecordProperty(name(scheme) + "_fixed_steps", fixed);
    EXPECT_LT(worst, tolerance);
    EXPECT_LT(steps, fixed / 2);
    EXPECT_LT(shortest, longest_step / 4);
    EXPECT_GT(longest, 3 * shortest);
  }
}

}  // namespace couplet::testing::step_control_test
