// SPDX-License-Identifier: Apache-2.0
// Arc length: a shallow arch against its closed form, under dead loads, pressure and prescribed displacement; restart; refusals;
// the jump past the limit point without arc length.
#include "common/diagnostics/finding.hpp"
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/equilibrium/load_path.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::arc_length_test {
using namespace mesh;

constexpr double pi = std::numbers::pi, span_length = 2, thickness = 0.01, modulus = 1e7;
const double gyration = thickness / std::sqrt(12.0);
// Load per length q sin(pi x / L) of a hinged arch of rise a sin(pi x / L), a = 4 r, deflected to b sin(pi x / L):
// q = E I pi^4 / L^4 (a - b + (a^2 - b^2) b / (4 r^2)) [timoshenko1961]; largest where b = 2 r.
const double unit = modulus * std::pow(thickness, 3) / 12 * std::pow(pi / span_length, 4) * gyration;
double load_at(double b) { return unit * (4 - b + (16 - b * b) * b / 4); }
const double limit = load_at(2), lower_limit = load_at(-2);

/// The left half; y from the centre line.
RawMesh arch(int along) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {along, 5, 1}, Vec3(0, -thickness / 2, 0),
                         Vec3(span_length / 2, thickness / 2, 0));
  for (Vec3& x : raw.points) x.y() += 4 * gyration * std::sin(pi * x.x() / span_length);
  return raw;
}

/// Hinged by one face in the middle of its end, whose traction has no moment.
SolidParameters hinged() {
  SolidParameters p = box_parameters(2);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, modulus, 0};
  p.material.law = "saint-venant-kirchhoff";
  SolidPart hinge;
  hinge.type = Type::spring;
  hinge.stiffness = {fmt::format("{}", 1e3 * modulus / thickness)};
  hinge.value = {{"0"}, {"0"}};
  hinge.where = {fmt::format("abs(y) < {}", 0.1 * thickness)};
  p.boundaries["xmin"].parts = {hinge};
  p.boundaries["xmax"] = boundary(Type::symmetry);
  p.boundaries["ymax"] = boundary(Type::traction, {"0", fmt::format("{}*sin(pi*x/{})", -limit, span_length)});
  p.load_stepping.type = LoadStepping::Type::arc_length;
  p.load_stepping.first_load_factor = 0.2;
  return p;
}

/// Deflected height of the middle over the radius of gyration.
double height(const Solid& solid) {
  const Mesh& mesh = solid.body().mesh();
  double lowest = 1;
  Index last = -1;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const Vec3 x = solid.body().geometry().cell_centre[c];
    const double off = std::abs(x.x() - span_length / 2) + std::abs(x.y() - 4 * gyration);
    if (off < lowest) lowest = off, last = c;
  }
  const bool is_here = lowest == parallel::min(mesh.comm, lowest) && last >= 0;
  const double deflection = is_here ? solid.stepper().state().cell_u[std::size_t(last) * 2 + 1]
                                    : std::numeric_limits<double>::infinity();
  return 4 + parallel::min(mesh.comm, deflection) / gyration;
}

const LoadPath& path_of(const Solid& solid) { return *solid.body().load_path(); }

/// The largest distance of an equilibrium from the closed form, over the limit load; until the path is stable again.
double follow(Solid& solid, bool knows_stability) {
  double gap = 0;
  Stability stability(solid.view(), false);
  for (int i = 0; i < 60 && height(solid) > -3.5; ++i) {
    step(solid, 1);
    diagnostics::Report report;
    stability.observe(report);
    EXPECT_TRUE(report.findings.empty());
    const double b = height(solid), factor = path_of(solid).factor();
    gap = std::max(gap, std::abs(factor - load_at(b) / limit));
    if (knows_stability && std::abs(std::abs(b) - 2) > 0.2) {
      EXPECT_EQ(path_of(solid).stiffness() > 0, std::abs(b) > 2) << "at a height of " << b;
    }
  }
  return gap;
}

TEST(ArcLength, follows_a_shallow_arch_through_both_limit_loads_of_the_closed_form) {
  const std::size_t before = diagnostics::findings().size();
  const auto solid = make_solid(arch(50), hinged());
  const double gap = follow(*solid, true);
  RecordProperty("gap", fmt::format("{:.4f}", gap));
  EXPECT_LT(gap, 0.03);
  const std::vector<LimitPoint>& limits = path_of(*solid).limits();
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_NEAR(limits[0].factor, 1, 0.02);
  EXPECT_TRUE(limits[0].is_maximum);
  EXPECT_NEAR(limits[1].factor, lower_limit / limit, 0.02);
  ASSERT_EQ(diagnostics::findings().size(), before + 2);  // and nothing is said of equilibria on the way
  for (std::size_t i = before; i < before + 2; ++i) {
    EXPECT_EQ(diagnostics::findings()[i].id, "limit-load");
    EXPECT_EQ(diagnostics::findings()[i].severity, base::Severity::note);
  }
  EXPECT_GT(path_of(*solid).stiffness(), 0);
  const auto reactions = solid->fields().reactions(solid->fields().point_displacement());
  const double load = solid->fields().total_load().y();
  EXPECT_NEAR(load, -path_of(*solid).factor() * limit * span_length / pi, 1e-3 * limit);
  double held = 0;
  for (const PatchForce& r : reactions) held += r.force.y();
  EXPECT_NEAR(held, -load, 1e-6 * std::abs(load));
}

