// SPDX-License-Identifier: Apache-2.0
// Whether the time step resolves what moves: verdicts that fire where the answer is wrong, and are silent where it is
// right. The right answers are closed forms.
#include "plate_modal/diagnostics/motion.hpp"

#include "common/base/numbers.hpp"
#include "plate_modal/structure.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::resolution_test {
using namespace time;

using namespace test;
constexpr double pi = std::numbers::pi;

struct Driven {
  Motion::Evidence evidence;
  double largest = 0;  ///< displacement of the first mode in the second half
};

/// Modes of 1 Hz and more under a load on all of them, over `time`.
Driven drive(const std::vector<double>& omega, double damping_ratio, double dt, double time,
             const std::function<double(double)>& load, TimeScheme scheme = TimeScheme::trapezoidal,
             double start = 0) {
  const std::size_t n = omega.size();
  std::vector<double> damping, zero(n, 0), q(n, 0);
  for (const double w : omega) damping.push_back(2 * damping_ratio * w);
  q[0] = start;
  Oscillators modes(omega, damping, zero, {scheme}, nullptr);
  Motion seen(omega);
  ModalState now = modes.start(q, zero), next = now;
  Driven result;
  const int steps = int(std::lround(time / dt));
  for (int i = 0; i < steps; ++i) {
    modes.step(
        now, dt, [&](double t, std::span<double> f) { std::ranges::fill(f, load(i * dt + t)); }, next);
    seen.accepted(now, next, modes.load(), dt);
    std::swap(now, next);
    if (2 * i > steps) result.largest = std::max(result.largest, std::abs(now.q[0]));
  }
  result.evidence = seen.evidence(true);
  return result;
}

const auto none = [](double) { return 0.0; };

/// A clamped square plate under a pressure.
Parameters clamped(const std::string& pressure) {
  Parameters p;
  p.material = {1000, 1e9, 0.3};
  p.thickness = 0.01;
  p.number = 6;
  for (const char* patch : {"xmin", "xmax", "ymin", "ymax"}) p.boundaries[patch].support = Support::clamped;
  p.load.emplace().lower.emplace().text = pressure;
  return p;
}

TEST(PlateResolution, a_free_swing_counts_as_coarse_below_ten_steps_a_period) {
  for (const double steps : {1.3, 3., 9.}) {
    const Motion::Evidence e = drive({2 * pi}, 0, 1 / steps, 30, none, TimeScheme::trapezoidal, 1).evidence;
    EXPECT_NEAR(e.coarse_share, 1, 0.15) << steps;
    EXPECT_EQ(e.coarse_mode, 1);
    EXPECT_NEAR(e.steps_a_period, steps, 1e-9);
    EXPECT_NEAR(e.recommended_step, 0.05, 1e-9);
  }
  EXPECT_EQ(drive({2 * pi}, 0, 1. / 11, 30, none, TimeScheme::trapezoidal, 1).evidence.coarse_share, 0);
}

// At rest in the middle of every step: 2A, 0, 2A, 0 under a load that came at once.
TEST(PlateResolution, the_swing_of_steps_of_many_periods_is_seen) {
  for (const double steps_a_period : {1., 0.1, 0.001})
    for (const int steps : {10, 100})
      EXPECT_GT(drive({2 * pi}, 0, 1 / steps_a_period, steps / steps_a_period, [](double) { return 1.; })
                    .evidence.coarse_share,
                0.3)
          << steps_a_period << " " << steps;
}

TEST(PlateResolution, a_load_that_stays_beside_one_that_swings_drives_no_resonance) {
  // The first mode has the load that stays alone, to rounding.
  Oscillators modes({2 * pi, 30.}, {0, 0}, {0, 0}, {TimeScheme::trapezoidal}, nullptr);
  Motion seen(std::vector<double>{2 * pi, 30.});
  const std::vector<double> zero{0, 0};
  ModalState now = modes.start(zero, zero), next = now;
  for (int i = 0; i < 2000; ++i) {
    modes.step(
        now, 0.002,
        [&](double t, std::span<double> f) {
          const double swing = std::sin(2 * pi * 2 * (0.002 * i + t));
          f[0] = 5 + 1e-15 * swing, f[1] = swing;
        },
        next);
    seen.accepted(now, next, modes.load(), 0.002);
    std::swap(now, next);
  }
  EXPECT_LT(seen.evidence(true).resonance_error, 0.1);
}

