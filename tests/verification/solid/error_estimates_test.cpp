// SPDX-License-Identifier: Apache-2.0
// A run judges its own answer: the guards fire where it is nonsense and are silent where it is sound.
#include "tests/support/observed_run.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::error_estimates_test {
using namespace mesh;

/// Cook's membrane of n x n quadrilaterals, E = 250 MPa, sheared by 6.25 MPa.
std::unique_ptr<Solid> cook(int n, double nu, FaceGradient gradient) {
  SolidParameters p = box_parameters(2);
  p.material = {1000, 250e6, nu};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "6.25e6"});
  return make_solid(cooks_membrane(n), p);
}

/// Doubts in the strain energy that a run of one step tells.
std::ptrdiff_t doubts_in(Solid& solid) {
  const std::vector<std::string> doubts = support::observe(solid, 1, 1).doubts();
  return std::ranges::count(doubts, "strain-energy");
}

std::unique_ptr<Solid> beam(BoxCells cells, const std::array<int, 3>& n, double length,
                            FaceGradient gradient) {
  SolidParameters p = box_parameters(3);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "100", "0"});
  auto solid = stepped(make_box(cells, n, Vec3::Zero(), Vec3(length, 1, 1)), p);
  return solid;
}

void report(const char* what, const StrainAudit& audit) { fmt::print("{}: {}\n", what, audit.text()); }

TEST(Audit, is_silent_on_cook_with_the_symmetric_gradient_and_at_nu_one_third) {
  for (const double nu : {1. / 3, 0.49, 0.4999}) {
    const auto sound = cook(16, nu, FaceGradient::symmetric);
    EXPECT_EQ(doubts_in(*sound), 0) << nu;
    report("Cook, symmetric", audit_of(*sound));
    EXPECT_LT(audit_of(*sound).mismatch(), 1e-6) << nu;  // a symmetric operator is never convicted by it
  }
  const auto sound = cook(16, 1. / 3, FaceGradient::thesis);
  EXPECT_EQ(doubts_in(*sound), 0);
  report("Cook, nu 1/3, thesis", audit_of(*sound));
  EXPECT_FALSE(audit_of(*sound).is_doubtful());
}

/// Stresses and displacements that are zero, or round-off, err by nothing.
TEST(RelativeErrors, have_a_floor_where_a_column_ends_and_where_a_body_only_moves) {
  SolidParameters p = box_parameters(3);
  p.material = {2000, 50e6, 0.3};
  p.gravity = {0, 0, -9.81};
  p.boundaries["zmin"] = boundary(Type::roller);
  for (const char* side : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[side] = boundary(Type::symmetry);
  p.probes["ground"] = {Vec3(5, 5, 50), {"stress"}};
  const RawMesh raw = make_box(BoxCells::hexahedra, {4, 4, 10}, Vec3::Zero(), Vec3(10, 10, 50));
  const auto column = make_solid(raw, p);
  const auto standing = support::observe(*column, 1, 1);
  const auto stress_error = [](const Solid& solid) {
    return reported_stresses(solid.body(), solid.fields(), solid.view().output.probes())[0].error;
  };
  EXPECT_THAT(standing.doubts(), ::testing::IsEmpty());
  EXPECT_LT(stress_error(*column), 1e-6);
  p = box_parameters(3);
  p.boundaries["zmin"] = boundary(Type::fixed_displacement, {"0.3", "0.1", "-0.2"});
  p.probes["ground"] = {Vec3(5, 5, 50), {"stress"}};
  const auto body = make_solid(raw, p);
  const auto moved = support::observe(*body, 1, 1);
  EXPECT_THAT(moved.doubts(), ::testing::IsEmpty());
  EXPECT_LT(stress_error(*body), 0.1);
}

TEST(Audit, is_silent_on_a_beam_that_is_right) {
  const auto sound = beam(BoxCells::hexahedra, {40, 4, 4}, 10, FaceGradient::thesis);
  report("hexahedra four across 10:1, thesis", audit_of(*sound));
  EXPECT_FALSE(audit_of(*sound).is_doubtful());
}

/// Tip deflection of a bar 20:1 of square quadrilaterals, n across, and the estimate of the mesh.
std::pair<double, double> plane_bar(int n, bool finite, const char* load) {
  SolidParameters p = box_parameters(2);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = FaceGradient::symmetric;
  if (finite) p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", load});
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {20 * n, n, 1}, Vec3::Zero(), Vec3(20, 1, 0)), p);
  const double told = support::observe(*solid, 1, 1).diagnostics().errors().mesh;
  double tip = 0;
  for (const double u : solid->fields().point_displacement()) tip = std::max(tip, u);
  return {tip, told};
}

