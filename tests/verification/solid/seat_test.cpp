// SPDX-License-Identifier: Apache-2.0
// A solid that meets a rigid seat without friction: statics.
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::seat_test {
using namespace mesh;

/// A rigid seat at y = `height` below a body.
contact::ContactParameters seat_below(const std::string& height) {
  contact::ContactParameters c;
  c.height.text = height;
  c.direction = {0, 1, 0};
  return c;
}

/// What the seat feels at the accepted state: of a rigid one what the last solve found.
Seat::Look look(const Solid& solid) {
  const Seat& seat = *solid.body().seat();
  const SolidState& s = solid.stepper().state();
  return seat.look(seat.penetration(solid.body().unknowns_of(s.cell_u, s.face_u), s.known),
                   seat.is_rigid() ? solid.stepper().last_solve().contact : std::vector<double>());
}

/// A column on its seat that can move up and down alone: waves of one dimension.
SolidParameters column(int dim) {
  SolidParameters p = box_parameters(dim);
  p.material = {1000, 1e7, 0.3};
  for (const char* side : {"xmin", "xmax"}) p.boundaries[side] = boundary(Type::symmetry);
  if (dim == 3)
    for (const char* side : {"zmin", "zmax"}) p.boundaries[side] = boundary(Type::symmetry);
  return p;
}

/// A block pressed on its seat by a known displacement of its top, free to widen.
SolidParameters pressed_block(int dim, const std::string& down) {
  SolidParameters p = box_parameters(dim);
  p.boundaries["xmin"] = boundary(Type::symmetry);
  if (dim == 3) p.boundaries["zmin"] = boundary(Type::symmetry);
  SolidBoundary top;
  top.type = Type::fixed_displacement;
  top.components[1] = config::ExpressionText{down};
  p.boundaries["ymax"] = top;
  p.contact = seat_below("-1e-4");
  p.method.relative_tolerance = 1e-11;
  return p;
}

/// Largest deviation of the stress along y from `pressure`, over it, and of all other components.
double deviation(const Solid& solid, double pressure) {
  double worst = 0;
  for (const Tensor3& s : solid.fields().cell_stress(solid.fields().point_displacement())) {
    Tensor3 off = s;
    off(1, 1) += pressure;
    if (solid.body().mesh().dim == 2) off(2, 2) = 0;  // of plane strain
    worst = std::max(worst, off.norm() / pressure);
  }
  return parallel::max(MPI_COMM_WORLD, worst);
}

class PressedBlock : public ::testing::TestWithParam<BoxCells> {};

TEST_P(PressedBlock, has_uniform_stress_to_the_tolerance_on_a_rigid_seat) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = pressed_block(dim, "-10.8e-4");
  p.contact->opening = 4e-5;  // half of it stays above the seat
  RawMesh raw = make_box(GetParam(), {4, 3, 3}, Vec3::Zero(), Vec3(2, 1, dim == 3 ? 1 : 0));
  perturb_interior(raw, 0.2, 5);
  const auto solid = stepped(raw, p);
  // 1e-3 of strain; in the plane across it too: E / (1 - nu^2).
  const double pressure = 1e-3 * 200e9 / (dim == 2 ? 1 - 0.09 : 1);
  const Seat::Look seen = look(*solid);
  RecordProperty(fmt::format("stress_{}", name(GetParam())),
                 fmt::format("{:.1e}", deviation(*solid, pressure)));
  EXPECT_LT(deviation(*solid, pressure), 1e-7);
  EXPECT_NEAR(seen.force / (2 * pressure), 1, 1e-8);
  EXPECT_NEAR(seen.pressure / pressure, 1, 1e-7);
  EXPECT_LT(seen.penetration, 1e-12);  // of a gap of 1e-4
}

