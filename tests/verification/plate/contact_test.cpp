// SPDX-License-Identifier: Apache-2.0
// A body of one rigid motion, and plates with modes, on a rigid seat.
#include "plate_modal/structure.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::contact_test {
using namespace test;

/// Relative error of the speed after one bounce.
double rebound_error(ContactRule rule, double dt) {
  Bounce one(1e4, 0.01003, -1, rule);
  for (int i = 0; i < 100000 && !(one.now.v[0] > 0 && one.now.energies.contact == 0); ++i) one.step(dt);
  return std::abs(one.now.v[0] - 1);
}

TEST(PlateContact, rebound_speed_is_exact_when_conserving_and_tends_to_it_otherwise) {
  const double t_c = std::numbers::pi / 100;  // pi sqrt(m / kappa)
  EXPECT_LT(rebound_error(ContactRule::conserving, t_c / 7), 1e-12);
  EXPECT_LT(rebound_error(ContactRule::conserving, t_c * 3), 1e-12);
  // What the seat does on the body is what its springs give.
  Bounce hit(1e4, 0.01, -1, ContactRule::conserving);
  double held = 0;
  for (int k = 0; k < 40; ++k) {
    hit.step(t_c / 7);
    EXPECT_NEAR(hit.now.energies.impact_work, -hit.now.energies.contact, 1e-9) << k;
    held = std::max(held, hit.now.energies.contact);
  }
  EXPECT_GT(held, 0.3);
  // The plain rule: its error depends on where in a step the body leaves; the mean over places falls.
  const auto mean = [&](double dt) {
    double sum = 0;
    for (int i = 0; i < 40; ++i) {
      Bounce one(1e4, 0.01 + 2e-5 * i * dt / (t_c / 20), -1, ContactRule::midpoint);
      for (int k = 0; k < 100000 && !(one.now.v[0] > 0 && one.now.energies.contact == 0); ++k) one.step(dt);
      sum += std::abs(one.now.v[0] - 1) / 40;
    }
    return sum;
  };
  const double coarse = mean(t_c / 20), fine = mean(t_c / 80), slope = std::log2(coarse / fine) / 2;
  EXPECT_GT(slope, 1.7);
  RecordProperty("conserving", fmt::format("{:.2e}", rebound_error(ContactRule::conserving, t_c / 7)));
  RecordProperty("midpoint-slope", fmt::format("{:.3f}", slope));
}

TEST(PlateContact, penetration_and_duration_are_those_of_a_spring) {
  double worst_depth = 0, worst_time = 0;
  std::vector<double> depths;
  for (const double kappa : {1e3, 1e4, 1e5}) {
    const double t_c = std::numbers::pi / std::sqrt(kappa), dt = t_c / 200;
    Bounce one(kappa, 0.5 * dt, -1, ContactRule::conserving);
    double depth = 0, first = -1, last = -1;
    for (int i = 0; i < 400; ++i) {
      const double before = one.now.q[0];
      one.step(dt);
      const double after = one.now.q[0], seat = -0.5 * dt;
      depth = std::max(depth, seat - after);
      // The moments at which the seat is passed, linear within the step.
      if (before > seat && after <= seat) first = (i + (before - seat) / (before - after)) * dt;
      if (before < seat && after >= seat) last = (i + (seat - before) / (after - before)) * dt;
    }
    worst_depth = std::max(worst_depth, std::abs(depth * std::sqrt(kappa) - 1));
    worst_time = std::max(worst_time, std::abs((last - first) / t_c - 1));
    depths.push_back(depth);
  }
  EXPECT_LT(worst_depth, 0.02);
  EXPECT_LT(worst_time, 0.02);
  EXPECT_NEAR(depths[0] / depths[2], 10, 0.1);
  RecordProperty("depth", fmt::format("{:.2e}", worst_depth));
  RecordProperty("duration", fmt::format("{:.2e}", worst_time));
}

TEST(PlateContact, penetration_at_rest_is_the_weight_over_the_stiffness) {
  for (const double kappa : {1e4, 1e6}) {
    Bounce one(kappa, 0, 0, ContactRule::conserving, -9.81);
    // Put to rest by taking its speed away after each step.
    for (int i = 0; i < 4000; ++i) {
      one.step(1 / std::sqrt(kappa));
      one.now.v[0] *= 0.5;
    }
    EXPECT_NEAR(-one.now.q[0] * kappa / 9.81, 1, 1e-6);
  }
}