// Quadrilaterals are 1/(2 n^2) too stiff in bending, which no reconstruction shows.
TEST(Audit, estimates_how_stiff_quadrilaterals_bend) {
  for (const bool finite : {false, true}) {
    const char* load = finite ? "30" : "1";
    const double fine = plane_bar(12, finite, load).first;
    for (const int n : {2, 4}) {
      const auto [tip, told] = plane_bar(n, finite, load);
      const double wrong = std::abs(tip / fine - 1);
      fmt::print("{} across, {} strain: estimated {:.3g}, true {:.3g}\n", n, finite ? "large" : "small", told,
                 wrong);
      EXPECT_GT(told, wrong / 2);
      EXPECT_LT(told, wrong * 2);
    }
  }
  EXPECT_GT(plane_bar(1, false, "1").second, 0.2);
}

/// Tip deflection of a bar of square section, bent, and the estimate of the mesh. In a motion of one long step the recovered strains estimate it.
std::pair<double, double> bent_bar(const std::array<int, 3>& n, double length, bool moves) {
  SolidParameters p = box_parameters(3);
  p.material = {1000, 1e6, 0.3};
  p.method.face_gradient = FaceGradient::symmetric;
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "100", "0"});
  if (moves) {
    p.analysis = SolidParameters::Analysis::dynamic;
    p.time_scheme.type = time::TimeScheme::euler;
  }
  const auto solid = make_solid(make_box(BoxCells::hexahedra, n, Vec3::Zero(), Vec3(length, 1, 1)), p);
  const double told = support::observe(*solid, 1, 1e6).diagnostics().errors().mesh;
  const double missed = moves ? audit_of(*solid).missed_by_mesh : told;
  double tip = 0;
  for (const double u : solid->fields().point_displacement()) tip = std::max(tip, u);
  return {tip, missed};
}

// Hexahedra across a slender bar bend well.
TEST(Audit, estimates_how_hexahedra_bend) {
  for (const double length : {40., 100.}) {
    const double fine = bent_bar({200, 4, 4}, length, false).first;
    for (const bool moves : {false, true}) {
      const auto [tip, told] = bent_bar({20, 2, 2}, length, moves);
      const double wrong = std::abs(tip / fine - 1);
      fmt::print("{}:1{}: estimated {:.3g}, true {:.3g}\n", length, moves ? ", moves" : "", told, wrong);
      EXPECT_GT(told, wrong / 2);
      EXPECT_LT(told, wrong * (moves ? 4 : 2.5));
    }
  }
}

/// A sheet that swings freely, judged every 0.2 s for as long as the run lasts.
struct Swing {
  double first_told = 0,
         ended = 0;    ///< created energy when the run first doubted itself, and time when it ended
  double created = 0;  ///< at the last judgement
  std::string cause;
};

/// `outputs`: written every twentieth step.
Swing swing(FaceGradient gradient, double until, bool outputs = true) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {2600, 1e7, 0.3};
  p.time_scheme.type = time::TimeScheme::trapezoidal;
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = clamped(2);
  p.initial_velocity = {{"0.1*x*sin(40*y)*cos(30*x)"}, {"0.2*x*x*sin(35*x)"}};
  RawMesh raw = make_box(BoxCells::triangles, {20, 4, 1}, Vec3::Zero(), Vec3(10, 1, 0));
  perturb_interior(raw, 0.3, 3);
  auto solid = make_solid(raw, p);
  EnergyBalance balance(solid->view(), std::make_shared<StrainEnergy>(solid->view()));
  Swing result;
  try {
    for (int i = 1; solid->stepper().state().time < until; ++i) {
      step(*solid, 0.01);
      diagnostics::Report report;
      balance.observe(report);
      if (outputs && i % 20 == 0) balance.look(report);
      if (!report.findings.empty() && result.first_told == 0) result.first_told = balance.audit().created();
    }
  } catch (const Error& error) {
    result.cause = error.what();
    result.ended = solid->stepper().state().time;
  }
  result.created = balance.audit().created();
  return result;
}

// It ran to 1e75 J when nothing was written.
TEST(Audit, ends_a_motion_that_grows_between_outputs) {
  const Swing grows = swing(FaceGradient::thesis, 30, false);
  EXPECT_NE(grows.cause.find("spurious growth"), std::string::npos);
  EXPECT_LT(grows.created, 1e4);
  EXPECT_TRUE(swing(FaceGradient::symmetric, 30, false).cause.empty());
}

TEST(Audit, fires_on_undamped_motion_that_grows_out_of_nothing_and_ends_the_run) {
  const Swing grows = swing(FaceGradient::thesis, 30);
  fmt::print("told at {:+.3g}, ended at {} s: {}\n", grows.first_told, grows.ended, grows.cause);
  EXPECT_GT(grows.first_told, EnergyAudit::most_created_undriven);
  EXPECT_LT(grows.first_told, EnergyAudit::hopeless);
  EXPECT_GT(grows.ended, 0);
  EXPECT_NE(grows.cause.find("is not symmetric"), std::string::npos);
}

