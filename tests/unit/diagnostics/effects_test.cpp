// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/diagnostics.hpp"
#include "fluid_solver/diagnostics/view.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "plate_modal/model/parameters.hpp"
#include "solid_solver/diagnostics/neglected.hpp"
#include "tests/support/test.hpp"
#include "thermocline/diagnostics/tank_diagnostic.hpp"

namespace couplet::testing::cards_test {
using namespace diagnostics;
using namespace solid;

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The finding with this id, or nothing.
std::optional<diagnostics::Finding> with_id(const std::string& id,
                                            const std::vector<diagnostics::Finding>& findings) {
  for (const diagnostics::Finding& f : findings)
    if (f.id == id) return f;
  return {};
}

/// Tells whether there is such a finding and it is sound.
bool is_sound(const std::string& id, const std::vector<diagnostics::Finding>& findings) {
  const auto found = with_id(id, findings);
  EXPECT_TRUE(found.has_value()) << id;
  return found && found->severity == base::Severity::note;
}

/// Gives the model's part of the error that findings add up to.
diagnostics::ErrorParts model_of(const std::vector<diagnostics::Finding>& findings) {
  diagnostics::ErrorParts parts;
  diagnostics::add_model(findings, parts);
  return parts;
}

SolidParameters static_solid() {
  SolidParameters p;
  p.analysis = SolidParameters::Analysis::static_;
  p.material = {.density = 1000, .youngs_modulus = 1e9, .poissons_ratio = 0.3};
  return p;
}

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Opinion on small strain by the largest gradient, without or with the first terms of an expansion, and the buckling factor.
Opinion on_geometry(double gradient, double buckling_factor = unknown, bool is_bounded = false) {
  return neglected_geometry(static_solid(), {.gradient = gradient}, {}, is_bounded, buckling_factor);
}

TEST(Effects, without_evidence_there_is_no_verdict) {
  const SolidParameters p = static_solid();
  EXPECT_FALSE(neglected_inertia(p, unknown));
  EXPECT_FALSE(on_geometry(unknown));
  EXPECT_FALSE(neglected_yielding(unknown));
  EXPECT_FALSE(neglected_thermal_strain(p, unknown, unknown, unknown));
  EXPECT_FALSE(thermoelastic_coupling(p, unknown));
}

// Each share is what a closed form says of the answer.
TEST(Effects, neglected_effects_say_what_share_of_the_answer_they_change) {
  const SolidParameters p = static_solid();
  const auto model = [&](const Opinion& opinion) { return model_of({opinion.value()}); };
  EXPECT_DOUBLE_EQ(model(neglected_inertia(p, 0.2)).model, 0.25);
  EXPECT_DOUBLE_EQ(model(neglected_inertia(p, 430)).model, 1);
  SolidParameters expanding = p;
  expanding.material.heat.expansion = config::ExpressionText{"1e-5"};
  const diagnostics::ErrorParts hot = model(neglected_thermal_strain(expanding, 1e-6, 75, unknown));
  EXPECT_NEAR(hot.model, 750, 1e-9);
  EXPECT_EQ(hot.model_by, "thermal strain neglected: use 'thermal-expansion'");
  // The elastica: a cantilever with P L^2 / (E I) = 1 has a slope of 0.46 at its tip, which moves 9.5 % less than the linear one.
  EXPECT_NEAR(model(on_geometry(0.46 * std::sqrt(2.))).model, 0.095, 0.02);
  EXPECT_DOUBLE_EQ(model(on_geometry(1e-4, 3)).model, 0.5);
  EXPECT_DOUBLE_EQ(model(on_geometry(1e-4, 1.5)).model, 1) << "if something moves it sideways";
  EXPECT_DOUBLE_EQ(model(on_geometry(1e-4, 0)).model, 10);
  EXPECT_TRUE(std::isnan(model_of({}).model));
}

TEST(Effects, what_does_next_to_nothing_could_be_omitted) {
  const auto idle = [](double energies) {
    const Opinion opinion = spare_inertia(energies, 100);
    return opinion ? model_of({*opinion}).omittable : "";
  };
  EXPECT_THAT(idle(5e-4), HasSubstr("inertia (max kinetic / largest strain energy = 0.0005"));
  EXPECT_THAT(idle(5e-4), HasSubstr("saves about 99 % of the time"));
  EXPECT_THAT(idle(5e-3), IsEmpty());
}

// Each pair lies just inside and just outside of validity.
TEST(Effects, solid_verdicts_turn_at_their_thresholds) {
  const SolidParameters p = static_solid();
  const auto sound = [](const Opinion& opinion) { return opinion.value().severity == base::Severity::note; };
  EXPECT_TRUE(sound(neglected_inertia(p, 0.047)));
  EXPECT_FALSE(sound(neglected_inertia(p, 0.048)));
  EXPECT_TRUE(sound(on_geometry(0.0199)));
  EXPECT_FALSE(sound(on_geometry(0.0201)));
  for (const double gradient : {1e-6, 0.0199, 0.0201})
    EXPECT_THAT(on_geometry(gradient)->sentence, HasSubstr("its effect on the result is unknown"))
        << gradient;
  EXPECT_THAT(on_geometry(0.3, unknown, true)->sentence,
              HasSubstr("this changes the result by 1.8 % (limit 5 %): justified"));
  EXPECT_THAT(on_geometry(0.51)->sentence,
              HasSubstr("this changes the result by 5.2 % (limit 5 %): matters"));
  EXPECT_THAT(on_geometry(1e-4, 21.5)->sentence, HasSubstr("4.9 % (limit 5 %): justified"));
  SolidParameters warm = p;
  warm.material.heat.expansion = config::ExpressionText{"2e-5"};
  EXPECT_TRUE(sound(neglected_thermal_strain(warm, 0.01, 0, 24)));
  EXPECT_FALSE(sound(neglected_thermal_strain(warm, 0.01, 0, 26)));
  warm.material.heat.expansion = config::ExpressionText{"1e-7"};
  EXPECT_TRUE(sound(neglected_thermal_strain(warm, 0.01, 400, 400)));
  EXPECT_TRUE(sound(thermoelastic_coupling(p, 0.049)));
  EXPECT_FALSE(sound(thermoelastic_coupling(p, 0.051)));
  EXPECT_TRUE(sound(neglected_yielding(1.049)));
  EXPECT_FALSE(sound(neglected_yielding(1.051)));
  SolidParameters rubber = p;
  rubber.method.face_gradient = MethodParameters::FaceGradient::thesis;
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(sound(near_incompressibility(rubber)));
  rubber.material.poissons_ratio = 0.449;
  EXPECT_TRUE(sound(near_incompressibility(rubber)));
  rubber.method.face_gradient = MethodParameters::FaceGradient::automatic;  // takes one volume strain a cell
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(near_incompressibility(rubber));
}

// Their numbers rest on 2 % of the critical damping and on a coefficient that the case does not give.
TEST(Effects, what_rests_on_an_assumption_is_an_information) {
  SolidParameters p = static_solid();
  p.material.youngs_modulus = 210e9;
  for (const Opinion& told : {neglected_damping(p, 100), neglected_thermal_strain(p, 1e-6, 75, unknown)}) {
    EXPECT_EQ(told.value().severity, base::Severity::note) << told->sentence;
    EXPECT_GT(told->number, 0.2);
    EXPECT_TRUE(std::isnan(model_of({*told}).model));
  }
  EXPECT_NEAR(neglected_damping(p, 100)->number, 1 - std::exp(-2), 1e-12);
}

TEST(Effects, an_effect_that_is_on_is_not_judged_as_left_out) {
  SolidParameters p = static_solid();
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_FALSE(neglected_inertia(p, 1));
}

TEST(Sound, is_that_of_a_key_or_a_density_or_none) {
  using fluid::CompressibilityParameters;
  const auto speed = [](const CompressibilityParameters& p, double rho, double mu) {
    const auto sound = fluid::sound_of(p, rho, mu);
    return sound ? sound->speed : 0;
  };
  CompressibilityParameters p;
  EXPECT_NEAR(speed(p, 1.204, 1.8e-5), 343, 2) << "air by its density";
  EXPECT_NEAR(speed(p, 998, 1e-3), 1482, 1) << "water";
  EXPECT_EQ(speed(p, 1, 1), 0) << "a model fluid";
  EXPECT_EQ(speed(p, 1, 1e-3), 0);
  p.speed_of_sound = 77;
  EXPECT_EQ(speed(p, 1.2, 1.8e-5), 77);
}

TEST(ComplianceMeans, finds_the_fluctuations_of_a_harmonic_motion) {
  fluid::ComplianceMeans watch;
  const double omega = 7, dt = 1e-3;
  for (int n = 0; n * dt < 10 * 2 * M_PI / omega; ++n) {
    const double t = n * dt, s = std::sin(omega * t);
    // Two faces of a plate, a mean deflection; the pressure at rest is no part of it.
    watch.add(dt, {1e-6 * (3 + s), -1e-6 * (3 + s)}, {.swept = 0, .pressure_volume = 5 + 0.2 * s});
  }
  const auto walls = watch.walls();
  EXPECT_NEAR(std::sqrt(walls.rate / walls.square), omega, 0.01 * omega);
  EXPECT_NEAR(0.5 * walls.size, 1e-6 / std::sqrt(2.0), 1e-8);
  EXPECT_NEAR(watch.totals().pressure_volume, 0.2 / std::sqrt(2.0), 2e-3);
  EXPECT_EQ(watch.totals().swept, 0);
}

TEST(ComplianceMeans, knows_nothing_of_walls_at_rest_and_of_the_first_step) {
  fluid::ComplianceMeans watch;
  watch.add(0.1, {0, 0}, {.pressure_volume = 1e9});
  EXPECT_EQ(watch.totals().pressure_volume, 0) << "the impulse of the start";
  for (int n = 0; n < 5; ++n) watch.add(0.1, {0, 0}, {});
  EXPECT_EQ(watch.walls().square, 0);
}

}  // namespace couplet::testing::cards_test