TEST(PlateContact, thousand_bounces_do_not_grow_when_conserving) {
  const double kappa = 1e6, g = 9.81, speed = 1;
  double worst = 0;
  for (const double per_contact : {0.2, 1., 3., 20.}) {  // steps in pi sqrt(m / kappa)
    const double dt = std::numbers::pi / std::sqrt(kappa) / per_contact;
    Bounce one(kappa, 0, speed, ContactRule::conserving, -g);
    int bounces = 0;
    double peak = 0;
    for (double before = speed; bounces < 1000;) {
      one.step(dt);
      if (before < 0 && one.now.v[0] > 0) ++bounces;
      before = one.now.v[0];
      peak = std::max(peak, one.now.energies.total() / one.now.energies.initial);
    }
    EXPECT_LT(peak, 1 + 1e-9) << per_contact;
    EXPECT_LT(std::abs(one.now.energies.mismatch()) / one.now.energies.initial, 1e-9) << per_contact;
    worst = std::max(worst, std::abs(peak - 1));
  }
  RecordProperty("growth", fmt::format("{:.2e}", worst));
}

TEST(PlateContact, the_plain_rule_drifts_where_the_conserving_one_does_not) {
  const double kappa = 1e6, g = 9.81, dt = std::numbers::pi / std::sqrt(kappa) / 3;
  Bounce one(kappa, 0, 1, ContactRule::midpoint, -g);
  double largest = 0;
  for (int i = 0; i < 200000; ++i) {
    one.step(dt);
    largest = std::max(largest, std::abs(one.now.energies.total() / one.now.energies.initial - 1));
  }
  EXPECT_GT(largest, 0.05);
  RecordProperty("drift", fmt::format("{:.3g}", largest));
}

Parameters reed_like() {
  Parameters p;
  p.material = {7850, 2e11, 0.3};
  p.thickness = 0.01;
  p.number = 1;
  for (const char* patch : {"xmax", "ymin", "ymax"}) p.boundaries[patch];
  p.boundaries["xmin"].support = Support::clamped;
  return p;
}

TEST(PlateContact, a_mode_on_a_seat_at_its_rest_position_bounces_at_twice_its_frequency) {
  Parameters p = reed_like();
  p.contact.emplace();
  p.contact->height.text = "-0.005";  // touches the lower side at rest
  p.initial_amplitudes = {0.001};
  const mesh::RawMesh raw = square(6);
  Structure plate(p, PlateContext{}, &raw);
  const double f = plate.surface().omega()[0] / (2 * std::numbers::pi), dt = 1 / f / 400;
  std::vector<double> impacts;
  double before = 0;
  for (int i = 0; i < 4000; ++i) {
    plate.begin_step({i * dt, dt, coupling::Scheme::standalone, i});
    plate.solve({});
    plate.accept_step();
    const double v = plate.state().v[0];
    if (before < 0 && v > 0) impacts.push_back(i * dt);
    before = v;
  }
  ASSERT_GT(impacts.size(), 10u);
  const double found = double(impacts.size() - 1) / (impacts.back() - impacts.front());
  EXPECT_NEAR(found / (2 * f), 1, 0.01);
  EXPECT_LT(std::abs(plate.state().energies.mismatch()), 1e-9 * plate.state().energies.initial);
  RecordProperty("frequency-ratio", fmt::format("{:.5f}", found / (2 * f)));
}

TEST(PlateContact, a_plate_with_modes_keeps_its_energy_through_an_impact_and_the_seat_may_have_a_hole) {
  for (const char* where : {"1", "(x - 0.6)^2 + (y - 0.5)^2 - 0.04"}) {
    Parameters p = reed_like();
    p.number = 15;
    p.contact.emplace();
    p.contact->height.text = "-0.006 + 0.0005 * x";
    p.contact->where.text = where;
    p.initial_amplitudes = {0.003, 0.0002};
    const mesh::RawMesh raw = square(8);
    Structure plate(p, PlateContext{}, &raw);
    const double dt = 2 * std::numbers::pi / plate.surface().omega()[0] / 500;
    double deepest = 0, worst = 0;
    for (int i = 0; i < 500; ++i) {
      plate.begin_step({i * dt, dt, coupling::Scheme::standalone, i});
      plate.solve({});
      plate.accept_step();
      deepest = std::max(deepest, plate.state().energies.contact);
      worst = std::max(worst, std::abs(plate.state().energies.mismatch()));
    }
    EXPECT_GT(deepest, 0.01 * plate.state().energies.initial) << where;
    EXPECT_LT(worst, 1e-8 * plate.state().energies.initial) << where;
  }
}