TEST(Audit, is_silent_on_undamped_motion_with_the_symmetric_gradient) {
  const Swing stays = swing(FaceGradient::symmetric, 3);
  EXPECT_EQ(stays.first_told, 0);
  EXPECT_EQ(stays.ended, 0);
  EXPECT_LT(std::abs(stays.created), 1e-6);
}

// What a run tells of the error that its mesh leaves: where heat bends the body, and in motion.

struct Strip {
  double tip = 0;   ///< deflection of the free end [m]
  double told = 0;  ///< estimate of what the mesh leaves [1]
};

/// A strip 20:1 of two bonded layers, the lower one expanding by 2e-3 and the upper by 1e-3, n square cells across; `along`: other
/// cells along it.
SolidParameters bimetal(FaceGradient gradient) {
  SolidParameters p = box_parameters(2);
  SolidMaterial layer{7800, 200e9, 0.3};
  layer.heat.expansion = config::ExpressionText{"2e-5"};
  p.materials["lower"] = {layer, {"lower"}};
  layer.heat.expansion = config::ExpressionText{"1e-5"};
  p.materials["upper"] = {layer, {}};
  p.expansion = ThermalExpansion{300};
  p.temperature = config::ExpressionText{"400"};
  p.method.face_gradient = gradient;
  p.boundaries["xmin"] = clamped(2);
  return p;
}

Strip strip(const SolidParameters& p, BoxCells cells, int n) {
  RawMesh raw = make_box(cells, {20 * n, n, 1}, Vec3::Zero(), Vec3(20, 1, 0));
  raw.zones = {"lower", "upper"};
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double y = 0;
    for (const Index v : raw.cell_points[c]) y += raw.points[v].y() / double(raw.cell_points[c].size());
    raw.cell_zone[c] = y > 0.5;
  }
  const auto solid = make_solid(raw, p);
  Strip found;
  found.told = support::observe(*solid, 1, 1).diagnostics().errors().mesh;
  const std::vector<double> u = solid->fields().point_displacement();
  for (std::size_t i = 1; i < u.size(); i += 2) found.tip = std::max(found.tip, std::abs(u[i]));
  return found;
}

// The energy of free expansion hides that of bending: the estimate was 17 to 35 times too small. Without a symmetric gradient it is unknown.
TEST(ThermalEstimate, knows_what_few_cells_across_make_of_a_bimetal_strip) {
  const double fine = strip(bimetal(FaceGradient::symmetric), BoxCells::quadrilaterals, 12).tip;
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles})
    for (const int n : {2, 4}) {
      const auto [tip, told] = strip(bimetal(FaceGradient::symmetric), cells, n);
      const double wrong = std::abs(tip / fine - 1);
      fmt::print("{} across: estimated {:.3g}, true {:.3g}\n", n, told, wrong);
      EXPECT_GT(told, wrong / 3);
      EXPECT_LT(told, (cells == BoxCells::triangles ? 10 : 2) * wrong);
    }
  EXPECT_TRUE(std::isnan(strip(bimetal(FaceGradient::thesis), BoxCells::quadrilaterals, 2).told));
}

// Strains that are those of the temperature vary within cells, stresses do not.
TEST(ThermalEstimate, is_small_where_the_temperature_alone_strains_the_body) {
  SolidParameters p = bimetal(FaceGradient::symmetric);
  p.materials["lower"] = p.materials["upper"];
  p.materials["lower"].zones = {"lower"};
  p.boundaries["xmin"] = boundary(Type::symmetry);
  p.boundaries["ymin"] = boundary(Type::symmetry);
  EXPECT_LT(strip(p, BoxCells::quadrilaterals, 2).told, 1e-8);
}

TEST(ThermalEstimate, of_motion_is_not_told) {
  SolidParameters p = bimetal(FaceGradient::symmetric);
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_TRUE(std::isnan(strip(p, BoxCells::quadrilaterals, 2).told));
}