TEST_P(PressedBlock, shares_its_way_with_springs_of_any_stiffness) {
  const int dim = dimension_of(GetParam());
  for (const double kappa : {1e8, 1e11, 1e14, 1e16}) {
    SolidParameters p = pressed_block(dim, "-11e-4");
    p.contact->stiffness = kappa;
    RawMesh raw = make_box(GetParam(), {4, 3, 3}, Vec3::Zero(), Vec3(2, 1, dim == 3 ? 1 : 0));
    const auto solid = stepped(raw, p);
    const double modulus = 200e9 / (dim == 2 ? 1 - 0.09 : 1);
    const double pressure = 1e-3 / (1 / modulus + 1 / kappa);
    EXPECT_LT(deviation(*solid, pressure), 1e-6) << kappa;
    EXPECT_NEAR(look(*solid).penetration / (pressure / kappa), 1, 1e-5) << kappa;
    EXPECT_LE(solid->stepper().effort().iterations, 8) << kappa;
  }
}

INSTANTIATE_TEST_SUITE_P(All, PressedBlock, ::testing::ValuesIn(all_cells));

TEST(Seat, that_is_not_met_changes_nothing) {
  SolidParameters p = pressed_block(2, "-0.9e-4");
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 3, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  const auto clear = make_solid(raw, p);
  p.contact.reset();
  const auto alone = make_solid(raw, p);
  step(*clear, 1);
  step(*alone, 1);
  EXPECT_EQ(clear->stepper().state().cell_u, alone->stepper().state().cell_u);
  EXPECT_EQ(look(*clear).force, 0);
}

TEST(Seat, without_a_direction_lies_below) {
  SolidParameters p = pressed_block(2, "-11e-4");
  p.contact->direction.clear();
  const auto solid = stepped(make_box(BoxCells::quadrilaterals, {4, 3, 1}, Vec3::Zero(), Vec3(2, 1, 0)), p);
  EXPECT_NEAR(look(*solid).force / (2 * 1e-3 * 200e9 / 0.91), 1, 1e-8);
}

/// Half of a block of 8 a by 8 a that a rigid cylinder is pressed into from below; cells of a / n at the middle, wider outwards. a is the half
/// width by Hertz for the force found.
struct Hertz {
  double half_width, peak, force, wanted_half_width, wanted_peak;
  int corrections;
};

Hertz hertz(int n, std::optional<double> stiffness = {}) {
  const double radius = 1, e = 1e9, nu = 0.3, size = 0.4, down = 1.2e-3;
  SolidParameters p = box_parameters(2);
  p.material = {1000, e, nu};
  p.boundaries["xmin"] = boundary(Type::symmetry);
  p.boundaries["ymax"] = boundary(Type::fixed_displacement, {"0", fmt::format("-{}", down)});
  p.contact = seat_below(fmt::format("-x^2/{}", 2 * radius));
  p.contact->stiffness = stiffness;
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  const auto wider = [&](double s) { return size * (0.05 * s + 0.95 * s * s * s); };
  for (Vec3& x : raw.points) x = {wider(x[0]), wider(x[1]), 0};
  const auto solid = stepped(raw, p);
  const Seat::Look seen = look(*solid);
  const double modulus = e / (1 - nu * nu), load = 2 * seen.force;  // both halves
  const double a = std::sqrt(4 * load * radius / (M_PI * modulus));
  return {seen.area, seen.pressure, load, a, 2 * load / (M_PI * a), solid->stepper().effort().iterations};
}