TEST(PlateResolution, stiff_modes_that_follow_a_slow_load_may_have_any_step) {
  const auto slow = [](double t) { return std::pow(std::sin(2 * pi * t / 40), 2); };
  for (const TimeScheme scheme : {TimeScheme::trapezoidal, TimeScheme::bathe}) {
    const Motion::Evidence e = drive({2 * pi, 60, 900}, 0, 0.5, 40, slow, scheme).evidence;
    EXPECT_GE(e.coarse_share, 0) << name(scheme);
    EXPECT_LT(e.coarse_share, 0.1) << name(scheme);
  }
  // Put on at once the same load makes them swing, and that is not resolved.
  EXPECT_GT(drive({2 * pi, 60, 900}, 0, 0.5, 40, [](double) { return 1.; }).evidence.coarse_share, 0.5);
}

TEST(PlateResolution, high_modes_without_share_in_the_answer_do_not_matter) {
  const Motion::Evidence e = drive({2 * pi, 200, 900}, 0, 0.02, 10, [](double) { return 1.; }).evidence;
  EXPECT_GT(e.coarse_share, 0);
  EXPECT_LT(e.coarse_share, 0.01);
  EXPECT_LT(e.last_mode_omega, 100);
}

// The number is an estimate of the error near a resonance: of its size, and on the safe side.
TEST(PlateResolution, near_a_resonance_the_error_of_the_answer_is_foreseen) {
  const double w = 2 * pi, z = 0.03, drive_w = 0.97 * w;
  const double exact = 1 / std::hypot(w * w - drive_w * drive_w, 2 * z * w * drive_w);
  for (const double steps : {12., 25., 50., 100.}) {
    const Driven found = drive({w}, z, 1 / steps, 80, [&](double t) { return std::sin(drive_w * t); });
    const double error = std::abs(found.largest / exact - 1), number = found.evidence.resonance_error;
    EXPECT_GT(number, error) << steps;
    EXPECT_LT(number, 6 * error + 1e-3) << steps;
    EXPECT_EQ(number > 0.1, steps < 40) << steps << " " << number;
    RecordProperty(fmt::format("error-{:.0f}", steps), fmt::format("{:.3g} told {:.3g}", error, number));
  }
  // Loads that stay, and none, say nothing about a resonance.
  for (const TimeScheme scheme : {TimeScheme::trapezoidal, TimeScheme::euler, TimeScheme::bathe})
    EXPECT_TRUE(std::isnan(drive(
                               {w}, 0, 0.05, 80, [](double) { return 3.; }, scheme)
                               .evidence.resonance_error));
  EXPECT_TRUE(std::isnan(drive({w}, 0, 0.05, 80, none, TimeScheme::trapezoidal, 1).evidence.resonance_error));
}

TEST(PlateResolution, the_frequency_of_a_load_is_seen) {
  const std::vector<double> omega{2 * pi, 60};
  for (const double f : {0.3, 2., 9.}) {
    const Motion::Evidence e =
        drive(omega, 0.01, 0.004, 40, [&](double t) { return 3 + std::sin(2 * pi * f * t); }).evidence;
    EXPECT_NEAR(e.load_omega / (2 * pi * f), 1, 0.05) << f;
    EXPECT_DOUBLE_EQ(e.load_over_last, e.load_omega / 60);
  }
  // Ramps, jumps and a load that stays are no vibration, and jumps that come back swing as often as they come.
  const auto seen = [&](const std::function<double(double)>& load) {
    return drive(omega, 0.01, 0.004, 40, load).evidence.load_omega;
  };
  EXPECT_TRUE(std::isnan(seen([](double t) { return std::min(t / 0.1, 1.); })));
  EXPECT_TRUE(std::isnan(seen([](double t) { return t < 20 ? 1. : 0.; })));
  EXPECT_TRUE(std::isnan(seen([](double) { return 1.; })));
  EXPECT_NEAR(seen([](double t) { return std::sin(2 * pi * t) > 0 ? 1. : 0.; }), 2 * pi, 0.2);
}

// 3 t^2 Pa over a step of 1 s: 3/4 in the middle, 1 - 1/(4 n^2) as the mean of n samples.
TEST(PlateResolution, what_a_step_misses_of_a_load_is_its_mean_less_its_middle) {
  const mesh::RawMesh raw = square(4);
  Parameters p = clamped("3 * t^2");
  Structure plate(p, PlateContext{}, &raw);
  const diagnostics::Finding found = support::observe(plate, 1, 1).finding("step-that-resolves-the-load");
  EXPECT_NEAR(found.number, (1 - 1. / 196 - 0.75) / std::sqrt(9. / 5), 0.002);
}