/// Sag of the end of a clamped bar 20:1 let loose, n quadrilaterals across, after `periods` of its first swing; and the estimate.
std::pair<double, double> swung(int n, double periods, const char* hold = nullptr) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e6, 0};
  p.method.face_gradient = FaceGradient::symmetric;
  p.boundaries["xmin"] = clamped(2);
  if (hold)
    p.boundaries["xmax"] = boundary(Type::traction, {"0", hold});
  else
    p.initial_velocity = {{"0"}, {"1e-3*x*x"}};
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {20 * n, n, 1}, Vec3::Zero(), Vec3(20, 1, 0)), p);
  // First period of a cantilever: 2 pi L^2 / 3.516 sqrt(rho A / (E I)).
  const double period = 6.2831853 * 400 / 3.5160 * std::sqrt(1000 * 12 / 1e6);
  const int steps = int(60 * periods);
  const double told = support::observe(*solid, steps, period * periods / steps).diagnostics().errors().mesh;
  double end = 0, most = 0;
  const std::vector<double> u = solid->fields().point_displacement();
  for (std::size_t i = 1; i < u.size(); i += 2)
    if (std::abs(u[i]) > most) most = std::abs(u[i]), end = u[i];
  return {end, told};
}

// Two across swing 5.5 % too fast: wrong by a third after a turn, upside down after ten.
TEST(PhaseOfAMotion, is_not_estimated_after_two_swings) {
  EXPECT_FALSE(std::isnan(swung(2, 0.5).second));
  EXPECT_TRUE(std::isnan(swung(2, 2.5).second));
}

TEST(PhaseOfAMotion, a_body_at_rest_tells_nothing) { EXPECT_TRUE(std::isnan(swung(2, 0.05, "0").second)); }

/// A clamped sheet sheared at its end, nu 0.3.
Strip sheared(BoxCells cells, int n) {
  SolidParameters p = box_parameters(dimension_of(cells));
  const bool flat = dimension_of(cells) == 2;
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, flat ? std::vector<std::string>{"0", "0"}
                                                                 : std::vector<std::string>{"0", "0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, flat ? std::vector<std::string>{"0", "1e4"}
                                                       : std::vector<std::string>{"0", "1e4", "0"});
  const auto solid = make_solid(make_box(cells, {4 * n, n, n}, Vec3::Zero(), Vec3(4, 1, flat ? 0 : 1)), p);
  Strip found;
  found.told = support::observe(*solid, 1, 1).diagnostics().errors().mesh;
  const std::vector<double> u = solid->fields().point_displacement();
  for (std::size_t i = 1; i < u.size(); i += std::size_t(solid->body().mesh().dim))
    found.tip = std::max(found.tip, std::abs(u[i]));
  return found;
}

// On a quarter of a ring under pressure the difference of two face gradients alone says 0.01 to 0.04 of it.
TEST(MeshEstimate, on_triangles_is_within_a_factor_of_two_on_a_ring) {
  for (const int n : {4, 8}) {
    SolidParameters p = box_parameters(2);
    p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
    p.boundaries["xmin"] = pressed("1e6");
    const auto solid = make_solid(quarter_ring(BoxCells::triangles, n, 2 * n), p);
    const double told = support::observe(*solid, 1, 1).diagnostics().errors().mesh;
    // Lame: u = p a^2 (1 + nu) / (E (b^2 - a^2)) ((1 - 2 nu) r + b^2 / r), a = 1, b = 2.
    const double nu = p.material.poissons_ratio, scale = 1e6 * (1 + nu) / p.material.youngs_modulus / 3;
    double error = 0, size = 0;
    const std::vector<double> u = solid->fields().point_displacement();
    for (std::size_t i = 0; i < u.size() / 2; ++i) {
      const Vec3& x = solid->body().geometry().points[i];
      const double r = x.norm(), right = scale * ((1 - 2 * nu) * r + 4 / r);
      error += std::pow(std::hypot(u[2 * i], u[2 * i + 1]) - right, 2), size += right * right;
    }
    const double wrong = std::sqrt(error / size);
    RecordProperty(fmt::format("ring_{}", n), fmt::format("{:.3f}", told / wrong));
    EXPECT_GT(told, 0.5 * wrong) << n;
    EXPECT_LT(told, 2 * wrong) << n;
  }
}

// Structured triangles under shear err less than their parts do: too much is told there, never too little.
TEST(MeshEstimate, on_triangles_that_are_sheared_is_not_too_small) {
  const double fine = sheared(BoxCells::triangles, 48).tip;
  for (const int n : {2, 4, 8}) {
    const auto [tip, told] = sheared(BoxCells::triangles, n);
    EXPECT_GT(told, std::abs(tip / fine - 1)) << n;
    EXPECT_LT(told, 0.08) << n;
  }
}

// Two tetrahedra across bend right to a per cent.
TEST(MeshEstimate, of_tetrahedra_that_bend_is_no_third_of_the_solution) {
  const auto [tip, told] = sheared(BoxCells::tetrahedra, 2);
  const double wrong = std::abs(tip / sheared(BoxCells::hexahedra, 8).tip - 1);
  RecordProperty("tetrahedra_2", fmt::format("{:.3f}", told / wrong));
  EXPECT_GT(told, wrong);
  EXPECT_LT(told, 0.3);
}

}  // namespace couplet::testing::error_estimates_test