// No wrong answer passes in silence: the rule that makes energy ends the run before it has doubled it.
TEST(PlateContact, a_run_whose_scheme_makes_more_energy_than_there_was_is_refused) {
  for (const ContactRule rule : {ContactRule::midpoint, ContactRule::conserving}) {
    Parameters p = reed_like();
    p.contact.emplace();
    p.contact->height.text = "-0.006";
    p.contact->rule = rule;
    p.initial_amplitudes = {0.003};
    const mesh::RawMesh raw = square(4);
    Structure plate(p, PlateContext{}, &raw);
    const double dt = 2 * std::numbers::pi / plate.surface().omega()[0] / 30;
    double most = 0;
    const auto run = [&] {
      for (int i = 0; i < 20000; ++i) {
        plate.begin_step({i * dt, dt, coupling::Scheme::standalone, i});
        plate.solve({});
        plate.accept_step();
        most = std::max(most, plate.state().energies.total());
      }
    };
    if (rule == ContactRule::conserving) {
      EXPECT_NO_THROW(run());
      EXPECT_LT(most, plate.state().energies.initial * (1 + 1e-8));
    } else {
      EXPECT_THROW(run(), SolveFailure);
      EXPECT_LT(most, 3 * plate.state().energies.initial);
    }
  }
}

std::string refusal(const ContactParameters& contact, double amplitude = 0) {
  Parameters p = reed_like();
  p.contact = contact;
  p.initial_amplitudes = {amplitude};
  const mesh::RawMesh raw = square(4);
  return support::error_of([&] { const Structure plate(p, PlateContext{}, &raw); });
}

// A seat that reaches into the structure at the start is a wound spring: 1 kJ that nobody asked for.
TEST(PlateContact, a_structure_that_stands_in_its_seat_at_the_start_is_refused_unless_it_is_meant) {
  ContactParameters seat;
  seat.height.text = "x > 0.6 ? -0.003 + 0.001 * x : -1";
  const std::string text = refusal(seat);
  EXPECT_NE(text.find("m inside the seat, deepest at (0.9"), std::string::npos) << text;
  EXPECT_NE(text.find("0.0029"), std::string::npos) << text;
  EXPECT_NE(text.find("starts-inside"), std::string::npos) << text;
  seat.starts_inside = true;
  EXPECT_EQ(refusal(seat), "");
  // Touching is not standing in it; what bends into it at the start is.
  ContactParameters touching;
  touching.height.text = "-0.005";
  EXPECT_EQ(refusal(touching), "");
  EXPECT_NE(refusal(touching, -0.002), "");
  EXPECT_EQ(refusal(touching, 0.002), "");
}

TEST(PlateContact, a_seat_that_is_never_met_is_told_with_its_distance) {
  for (const auto& [height, told] : {std::pair{"-6", true}, {"-0.006", false}}) {  // 6 mm without their unit
    Parameters p = reed_like();
    p.contact.emplace();
    p.contact->height.text = height;
    p.initial_amplitudes = {0.003};
    const mesh::RawMesh raw = square(4);
    Structure plate(p, PlateContext{}, &raw);
    const double dt = 2 * std::numbers::pi / plate.surface().omega()[0] / 200;
    const std::vector<std::string> said = support::observe(plate, 200, dt).sentences();
    const bool found = std::ranges::any_of(said, [](const std::string& one) {
      return one.find("the structure never touched the seat; final minimum gap 6 m") != std::string::npos;
    });
    EXPECT_EQ(found, told) << height;
  }
}

TEST(PlateContact, a_seat_along_which_nothing_moves_is_refused) {
  ContactParameters seat;
  seat.height.text = "-3";
  seat.direction = {-1, 0, 0};  // the rim of the free edge looks there, and moves across
  EXPECT_NE(refusal(seat).find("of their motion"), std::string::npos) << refusal(seat);
  seat.direction = {std::sin(0.7), 0, std::cos(0.7)};
  EXPECT_EQ(refusal(seat), "");
}

TEST(PlateContact, a_seat_that_no_face_looks_at_is_an_error) {
  ContactParameters p = Bounce::parameters(1, 0, ContactRule::midpoint);
  p.direction = {1, 0, 0};
  const Surface surface(block());
  EXPECT_THROW(Contact(surface, p, Vec3::UnitZ(), 1), Error);
  p.direction.clear();
  p.where.text = "x - 2";
  EXPECT_THROW(Contact(surface, p, Vec3::UnitZ(), 1), Error);
}

}  // namespace couplet::plate::contact_test
