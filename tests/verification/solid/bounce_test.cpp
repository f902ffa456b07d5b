// SPDX-License-Identifier: Apache-2.0
// A solid that falls on a rigid seat and bounces: waves of one dimension against their closed form, energy over many impacts, restart.
#include <gtest/gtest.h>

#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/seat.hpp"

namespace couplet::testing::bounce_test {
using namespace mesh;
namespace {

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

SolidEnergies energies(const Solid& solid) {
  return solid.stepper().ledger().total(solid.stepper().state(), solid.fields().point_displacement());
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
double drift(contact::ContactRule rule, double stiffness, double dt, int steps, bool finite) {
  SolidParameters p = falling_column();
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
    worst = std::max(worst, std::abs(e.kinetic + e.strain + e.contact - e.external_work) / scale);
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

}  // namespace
}  // namespace couplet::testing::bounce_test
