// SPDX-License-Identifier: Apache-2.0
// Tests how findings change over a run, and the thresholds of the fluid's effects.
#include "common/diagnostics/diagnostics.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "fluid_solver/diagnostics/view.hpp"
#include "tests/support/test.hpp"

namespace couplet::testing::findings_test {
using namespace diagnostics;

using base::Severity;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Says the effect that `says` gives, when it is looked at or (with `at_end`) at the end.
class Saying final : public Diagnostic {
 public:
  Saying(std::function<EffectFinding()> says, bool at_end = false)
      : says_(std::move(says)), at_end_(at_end) {}
  void look(Report& report) override {
    if (!at_end_) say(report);
  }
  void conclude(Report& report) override {
    if (at_end_) say(report);
  }

 private:
  void say(Report& report) {
    if (auto finding = finding_of(says_())) report.findings.push_back(std::move(*finding));
  }
  std::function<EffectFinding()> says_;
  bool at_end_;
};

struct Judged {
  EffectFinding now{.effect = "balance of the kinetic energy",
                    .id = "energy-growth",
                    .limit = 0.1,
                    .what = "",
                    .left_out = false,
                    .wrong_from = 0.5};
  EffectFinding mean{.effect = "waves of pressure", .number = NAN, .limit = 0.1, .what = "", .share = NAN};
  Diagnostics all{0, When::with_errors};
  std::size_t before = diagnostics::findings().size();
  Judged() {
    spdlog::set_level(spdlog::level::off);
    all.add("now", std::make_shared<Saying>([this] { return now; }));
    all.add("mean", std::make_shared<Saying>([this] { return mean; }, true));
  }
  Judged(const Judged&) = delete;
  /// Findings told after a step with this number.
  std::size_t step(double number) {
    now.number = number;
    const std::size_t told = diagnostics::findings().size();
    all.accepted(1);
    all.look();
    return diagnostics::findings().size() - told;
  }
};

TEST(Findings, are_told_once_and_again_when_they_turn_wrong) {
  Judged run;
  EXPECT_EQ(run.step(0.05), 0u);
  EXPECT_EQ(run.step(0.2), 1u);
  EXPECT_EQ(diagnostics::findings().back().id, "energy-growth");
  EXPECT_EQ(diagnostics::findings().back().severity, Severity::warning);
  EXPECT_EQ(run.step(0.4), 0u);
  EXPECT_EQ(run.step(0.6), 1u);
  EXPECT_EQ(diagnostics::findings().back().severity, Severity::wrong);
  EXPECT_EQ(run.step(0.7), 0u);
  EXPECT_EQ(run.step(0.05), 0u);
  // A fault in the midst of a run is still known at its end.
  const std::vector<std::string> lines = run.all.conclude(false);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("(limit 0.1): wrong"));
}

TEST(Findings, of_means_over_the_run_count_at_its_end) {
  Judged run;
  run.mean.number = run.mean.share = 0.42;
  EXPECT_EQ(run.step(0.01), 0u);
  run.mean.number = run.mean.share = 3e-4;
  EXPECT_THAT(run.all.conclude(false),
              ::testing::Contains(HasSubstr("this changes the result by 0.03 % (limit 5 %): justified")));
  EXPECT_EQ(diagnostics::findings().size(), run.before);
}

TEST(Findings, make_the_models_part_of_the_error) {
  Judged run;
  run.now = {
      .effect = "inertia", .number = 0.001, .limit = 0.01, .what = "inertia / load = 0.001", .share = 0.02};
  run.mean = {.effect = "thermal strain",
              .number = 2,
              .limit = 0.1,
              .what = "",
              .advice = "use 'thermal-expansion'",
              .share = 0.3};
  run.all.accepted(1);
  run.all.conclude(false);
  EXPECT_NEAR(run.all.errors().model, 0.32, 1e-12);
  EXPECT_EQ(run.all.errors().model_by, "thermal strain neglected: use 'thermal-expansion'");
}

TEST(Findings, and_their_severity_go_through_a_checkpoint) {
  Judged first;
  first.step(0.2);
  io::StateInMemory memory;
  io::CheckpointWriter out(memory);
  io::Archive save(out);
  first.all.visit(save);
  out.close();
  first.step(0.05);
  const std::vector<std::string> unbroken = first.all.conclude(false);

  Judged second;
  io::CheckpointReader in(memory);
  io::Archive load(in);
  second.all.visit(load);
  EXPECT_EQ(second.step(0.15), 0u) << "it was told before";
  EXPECT_EQ(second.all.conclude(false), unbroken);
}

TEST(Findings, say_number_limit_and_cure) {
  const auto bad = finding_of({.effect = "inertia",
                               .number = 0.3,
                               .limit = 0.01,
                               .what = "inertia / load = 0.3",
                               .advice = "use 'analysis: dynamic'",
                               .share = 0.2});
  ASSERT_TRUE(bad);
  EXPECT_EQ(bad->id, "inertia");
  EXPECT_EQ(bad->sentence,
            "inertia neglected: inertia / load = 0.3; this changes the result by 20 % (limit 5 %): matters");
  EXPECT_EQ(bad->advice, "use 'analysis: dynamic'");
  EXPECT_FALSE(finding_of({.effect = "inertia", .number = NAN, .limit = 0.01, .what = ""}));
}