TEST(Seat, a_rigid_cylinder_has_the_half_width_and_the_peak_of_hertz) {
  double before = 0;
  for (const int n : {20, 40, 80}) {
    const Hertz h = hertz(n);
    const double width = h.half_width / h.wanted_half_width - 1, peak = h.peak / h.wanted_peak - 1;
    // Where the contact ends: x = size (0.05 s + 0.95 s^3).
    double s = 0;
    while (0.4 * (0.05 * s + 0.95 * s * s * s) < h.half_width) s += 1e-4;
    const double face = 0.4 * (0.05 + 2.85 * s * s) / n / h.half_width;
    fmt::print("n {}: a {:.4e} ({:+.2f} %, a face {:.1f} %), p0 {:.4e} ({:+.3f} %), {} corrections\n", n,
               h.half_width, 100 * width, 100 * face, h.peak, 100 * peak, h.corrections);
    RecordProperty(fmt::format("width_error_{}", n), fmt::format("{:.5f}", width));
    RecordProperty(fmt::format("peak_error_{}", n), fmt::format("{:.5f}", peak));
    RecordProperty(fmt::format("face_{}", n), fmt::format("{:.5f}", face));
    before = peak;
    if (n < 80) continue;
    EXPECT_LT(std::abs(width), std::max(0.02, face));
    EXPECT_LT(std::abs(peak), 0.01);
  }
  EXPECT_LT(std::abs(before), 0.01);
}

TEST(Seat, at_large_strain_a_block_pressed_on_it_has_the_uniform_stress_of_its_law) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::hexahedra, BoxCells::tetrahedra}) {
    const int dim = dimension_of(cells);
    SolidParameters p = pressed_block(dim, "-0.1001*t");
    p.material.law = "saint-venant-kirchhoff";
    p.kinematics = SolidParameters::Kinematics::finite_strain;
    RawMesh raw = make_box(cells, {4, 3, 3}, Vec3::Zero(), Vec3(2, 1, dim == 3 ? 1 : 0));
    perturb_interior(raw, 0.2, 5);
    const auto solid = make_solid(raw, p);
    for (int i = 0; i < 2; ++i) step(*solid, 0.5);
    // Green's strain along y of a stretch of 0.9; across it none of the stress: S = E e, in the plane E / (1 - nu^2) e; P = 0.9 S.
    const double wanted = 0.9 * 0.095 * 200e9 / (dim == 2 ? 1 - 0.09 : 1);
    const Seat::Look seen = look(*solid);
    RecordProperty(fmt::format("large_{}", name(cells)),
                   fmt::format("{:.1e}", seen.force / (2 * wanted) - 1));
    EXPECT_NEAR(seen.force / (2 * wanted), 1, 1e-8) << name(cells);
    EXPECT_NEAR(seen.pressure / wanted, 1, 1e-6) << name(cells);
    EXPECT_LT(seen.penetration, 1e-9) << name(cells);
  }
}

TEST(Seat, is_found_in_few_corrections_at_any_stiffness) {
  int most = 0;
  for (const double stiffness : {1e9, 1e12, 1e15, 1e18}) {
    const int taken = hertz(40, stiffness).corrections;
    fmt::print("stiffness {:.0e}: {} corrections\n", stiffness, taken);
    most = std::max(most, taken);
  }
  RecordProperty("corrections", most);
  EXPECT_LE(most, 15);
}

std::string refusal(const SolidParameters& p) {
  return support::error_of([&] {
    make_solid(make_box(BoxCells::quadrilaterals, {4, 3, 1}, Vec3::Zero(), Vec3(2, 1, 0)), p);
  });
}

TEST(Seat, without_faces_or_around_the_body_is_refused) {
  SolidParameters p = pressed_block(2, "0");
  p.contact->direction = {0, -1, 0};  // the top, which is held
  EXPECT_NE(refusal(p).find("no face of the solid points toward the seat"), std::string::npos) << refusal(p);
  p = pressed_block(2, "0");
  p.contact->height.text = "0.01";
  EXPECT_NE(refusal(p).find("starts 0.01 m inside the seat"), std::string::npos) << refusal(p);
  p.contact->starts_inside = true;
  EXPECT_EQ(refusal(p), "");
  p = pressed_block(2, "0");
  p.method.face_gradient = FaceGradient::thesis;
  EXPECT_NE(refusal(p).find("symmetric"), std::string::npos) << refusal(p);
}

// A solid that falls on a rigid seat and bounces: waves of one dimension against their closed form, energy over many impacts, restart.