TEST(ArcLength, warns_of_a_last_equilibrium_that_is_unstable_and_only_then) {
  const auto solid = make_solid(arch(30), hinged());
  const auto warnings = [&] {
    diagnostics::Report report;
    Stability(solid->view(), false).conclude(report);
    return std::ranges::count_if(report.findings, [](const diagnostics::Finding& f) {
      return f.id == "unstable-equilibrium" && f.severity == base::Severity::warning;
    });
  };
  step(*solid, 1);
  EXPECT_EQ(warnings(), 0);
  for (int i = 0; i < 40 && height(*solid) > 1; ++i) step(*solid, 1);
  EXPECT_EQ(warnings(), 1);
}

/// What ends a run of the arch whose load follows the time, limit load times `factors`, one step each; empty: nothing.
std::string failure_of(const std::vector<double>& factors) {
  SolidParameters p = hinged();
  p.load_stepping = {};
  p.boundaries["ymax"] =
      boundary(Type::traction, {"0", fmt::format("{}*t*sin(pi*x/{})", -limit, span_length)});
  const auto solid = make_solid(arch(30), p);
  double time = 0;
  try {
    for (const double factor : factors) {
      step(*solid, factor - time);
      time = factor;
    }
  } catch (const SolveFailure& failure) {
    return failure.what();
  }
  EXPECT_GT(height(*solid), 2 - 0.1);
  return "";
}

TEST(ArcLength, without_it_a_step_that_jumps_past_the_limit_point_fails_and_steps_up_to_it_do_not) {
  using ::testing::HasSubstr;
  // Newton's method converges in all four, to the snapped arch.
  EXPECT_THAT(failure_of({1.3}), HasSubstr("jumped past a limit point"));
  EXPECT_THAT(failure_of({4}), HasSubstr("jumped past a limit point"));
  EXPECT_THAT(failure_of({0.8, 1.4}), HasSubstr("jumped past a limit point"));
  EXPECT_THAT(failure_of({0.5, 2.5}), HasSubstr("arc-length"));
  EXPECT_EQ(failure_of({0.95}), "");
  EXPECT_EQ(failure_of({0.3, 0.6, 0.9, 0.97}), "");
}

TEST(ArcLength, scales_a_pressure_that_follows_the_surface) {
  SolidParameters p = hinged();
  p.boundaries["ymax"] = pressed(fmt::format("{}*sin(pi*x/{})", limit, span_length));
  const auto solid = make_solid(arch(30), p);
  EXPECT_LT(follow(*solid, false), 0.03);
  ASSERT_GE(path_of(*solid).limits().size(), 1U);
  EXPECT_NEAR(path_of(*solid).limits()[0].factor, 1, 0.02);
}

TEST(ArcLength, scales_a_prescribed_displacement_to_the_equilibria_of_plain_steps) {
  SolidParameters p = box_parameters(2);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, 1e6, 0.49};
  p.material.law = "nearly-incompressible-neo-hookean";
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::fixed_displacement, {"0.2", "0.1"});
  const auto bar = [&](const SolidParameters& chosen) {
    return make_solid(make_box(BoxCells::quadrilaterals, {8, 4, 1}, Vec3::Zero(), Vec3(1, 0.5, 0)), chosen);
  };
  SolidParameters by_length = p;
  by_length.load_stepping.type = LoadStepping::Type::arc_length;
  by_length.load_stepping.first_load_factor = 0.5;
  const auto path = bar(by_length);
  for (int i = 0; i < 2; ++i) step(*path, 1);
  const double factor = path_of(*path).factor();
  ASSERT_GT(factor, 0.8);
  p.boundaries["xmax"].value = {{fmt::format("{:.17g}", 0.2 * factor)},
                                {fmt::format("{:.17g}", 0.1 * factor)}};
  const auto plain = bar(p);
  step(*plain, 1);
  const std::vector<double>&a = path->stepper().state().cell_u, &b = plain->stepper().state().cell_u;
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-7);
}

TEST(ArcLength, continues_from_a_checkpoint_bit_for_bit_across_a_limit_point) {
  const auto through = make_solid(arch(20), hinged()), after = make_solid(arch(20), hinged());
  for (int i = 0; i < 40 && path_of(*through).limits().empty(); ++i) step(*through, 1);
  ASSERT_EQ(path_of(*through).limits().size(), 1U);
  support::SavedState(*through).load_into(*after);
  for (int i = 0; i < 2; ++i) {
    step(*through, 1);
    step(*after, 1);
  }
  EXPECT_EQ(through->stepper().state().cell_u, after->stepper().state().cell_u);
  EXPECT_EQ(through->stepper().state().face_u, after->stepper().state().face_u);
  EXPECT_EQ(path_of(*through).factor(), path_of(*after).factor());
  EXPECT_EQ(path_of(*after).limits().size(), path_of(*through).limits().size());
}

}  // namespace couplet::testing::arc_length_test