// The share alone decides, against the one limit that a case may set.
TEST(Findings, on_neglected_effects_turn_at_the_share_that_matters) {
  const auto with_share = [](double share, double number = 1) {
    return *finding_of({.effect = "inertia", .number = number, .limit = 0.1, .what = "x", .share = share});
  };
  EXPECT_EQ(with_share(0.049).severity, Severity::note);
  EXPECT_EQ(with_share(0.05).severity, Severity::warning);
  EXPECT_EQ(with_share(0.05, 1e-9).severity, Severity::warning);
  EXPECT_EQ(with_share(1).severity, Severity::warning);
  EXPECT_EQ(with_share(1.01).severity, Severity::wrong);
  diagnostics::share_limit() = 0.2;
  EXPECT_EQ(with_share(0.19).severity, Severity::note);
  EXPECT_EQ(with_share(0.21).limit, 0.2);
  diagnostics::share_limit() = 0.05;
  for (const double number : {0.05, 0.2}) {
    const Finding f = with_share(NAN, number);
    EXPECT_EQ(f.sentence, "inertia neglected: x (limit 0.1): its effect on the result is unknown");
    EXPECT_EQ(f.severity, number > 0.1 ? Severity::warning : Severity::note);
  }
}

bool sound(const EffectFinding& effect) { return finding_of(effect)->severity == Severity::note; }

// Each pair lies just inside and just outside of validity.
TEST(FluidFindings, on_layers_turn_at_their_limits) {
  constexpr double turbulent = 1e9;
  EXPECT_TRUE(sound(fluid::unresolved_layers(3, 49, 0, turbulent)));
  EXPECT_TRUE(sound(fluid::unresolved_layers(3, 55, 0, turbulent))) << "5 % thicker layers, no walls";
  EXPECT_FALSE(sound(fluid::unresolved_layers(3, 56, 0, turbulent)));
  EXPECT_TRUE(sound(fluid::unresolved_layers(3, 275, 0.99, turbulent)));
  EXPECT_FALSE(sound(fluid::unresolved_layers(3, 279, 0.99, turbulent)));
  EXPECT_FALSE(sound(fluid::unresolved_layers(3, 56, 1.01, turbulent)));
  EXPECT_TRUE(sound(fluid::unresolved_layers(3, 500, 1.01, 3400))) << "laminar";
  EXPECT_FALSE(sound(fluid::unresolved_layers(3, 56, 1.01, 3500)));
  EXPECT_NEAR(fluid::unresolved_layers(2, 500, 0, turbulent).share, 1 - std::sqrt(0.1), 1e-12);
  EXPECT_THAT(fluid::unresolved_layers(2, 500, 0, turbulent).advice, HasSubstr("'dimension: 3'"));
  EXPECT_TRUE(sound(fluid::unresolved_walls(1.9)));
  EXPECT_FALSE(sound(fluid::unresolved_walls(2.1)));
}

TEST(FluidFindings, on_eddies_say_that_they_could_be_omitted_or_model_nothing_in_two_dimensions) {
  EXPECT_THAT(
      finding_of(fluid::eddies(3, 0.002))->sentence,
      HasSubstr("turbulence model (max eddy viscosity = 0.002 times the molecular viscosity; limit 0.01)"));
  EXPECT_THAT(finding_of(fluid::eddies(3, 0.02))->sentence, HasSubstr("needed"));
  EXPECT_GT(finding_of(fluid::eddies(2, 0.009))->saves, 0);
  EXPECT_EQ(finding_of(fluid::eddies(2, 0.011))->saves, 0);
  EXPECT_NEAR(fluid::eddies(2, 3).share, 0.5, 1e-12);
  EXPECT_THAT(fluid::eddies(2, 100).advice, HasSubstr("represents no turbulence"));
}

// SF6 at 48 m/s, and a reed's channel of 60 mm and 20 cm^3 with a stroke of 0.2 cm^3.
TEST(FluidFindings, on_compressibility_judge_by_what_it_does) {
  const auto sound_by = [](double density, double viscosity) {
    return *fluid::sound_of(std::nullopt, density, viscosity);
  };
  const auto mach = fluid::mach_number(48, sound_by(6.17, 1.5e-5));
  EXPECT_NEAR(mach.number, 0.36, 0.01);
  EXPECT_FALSE(sound(mach));
  EXPECT_TRUE(sound(fluid::mach_number(38, sound_by(6.17, 1.5e-5))));
  EXPECT_TRUE(sound(fluid::mach_number(104, sound_by(1.2, 1.8e-5))));
  EXPECT_FALSE(sound(fluid::mach_number(106, sound_by(1.2, 1.8e-5))));
  EXPECT_FALSE(fluid::sound_of(std::nullopt, 1, 1)) << "a model fluid of which nothing can be said";
  // 0.05 rho c^2 of air at 1 atm: 1.4 x 101325 / 20 = 7093 Pa; of water 1000 x 1482^2 / 20 = 1.0982e8 Pa.
  const fluid::Sound air = sound_by(1.2, 1.8e-5), water = sound_by(1000, 1e-3);
  EXPECT_TRUE(sound(fluid::change_of_density(false, 1.2, 7080, 0, air)));
  EXPECT_FALSE(sound(fluid::change_of_density(false, 1.2, 7100, 0, air)));
  EXPECT_TRUE(sound(fluid::change_of_density(false, 1000, 1.09e8, 0, water)));
  EXPECT_FALSE(sound(fluid::change_of_density(false, 1000, 1.10e8, 0, water)));
  const fluid::Sound channel = sound_by(1.184, 1.85e-5);
  const double stroke = 2e-7, rho_c2 = 1.4 * 101325, rate = 930;
  EXPECT_TRUE(sound(fluid::compliance(1.184, stroke, 0.049 * stroke * rho_c2, channel)));
  EXPECT_FALSE(sound(fluid::compliance(1.184, stroke, 0.051 * stroke * rho_c2, channel)));
  EXPECT_TRUE(sound(fluid::wave_time(rate, 0.37 * 346.1 / rate, channel)));
  EXPECT_FALSE(sound(fluid::wave_time(rate, 0.39 * 346.1 / rate, channel)));
}

}  // namespace couplet::testing::findings_test