// A column of 1 m, E = 10 MPa, rho = 1000 kg/m^3: waves of 116 m/s, so that it stays 17.2 ms on its seat.
const double modulus = 1e7 * 0.7 / (1.3 * 0.4), speed_of_sound = std::sqrt(modulus / 1000), speed = 1,
             gap = 0.01;

SolidParameters falling_column() {
  SolidParameters p = column(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.initial_velocity = {{"0"}, {fmt::format("-{}", speed)}};
  p.contact = seat_below(fmt::format("-{}", gap));
  p.output.energies = true;
  return p;
}

RawMesh column_mesh(int n) {
  return make_box(BoxCells::quadrilaterals, {2, n, 1}, Vec3::Zero(), Vec3(0.1, 1, 0));
}

/// Momentum along y.
double momentum(const Solid& solid) {
  const Mesh& mesh = solid.body().mesh();
  double sum = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    sum += solid.body().density(c) * solid.body().geometry().volume[c] *
           solid.stepper().state().cell_v[std::size_t(c) * 2 + 1];
  return parallel::sum(MPI_COMM_WORLD, sum);
}

struct Impact {
  double duration, force, momentum;  // over 2L/c, rho c v and the momentum before
};

/// Contact time by the impulse over the plateau in the middle of it.
Impact impact(int n, double courant) {
  const auto solid = make_solid(column_mesh(n), falling_column());
  const double dt = courant / (n * speed_of_sound), end = gap / speed + 2.5 / speed_of_sound;
  double impulse = 0, plateau = 0, before = momentum(*solid), samples = 0;
  for (double t = dt; t < end; t += dt) {
    const double last = momentum(*solid);
    step(*solid, dt);
    const double force = (momentum(*solid) - last) / dt, since = (t - gap / speed) * speed_of_sound;
    impulse += force * dt;
    if (since > 0.4 && since < 1.6) plateau += force, samples += 1;
  }
  plateau /= samples;
  return {impulse / plateau * speed_of_sound / 2, plateau / (0.1 * 1000 * speed_of_sound * speed),
          -momentum(*solid) / before};
}

TEST(Bounce, a_column_stays_two_travel_times_with_the_pressure_rho_c_v) {
  double before = 1;
  for (const int n : {25, 50, 100}) {
    const Impact i = impact(n, 0.5);
    const double off = std::max({std::abs(i.duration - 1), std::abs(i.force - 1), std::abs(i.momentum - 1)});
    fmt::print("{} cells: duration {:.4f}, force {:.4f}, rebound {:.4f}\n", n, i.duration, i.force,
               i.momentum);
    RecordProperty(fmt::format("bar_{}", n),
                   fmt::format("{:.4f} {:.4f} {:.4f}", i.duration, i.force, i.momentum));
    if (n == 100) {
      EXPECT_LT(off, 0.02);
      EXPECT_LT(off, before);
    }
    if (n == 25) before = off;
  }
}

/// Of a column that bounces again and again under gravity: largest energy that came from nowhere, over the largest kinetic energy; `finite`:
/// at large strain.
double drift(contact::ContactRule rule, double stiffness, double dt, int steps, bool finite,
             double damping = 0) {
  SolidParameters p = falling_column();
  if (damping > 0) p.damping = SolidDamping{0, damping};
  p.contact->rule = rule;
  p.contact->stiffness = stiffness;
  p.gravity = {0, -50};
  p.initial_velocity.clear();
  if (finite) {
    p.kinematics = SolidParameters::Kinematics::finite_strain;
    p.energy_momentum = true;
  }
  const auto solid = make_solid(column_mesh(6), p);
  double worst = 0, scale = 0;
  for (int i = 0; i < steps; ++i) {
    step(*solid, dt);
    const SolidEnergies e = energies(*solid);
    scale = std::max(scale, e.kinetic);
    worst = std::max(worst,
                     std::abs(e.kinetic + e.strain + e.contact + e.damping_loss - e.external_work) / scale);
  }
  return worst;
}

TEST(Bounce, conserving_keeps_the_energy_of_every_impact_at_any_stiffness_and_step_and_midpoint_does_not) {
  using contact::ContactRule;
  double kept = 0, lost = 1;
  for (const double kappa : {1e7, 1e9, 1e12, 1e15})
    for (const double dt : {5e-4, 2e-3, 8e-3}) {
      const double one = drift(ContactRule::conserving, kappa, dt, 100, false);
      fmt::print("kappa {:.0e}, dt {:.0e}: {:.1e}\n", kappa, dt, one);
      kept = std::max(kept, one);
    }
  for (const double kappa : {1e9, 1e12}) try {
      const double made = drift(ContactRule::midpoint, kappa, 2e-3, 100, false);
      fmt::print("midpoint, kappa {:.0e}: {:.1e}\n", kappa, made);
      lost = std::min(lost, made);
    } catch (const Error& e) {
      fmt::print("midpoint, kappa {:.0e}: {}\n", kappa, e.what());
    }
  RecordProperty("conserving", fmt::format("{:.1e}", kept));
  RecordProperty("midpoint", fmt::format("{:.1e}", lost));
  EXPECT_LT(kept, 1e-7);
  EXPECT_GT(lost, 0.1);
  // Stiffness damping takes energy, as much as it tells.
  for (const double beta : {1e-5, 1e-3})
    EXPECT_LT(drift(ContactRule::conserving, 1e9, 5e-4, 100, false, beta), 1e-7) << beta;
}

/// Generalised-alpha, which forgets the highest modes, with the penetration where it has its equilibrium.
double made_by_generalised_alpha() {
  SolidParameters p = falling_column();
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.time_scheme.type = time::TimeScheme::generalised_alpha;
  p.contact->rule = contact::ContactRule::midpoint;
  p.contact->stiffness = 1e11;
  const auto solid = make_solid(column_mesh(6), p);
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    step(*solid, 5e-4);
    const SolidEnergies e = energies(*solid);
    worst = std::max(worst, (e.kinetic + e.strain + e.contact) / e.initial_kinetic - 1);
  }
  return worst;
}