TEST(PlateResolution, what_was_seen_goes_on_after_a_restart) {
  const std::vector<double> omega{2 * pi, 30}, zero{0, 0};
  Oscillators modes(omega, zero, zero, {}, nullptr);
  Motion whole(omega), first(omega), second(omega);
  ModalState now = modes.start({1, 0.1}, zero), next = now;
  for (int i = 0; i < 40; ++i) {
    modes.step(
        now, 0.15, [&](double t, std::span<double> f) { std::ranges::fill(f, std::sin(i * 0.15 + t)); },
        next);
    whole.accepted(now, next, modes.load(), 0.15);
    if (i == 20) base::from_numbers(base::to_numbers(first), second, "motion");
    (i < 20 ? first : second).accepted(now, next, modes.load(), 0.15);
    if (i == 20) {
      first.accepted(now, next, modes.load(), 0.15);
      base::from_numbers(base::to_numbers(first), second, "motion");
    }
    std::swap(now, next);
  }
  EXPECT_EQ(base::to_numbers(whole), base::to_numbers(second));
}

/// Finding about the impacts of a body that falls on a seat, with `steps` in a contact.
std::optional<diagnostics::Finding> bounce(double steps, double weight, int n, double speed) {
  const double kappa = 1e4, dt = pi / 100 / steps;
  Bounce one(kappa, speed == 0 ? -weight / kappa : 0.7 * dt, -speed, ContactRule::conserving, -weight);
  Parameters p;
  p.modes_file = "block";
  const Built built;
  const coupling::Step step{.dt = dt};
  const std::optional<Deflection> no_deflection;
  const std::vector<double> no_values;
  const bool acts = false;
  const PlateView view{p,    MPI_COMM_SELF, built,   one.surface, one.body,      &one.contact, nullptr,
                       step, one.next,      one.now, no_values,   no_deflection, no_values,    acts};
  diagnostics::Diagnostics all(0, false);
  add_diagnostics(view, all);
  for (int i = 0; i < n; ++i) {
    one.step(dt);
    all.accepted(dt * (i + 1));
  }
  all.look();
  for (const diagnostics::Finding& f : all.findings())
    if (f.id == "step-that-resolves-the-contact") return f;
  return {};
}

TEST(PlateResolution, a_contact_wants_ten_steps) {
  for (const double steps : {0.3, 1., 4., 20.}) {
    const auto found = bounce(steps, 0, 60, 1);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->number * steps, 1, 1e-9);
    EXPECT_EQ(found->severity > base::Severity::note, steps < 10);
    EXPECT_NE(found->advice.find("simulation.time-step: 0.0016 s"), std::string::npos) << found->advice;
  }
  // A body at rest on its seat, with a step of three contacts: nothing is hit.
  EXPECT_FALSE(bounce(0.3, 9.81, 200, 0));
}

TEST(PlateResolution, a_run_says_so) {
  using Names = std::vector<std::string>;
  const mesh::RawMesh raw = square(6);
  const auto run = [&](const std::string& pressure, double dt) {
    Parameters p = clamped(pressure);
    Structure plate(p, PlateContext{}, &raw);
    return support::observe(plate, int(std::lround(2 / dt)), dt);
  };
  // The small load moves the plate less than its weight would, and damping has time to act.
  const auto doubts = [&](const std::string& pressure, double dt) {
    Names names = run(pressure, dt).doubts();
    std::erase_if(names, [](const std::string& id) { return id == "gravity" || id == "damping"; });
    return names;
  };
  const auto has = [](const Names& names, const char* id) {
    return std::ranges::find(names, id) != names.end();
  };
  // The first mode has 16.5 Hz.
  EXPECT_EQ(doubts("10 * sin(2 * pi * 5 * t)", 0.002), Names{});
  EXPECT_EQ(doubts("10 * min(t, 1)", 0.2), Names{});
  const diagnostics::Finding coarse = run("t < 1 ? 10 : 0", 0.04).finding("step-that-resolves-the-modes");
  EXPECT_GT(coarse.severity, base::Severity::note);
  EXPECT_NE(coarse.advice.find("simulation.time-step: 0.003 s"), std::string::npos) << coarse.advice;
  // 40 Hz in steps of 40 ms look like 10 Hz.
  EXPECT_TRUE(has(doubts("10 * (1 + x) * sin(2 * pi * 40 * t)", 0.02), "step-that-resolves-the-load"));
  // A load that jumps on and off ten times is one that the step sees.
  EXPECT_FALSE(
      has(doubts("10 * (sin(2 * pi * 1.7 * t) > 0 ? 1 : 0.5)", 0.003), "step-that-resolves-the-load"));
  // Six modes of this plate end at 62 Hz: at 80 Hz one that was left out may be met, whose static share is small.
  const auto fast = [&](double f) {
    return doubts(fmt::format("10 * (1 + x) * sin(2 * pi * {} * t)", f), 0.0005);
  };
  EXPECT_EQ(fast(20), Names{});
  EXPECT_TRUE(has(fast(80), "load-faster-than-the-modes"));
}

}  // namespace couplet::plate::resolution_test
