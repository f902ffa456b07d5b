// SPDX-License-Identifier: Apache-2.0
// Frequency of a load, and findings of a run that its time step does not resolve: they fire where the answer is wrong, and are
// silent where it is right.
#include "plate_modal/diagnostics/motion.hpp"

#include "common/base/numbers.hpp"
#include "plate_modal/structure.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/verification/plate/plates.hpp"

namespace couplet::plate::resolution_test {
using namespace time;

using namespace test;
constexpr double pi = std::numbers::pi;

/// Frequency of a load on modes of 1 Hz and more, over `time`.
Motion::LoadFrequency drive(const std::vector<double>& omega, double damping_ratio, double dt, double time,
                            const std::function<double(double)>& load) {
  const std::size_t n = omega.size();
  std::vector<double> damping, zero(n, 0);
  for (const double w : omega) damping.push_back(2 * damping_ratio * w);
  Oscillators modes(omega, damping, zero, {TimeScheme::trapezoidal}, nullptr);
  Motion seen(omega);
  ModalState now = modes.start(zero, zero), next = now;
  const int steps = int(std::lround(time / dt));
  for (int i = 0; i < steps; ++i) {
    modes.step(
        now, dt, [&](double t, std::span<double> f) { std::ranges::fill(f, load(i * dt + t)); }, next);
    seen.accepted(now, next, modes.load(), dt);
    std::swap(now, next);
  }
  return seen.load_frequency(true);
}

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

TEST(PlateResolution, the_frequency_of_a_load_is_seen) {
  const std::vector<double> omega{2 * pi, 60};
  for (const double f : {0.3, 2., 9.}) {
    const Motion::LoadFrequency e =
        drive(omega, 0.01, 0.004, 40, [&](double t) { return 3 + std::sin(2 * pi * f * t); });
    EXPECT_NEAR(e.omega / (2 * pi * f), 1, 0.05) << f;
    EXPECT_DOUBLE_EQ(e.over_last, e.omega / 60);
  }
  // Ramps, jumps and a load that stays are no vibration, and jumps that come back swing as often as they come.
  const auto seen = [&](const std::function<double(double)>& load) {
    return drive(omega, 0.01, 0.004, 40, load).omega;
  };
  EXPECT_TRUE(std::isnan(seen([](double t) { return std::min(t / 0.1, 1.); })));
  EXPECT_TRUE(std::isnan(seen([](double t) { return t < 20 ? 1. : 0.; })));
  EXPECT_TRUE(std::isnan(seen([](double) { return 1.; })));
  EXPECT_NEAR(seen([](double t) { return std::sin(2 * pi * t) > 0 ? 1. : 0.; }), 2 * pi, 0.2);
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
  const PlateView view{p,    MPI_COMM_SELF, built,   one.surface, one.body,      &one.contact, nullptr,
                       step, one.next,      one.now, no_values,   no_deflection, no_values};
  diagnostics::Diagnostics all(0, diagnostics::When::always);
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
  const auto doubts = [&](const std::string& pressure, double dt) { return run(pressure, dt).doubts(); };
  const auto has = [](const Names& names, const char* id) {
    return std::ranges::find(names, id) != names.end();
  };
  // The first mode has 16.5 Hz.
  EXPECT_EQ(doubts("10 * sin(2 * pi * 5 * t)", 0.002), Names{});
  EXPECT_EQ(doubts("10 * min(t, 1)", 0.2), Names{});
  // Below ten steps per period, at a load that jumps, near a resonance and at a load of 40 Hz that steps of 20 ms see as 10 Hz.
  const auto step_error = [&](const std::string& pressure, double dt) {
    return run(pressure, dt).diagnostics().errors().step;
  };
  EXPECT_GT(step_error("t < 1 ? 10 : 0", 0.04), 0.3);
  EXPECT_GT(step_error("10 * sin(2 * pi * 16 * t)", 0.006), 0.15);
  EXPECT_GT(step_error("10 * (1 + x) * sin(2 * pi * 40 * t)", 0.02), 0.3);
  // Six modes of this plate end at 62 Hz: at 80 Hz one that was left out may be met, whose static share is small.
  const auto fast = [&](double f) {
    return doubts(fmt::format("10 * (1 + x) * sin(2 * pi * {} * t)", f), 0.0005);
  };
  EXPECT_EQ(fast(20), Names{});
  EXPECT_TRUE(has(fast(80), "deflection-beyond-the-modes"));
}

}  // namespace couplet::plate::resolution_test