TEST(Bounce, at_large_strain_conserving_keeps_it_too_and_a_scheme_that_damps_makes_it) {
  double kept = 0;
  for (const double kappa : {1e8, 1e11})
    for (const double dt : {5e-4, 2e-3})
      kept = std::max(kept, drift(contact::ContactRule::conserving, kappa, dt, 60, true));
  const double made = made_by_generalised_alpha();
  fmt::print("large strain: {:.1e}, generalised-alpha with midpoint {:.1e}\n", kept, made);
  RecordProperty("large_strain", fmt::format("{:.1e}", kept));
  RecordProperty("generalised_alpha", fmt::format("{:.1e}", made));
  EXPECT_LT(kept, 1e-6);
  EXPECT_GT(made, 1);
}

TEST(Bounce, goes_on_bit_for_bit_after_a_restart_in_contact) {
  const auto whole = make_solid(column_mesh(20), falling_column());
  const double dt = 2e-4;
  for (int i = 0; i < 60; ++i) step(*whole, dt);
  EXPECT_GT(look(*whole).force, 0);
  const support::SavedState saved(*whole);
  const auto rest = make_solid(column_mesh(20), falling_column());
  saved.load_into(*rest);
  for (int i = 0; i < 60; ++i) step(*whole, dt), step(*rest, dt);
  EXPECT_EQ(whole->stepper().state().cell_u, rest->stepper().state().cell_u);
  EXPECT_EQ(whole->stepper().state().cell_v, rest->stepper().state().cell_v);
  EXPECT_EQ(energies(*whole).contact, energies(*rest).contact);
  RecordProperty("same", whole->stepper().state().cell_u == rest->stepper().state().cell_u ? 1 : 0);
}

}  // namespace couplet::testing::seat_test
