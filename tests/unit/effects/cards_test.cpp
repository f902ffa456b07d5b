// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.hpp"
#include "common/effects/card.hpp"
#include "coupler/parameters/effect_cards.hpp"
#include "coupler/parameters/schedule.hpp"
#include "fluid_solver/diagnostics/compliance.hpp"
#include "fluid_solver/parameters/effect_cards.hpp"
#include "plate_modal/effect_cards.hpp"
#include "solid_solver/effects/effect_cards.hpp"
#include "thermocline/judge/effect_cards.hpp"

namespace couplet::testing::cards_test {
using namespace effects;
using namespace coupler;
using namespace solid;
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The verdict on one effect, or nothing.
template <class Cards, class Scene, class Evidence>
std::optional<EffectVerdict> verdict_on(const std::string& effect, Cards cards, const Scene& scene,
                                        const Evidence& evidence) {
  for (const EffectVerdict& v : audit(cards, scene, evidence))
    if (v.effect == effect) return v;
  return {};
}

SolidParameters static_solid() {
  SolidParameters p;
  p.analysis = SolidParameters::Analysis::static_;
  p.material = {.density = 1000, .youngs_modulus = 1e9, .poissons_ratio = 0.3};
  return p;
}

TEST(EffectCards, a_scene_has_the_effects_that_it_asks_for_and_no_others) {
  SolidParameters p = static_solid();
  p.gravity = {0, 0, -9.81};
  std::vector<std::string> on;
  for (const Effect& e : effects_of("solid_solver", solid_effect_cards(), p))
    if (e.on()) on.push_back(e.name);
  EXPECT_THAT(on, ElementsAre("gravity", "third dimension"));
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_THAT(summary(effects_of("solid_solver", solid_effect_cards(), p)),
              HasSubstr("inertia (analysis: dynamic)"));
}

TEST(EffectCards, without_evidence_there_is_no_verdict) {
  SolidParameters p = static_solid();
  for (const EffectVerdict& v : audit(solid_effect_cards(), p, SolidEvidence{}))
    EXPECT_EQ(v.effect, "near incompressibility");
  EXPECT_THAT(audit(fluid::fluid_effect_cards(), fluid::FluidScene{}, fluid::FluidEvidence{}), IsEmpty());
}

// Each share is what a closed form says of the answer.
TEST(EffectCards, neglected_effects_say_what_share_of_the_answer_they_change) {
  const SolidParameters p = static_solid();
  const auto model = [&](const SolidEvidence& e) { return model_error(audit(solid_effect_cards(), p, e)); };
  EXPECT_DOUBLE_EQ(model({.inertia_over_load = 0.04}).sum, 0.04);
  EXPECT_DOUBLE_EQ(model({.inertia_over_load = 430}).sum, 1);
  const ModelError hot = model({.largest_gradient = 1e-6, .temperature_range = 75});
  EXPECT_NEAR(hot.sum, 750, 1e-9);
  EXPECT_EQ(hot.largest, "thermal strain neglected: use 'thermal-expansion'");
  // The elastica: a cantilever with P L^2 / (E I) = 1 has a slope of 0.46 at its tip, which moves 9.5 % less than the linear one.
  EXPECT_NEAR(model({.largest_gradient = 0.46 * std::sqrt(2.)}).sum, 0.095, 0.02);
  EXPECT_DOUBLE_EQ(model({.largest_gradient = 1e-4, .buckling_factor = 1.5}).sum, 2);
  EXPECT_DOUBLE_EQ(model({.largest_gradient = 1e-4, .buckling_factor = 0}).sum, 10);
  EXPECT_TRUE(std::isnan(model_error(audit(solid_effect_cards(), p, SolidEvidence{})).sum));
}

TEST(EffectCards, what_does_next_to_nothing_could_be_omitted) {
  SolidParameters p = static_solid();
  p.analysis = SolidParameters::Analysis::dynamic;
  const auto idle = [&](double energies) {
    return model_error(audit(solid_effect_cards(), p,
                             SolidEvidence{.kinetic_over_strain = energies, .dynamic_steps = 100}))
        .omittable;
  };
  EXPECT_THAT(idle(5e-4), HasSubstr("inertia (max kinetic / largest strain energy = 0.0005"));
  EXPECT_THAT(idle(5e-4), HasSubstr("saves about 99 % of the time"));
  EXPECT_THAT(idle(5e-3), IsEmpty());
  fluid::FluidScene scene;
  scene.parameters.turbulence.emplace();
  const auto model = [&](double eddy) {
    return model_error(
               audit(fluid::fluid_effect_cards(), scene, fluid::FluidEvidence{.eddy_viscosity = eddy}))
        .omittable;
  };
  EXPECT_THAT(model(0.002),
              HasSubstr("turbulence model (max eddy viscosity = 0.002 of the molecular; limit 0.01) saves"));
  EXPECT_THAT(model(0.02), IsEmpty());
}

// Each pair lies just inside and just outside of validity.
TEST(EffectCards, solid_verdicts_turn_at_their_thresholds) {
  const SolidParameters p = static_solid();
  const auto sound = [&](const char* effect, const SolidEvidence& e, const SolidParameters& scene) {
    const auto v = verdict_on(effect, solid_effect_cards(), scene, e);
    EXPECT_TRUE(v.has_value()) << effect;
    return v && v->sound();
  };
  EXPECT_TRUE(sound("inertia", {.inertia_over_load = 0.0099}, p));
  EXPECT_FALSE(sound("inertia", {.inertia_over_load = 0.0101}, p));
  EXPECT_TRUE(sound("geometric non-linearity", {.largest_gradient = 0.0199}, p));
  EXPECT_FALSE(sound("geometric non-linearity", {.largest_gradient = 0.0201}, p));
  EXPECT_TRUE(sound("thermal strain", {.largest_gradient = 0.01, .temperature_range = 19}, p));
  EXPECT_FALSE(sound("thermal strain", {.largest_gradient = 0.01, .temperature_range = 21}, p));
  // With a coefficient of its own, from the reference temperature on; without one a uniform temperature may be that of no stress.
  SolidParameters warm = p;
  warm.material.heat.expansion = config::ExpressionText{"2e-5"};
  EXPECT_TRUE(sound("thermal strain",
                    {.largest_gradient = 0.01, .temperature_range = 0, .temperature_change = 9}, warm));
  EXPECT_FALSE(sound("thermal strain",
                     {.largest_gradient = 0.01, .temperature_range = 0, .temperature_change = 11}, warm));
  EXPECT_TRUE(sound("thermal strain",
                    {.largest_gradient = 0.01, .temperature_range = 0, .temperature_change = 400}, p));
  warm.material.heat.expansion = config::ExpressionText{"1e-7"};
  EXPECT_TRUE(sound("thermal strain",
                    {.largest_gradient = 0.01, .temperature_range = 400, .temperature_change = 400}, warm));
  EXPECT_TRUE(sound("thermoelastic coupling", {.coupling_number = 0.049}, p));
  EXPECT_FALSE(sound("thermoelastic coupling", {.coupling_number = 0.051}, p));
  EXPECT_TRUE(sound("yielding", {.share_of_yield = 0.99}, p));
  EXPECT_FALSE(sound("yielding", {.share_of_yield = 1.01}, p));
  SolidParameters rubber = p;
  rubber.method.face_gradient = MethodParameters::FaceGradient::corrected;
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(sound("near incompressibility", {}, rubber));
  rubber.material.poissons_ratio = 0.449;
  EXPECT_TRUE(sound("near incompressibility", {}, rubber));
  rubber.method.face_gradient = MethodParameters::FaceGradient::automatic;  // takes one volume strain a cell
  rubber.material.poissons_ratio = 0.451;
  EXPECT_FALSE(
      verdict_on("near incompressibility", solid_effect_cards(), rubber, SolidEvidence{}).has_value());
}

TEST(EffectCards, an_effect_that_is_on_is_not_judged_as_left_out) {
  SolidParameters p = static_solid();
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_FALSE(verdict_on("inertia", solid_effect_cards(), p, SolidEvidence{.inertia_over_load = 1}));
}

TEST(EffectCards, fluid_verdicts_turn_at_their_thresholds) {
  fluid::FluidScene air, model;
  air.parameters.density = 1.2;
  air.parameters.viscosity = 1.8e-5;
  model.parameters.turbulence.emplace();
  const auto sound = [&](const char* effect, const fluid::FluidEvidence& e, const fluid::FluidScene& scene) {
    const auto v = verdict_on(effect, fluid::fluid_effect_cards(), scene, e);
    EXPECT_TRUE(v.has_value()) << effect;
    return v && v->sound();
  };
  EXPECT_TRUE(sound("turbulence model", {.largest_peclet = 49}, air));
  EXPECT_FALSE(sound("turbulence model", {.largest_peclet = 51}, air));
  EXPECT_TRUE(sound("turbulence model", {.largest_peclet = 249, .largest_yplus = 0.99}, air));
  EXPECT_FALSE(sound("turbulence model", {.largest_peclet = 251, .largest_yplus = 0.99}, air));
  EXPECT_FALSE(sound("turbulence model", {.largest_peclet = 51, .largest_yplus = 1.01}, air));
  EXPECT_FALSE(sound("turbulence model", {.largest_peclet = 51, .largest_yplus = 0}, air)) << "no walls";
  fluid::FluidScene slow = air;
  slow.parameters.viscosity = 1.2e-3;  // nu = 1e-3 m^2/s
  EXPECT_TRUE(sound("turbulence model", {.largest_peclet = 51, .largest_speed = 1, .width = 3.4}, slow))
      << "laminar";
  EXPECT_FALSE(sound("turbulence model", {.largest_peclet = 51, .largest_speed = 1.1, .width = 3.4}, slow));
  EXPECT_TRUE(sound("resolved walls", {.largest_yplus = 1.9}, model));
  EXPECT_FALSE(sound("resolved walls", {.largest_yplus = 2.1}, model));
  EXPECT_TRUE(sound("compressibility", {.largest_speed = 102}, air));
  EXPECT_FALSE(sound("compressibility", {.largest_speed = 104}, air));
  // 0.05 rho c^2 of air at 1 atm: 1.4 x 101325 / 20 = 7093 Pa; of water 1000 x 1482^2 / 20 = 1.0982e8 Pa.
  fluid::FluidScene water;
  water.parameters.density = 1000;
  EXPECT_TRUE(sound("waves of pressure", {.pressure_range = 7080}, air));
  EXPECT_FALSE(sound("waves of pressure", {.pressure_range = 7100}, air));
  EXPECT_TRUE(sound("waves of pressure", {.pressure_range = 1.09e8}, water));
  EXPECT_FALSE(sound("waves of pressure", {.pressure_range = 1.10e8}, water));
  EXPECT_TRUE(sound("mesh motion", {.wall_displacement = 0.099}, air));
  EXPECT_FALSE(sound("mesh motion", {.wall_displacement = 0.101}, air));
  EXPECT_TRUE(sound("balance of the kinetic energy", {.energy_excess = 0.09}, air));
  EXPECT_FALSE(sound("balance of the kinetic energy", {.energy_excess = 0.11}, air));
  fluid::FluidScene lid = air, valve = air;
  lid.parameters.boundaries["lid"].type = fluid::BoundaryType::moving_wall;
  EXPECT_TRUE(sound("walls that move along themselves", {.through_walls = 0.09}, lid));
  EXPECT_FALSE(sound("walls that move along themselves", {.through_walls = 0.11}, lid));
  valve.parameters.gaps["slot"] = {};
  EXPECT_TRUE(sound("gaps that close", {.blocked_cells = 0.4}, valve));
  EXPECT_FALSE(sound("gaps that close", {.blocked_cells = 0.6}, valve));
  fluid::FluidScene moving = air;
  moving.moving_mesh = true;
  EXPECT_FALSE(verdict_on("mesh motion", fluid::fluid_effect_cards(), moving,
                          fluid::FluidEvidence{.wall_displacement = 10}));
  EXPECT_FALSE(verdict_on("turbulence model", fluid::fluid_effect_cards(), model,
                          fluid::FluidEvidence{.largest_peclet = 1e4}));
}

// The same verdict on the turbulence as without the model, and one on the viscosity that it adds.
TEST(EffectCards, an_eddy_viscosity_in_two_dimensions_models_no_turbulence) {
  fluid::FluidScene scene;
  scene.parameters.dimension = 2;
  const auto model = [&](double eddy) {
    const fluid::FluidEvidence seen{.largest_peclet = 500, .eddy_viscosity = eddy};
    return model_error(audit(fluid::fluid_effect_cards(), scene, seen));
  };
  const ModelError without = model(fluid::FluidEvidence::unknown);
  EXPECT_NEAR(without.sum, 1 - std::sqrt(0.1), 1e-12);
  EXPECT_THAT(without.largest, HasSubstr("'dimension: 3'"));
  scene.parameters.turbulence.emplace();
  EXPECT_NEAR(model(3).sum, without.sum + 0.5, 1e-12);
  EXPECT_THAT(model(100).largest, HasSubstr("models no turbulence"));
  EXPECT_THAT(model(0.009).omittable, HasSubstr("eddy viscosity in two dimensions ("));
  EXPECT_THAT(model(0.011).omittable, IsEmpty());
}

// The scenes of the issue: SF6 at 48 m/s, a reed's channel, and a model fluid of which nothing can be said.
TEST(EffectCards, compressibility_is_judged_by_what_it_does) {
  const auto verdict = [](const char* effect, const fluid::FluidScene& scene, const fluid::FluidEvidence& e) {
    return verdict_on(effect, fluid::fluid_effect_cards(), scene, e);
  };
  fluid::FluidScene sf6, air, flap;
  sf6.parameters.density = 6.17;
  sf6.parameters.viscosity = 1.5e-5;
  const auto mach = verdict("compressibility", sf6, {.largest_speed = 48});
  ASSERT_TRUE(mach);
  EXPECT_NEAR(mach->number, 0.36, 0.01);
  EXPECT_FALSE(mach->sound());
  EXPECT_THAT(mach->sentence, ::testing::Not(HasSubstr("air")));
  EXPECT_TRUE(verdict("compressibility", sf6, {.largest_speed = 38})->sound());

  // 60 mm of channel, 20 cm^3, a stroke of 0.2 cm^3: 1.4 kPa on average compress as much as the reed moves.
  air.parameters.density = 1.184;
  air.parameters.viscosity = 1.85e-5;
  fluid::FluidEvidence reed{.pressure_range = 4000, .stroke = 2e-7, .wall_rate = 930, .size = 0.06};
  const double rho_c2 = 1.4 * 101325;
  reed.pressure_volume = 0.099 * reed.stroke * rho_c2;
  EXPECT_TRUE(verdict("waves of pressure", air, reed)->sound());
  reed.pressure_volume = 0.101 * reed.stroke * rho_c2;
  const auto compliance = verdict("waves of pressure", air, reed);
  EXPECT_FALSE(compliance->sound());
  EXPECT_THAT(compliance->sentence, HasSubstr("volume displaced by the walls = 0.1"));
  reed.pressure_volume = 0;
  reed.size = 0.29 * 346.1 / reed.wall_rate;
  EXPECT_TRUE(verdict("waves of pressure", air, reed)->sound());
  reed.size = 0.31 * 346.1 / reed.wall_rate;
  EXPECT_FALSE(verdict("waves of pressure", air, reed)->sound());

  flap.parameters.density = 1;
  flap.parameters.viscosity = 1;
  reed.largest_speed = 1e6;
  EXPECT_FALSE(verdict("waves of pressure", flap, reed));
  EXPECT_FALSE(verdict("compressibility", flap, reed));
  flap.parameters.compressibility.emplace().speed_of_sound = 100;
  EXPECT_TRUE(verdict("compressibility", flap, {.largest_speed = 29})->sound());
  EXPECT_FALSE(verdict("compressibility", flap, {.largest_speed = 31})->sound());
}

TEST(Sound, is_that_of_a_key_a_pressure_a_substance_or_none) {
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
  p.substance = "sf6";
  EXPECT_NEAR(speed(p, 1, 1), 135, 1);
  p.temperature = 373.15;
  EXPECT_NEAR(speed(p, 1, 1), 152.5, 1);
  p = {};
  p.substance = "water";
  EXPECT_NEAR(speed(p, 998, 1e-3), 1482, 2);
  EXPECT_EQ(fluid::misfit_of(p, 998), "");
  EXPECT_THAT(fluid::misfit_of(p, 1.2), ::testing::HasSubstr("water has 998 kg/m^3"));
  p.temperature = 333.15;
  EXPECT_NEAR(speed(p, 983, 5e-4), 1551, 1) << "60 degC";
  p = {};
  p.substance = "air";
  EXPECT_EQ(fluid::misfit_of(p, 1.2), "");
  EXPECT_THAT(fluid::misfit_of(p, 998), ::testing::HasSubstr("would be at 840 bar"));
  p = {};
  p.pressure = 5e5;  // air at 5 bar and 20 degC
  EXPECT_NEAR(speed(p, 5.94, 1.8e-5), std::sqrt(1.3 * 5e5 / 5.94), 20);
  p.heat_capacity_ratio = 1.4;
  EXPECT_NEAR(speed(p, 5.94, 1.8e-5), 343.3, 0.5);
  p = {};
  p.speed_of_sound = 77;
  EXPECT_EQ(speed(p, 1.2, 1.8e-5), 77);
}

TEST(ComplianceWatch, finds_the_fluctuations_of_a_harmonic_motion) {
  fluid::ComplianceWatch watch;
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

TEST(ComplianceWatch, knows_nothing_of_walls_at_rest_and_of_the_first_step) {
  fluid::ComplianceWatch watch;
  watch.add(0.1, {0, 0}, {.pressure_volume = 1e9});
  EXPECT_EQ(watch.totals().pressure_volume, 0) << "the impulse of the start";
  for (int n = 0; n < 5; ++n) watch.add(0.1, {0, 0}, {});
  EXPECT_EQ(watch.walls().square, 0);
}

TEST(EffectCards, coupling_verdicts_turn_at_their_thresholds) {
  CouplingParameters one_pass, iterated;
  one_pass.scheme = coupling::Scheme::explicit_;
  one_pass.fluid = iterated.fluid = {"fluid"};
  one_pass.structure = iterated.structure = {"solid"};
  iterated.scheme = coupling::Scheme::semi_implicit;
  const auto sound = [&](const char* effect, const CouplingEvidence& e) {
    const auto v = verdict_on(effect, coupling_effect_cards(), one_pass, e);
    EXPECT_TRUE(v.has_value()) << effect;
    return v && v->sound();
  };
  one_pass.predictor_order = 1;
  EXPECT_TRUE(sound("iteration of pressure and structure", {.returned = 0.49}));
  EXPECT_FALSE(sound("iteration of pressure and structure", {.returned = 0.51}));
  one_pass.predictor_order = 2;
  EXPECT_TRUE(sound("iteration of pressure and structure", {.returned = 0.16}));
  EXPECT_FALSE(sound("iteration of pressure and structure", {.returned = 0.17}));
  EXPECT_TRUE(sound("viscous coupling load", {.lost_load = 0.019}));
  EXPECT_FALSE(sound("viscous coupling load", {.lost_load = 0.021}));
  EXPECT_THAT(audit(coupling_effect_cards(), iterated, CouplingEvidence{.returned = 5}), IsEmpty());
  EXPECT_THAT(audit(coupling_effect_cards(), one_pass, CouplingEvidence{}), IsEmpty());
}

// `--effects` asks before a case is read: this dereferenced the fluid that is not there yet.
TEST(EffectCards, coupling_cards_answer_without_participants) {
  EXPECT_NO_THROW(effects_of("coupler", coupling_effect_cards(), CouplingParameters{}));
  EXPECT_THROW(schedule_of(CouplingParameters{}), std::bad_optional_access);
}

TEST(EffectCards, tank_verdicts_turn_at_their_thresholds) {
  thermocline::ElementParameters tank;
  tank.type = thermocline::ElementParameters::Type::tank;
  tank.tank.bed.shells = 1;
  const auto sound = [&](const char* effect, const thermocline::Evidence& e) {
    const auto v = verdict_on(effect, thermocline::effect_cards(), tank, e);
    EXPECT_TRUE(v.has_value()) << effect;
    return v && v->sound();
  };
  EXPECT_TRUE(sound("resolved grains", {.largest_biot = 19.9}));
  EXPECT_FALSE(sound("resolved grains", {.largest_biot = 20.1}));
  const thermocline::Evidence spread{.implicit_spread = 0.051, .implicit_step = 1};
  EXPECT_FALSE(verdict_on("implicit advection", thermocline::effect_cards(), tank, spread))
      << "where it is off";
  tank.tank.bed.advection = thermocline::Advection::implicit;
  EXPECT_TRUE(sound("implicit advection", {.implicit_spread = 0.049, .implicit_step = 1}));
  EXPECT_FALSE(sound("implicit advection", spread));
  EXPECT_TRUE(
      sound("specific heat of a gas by its temperature", {.capacity_error = 0.049, .mean_capacity = 1e3}));
  EXPECT_FALSE(
      sound("specific heat of a gas by its temperature", {.capacity_error = 0.051, .mean_capacity = 1e3}));
  EXPECT_TRUE(sound("mixing of inverted fluid", {.inversion = 9, .inverted_share = 0.049}));
  EXPECT_FALSE(sound("mixing of inverted fluid", {.inversion = 11, .inverted_share = 0.051}));
  EXPECT_TRUE(sound("pressure loss of the bed", {.pumping_share = 0.019, .pressure_loss = 1e4}));
  EXPECT_FALSE(sound("pressure loss of the bed", {.pumping_share = 0.021, .pressure_loss = 1e6}));
  EXPECT_TRUE(sound("compressible flow of a gas", {.largest_mach = 0.29}));
  EXPECT_FALSE(sound("compressible flow of a gas", {.largest_mach = 0.31}));
  EXPECT_TRUE(sound("yielding of the wall", {.share_of_yield = 0.99}));
  EXPECT_FALSE(sound("yielding of the wall", {.share_of_yield = 1.01}));
  EXPECT_TRUE(sound("bending of the wall", {.share_as_rings = 0.5, .share_with_bending = 0.599}));
  EXPECT_FALSE(sound("bending of the wall", {.share_as_rings = 0.5, .share_with_bending = 0.601}));
  tank.tank.pump.emplace();
  EXPECT_TRUE(sound("work of pump or fan", {.driving_power = 0.99e6, .carried_heat = 1e7}));
  EXPECT_FALSE(sound("work of pump or fan", {.driving_power = 4e7, .carried_heat = 2.8e7}));
  tank.tank.bed.shells = 5;
  EXPECT_FALSE(verdict_on("resolved grains", thermocline::effect_cards(), tank,
                          thermocline::Evidence{.largest_biot = 1e3}));
}

TEST(EffectCards, a_verdict_says_number_threshold_and_cure) {
  const EffectVerdict bad{"inertia", 0.3, 0.01, "inertia / load = 0.3", "use 'analysis: dynamic'"};
  EXPECT_EQ(text(bad),
            "inertia neglected: inertia / load = 0.3 (limit 0.01): not justified; use 'analysis: dynamic'");
  const EffectVerdict good{"inertia", 0.003, 0.01, "inertia / load = 0.003", ""};
  EXPECT_THAT(text(good), HasSubstr("): justified"));
  EXPECT_FALSE((EffectVerdict{"x", std::nan(""), 1, "", ""}.sound()));
}

TEST(AuditTrail, tells_again_what_turns_wrong) {
  AuditTrail trail;
  EffectVerdict v{.effect = "balance of the kinetic energy",
                  .number = 0.2,
                  .threshold = 0.1,
                  .sentence = "",
                  .recommendation = "",
                  .wrong_from = 0.5};
  EXPECT_EQ(v.id(), "balance-of-the-kinetic-energy");
  EXPECT_EQ(v.severity(), base::Severity::warning);
  EXPECT_EQ(trail.news({v}).size(), 1u);
  v.number = 0.4;
  EXPECT_THAT(trail.news({v}), IsEmpty());
  v.number = 0.6;
  EXPECT_EQ(v.severity(), base::Severity::wrong);
  EXPECT_EQ(trail.news({v}).size(), 1u);
  EXPECT_THAT(trail.news({v}), IsEmpty());
  EXPECT_EQ(trail.unsound().size(), 1u);
  v.number = std::nan("");
  EXPECT_EQ(v.severity(), base::Severity::wrong);
}

// The start of a flow compresses much while walls have hardly moved: 0.42 at 0.03 s of a flapping plate, 3e-4 at its end.
TEST(AuditTrail, a_mean_over_the_run_counts_at_its_end) {
  AuditTrail trail;
  EffectVerdict v{"waves of pressure", 0.42, 0.1, "compressed / displaced = 0.42"};
  v.cumulative = true;
  EXPECT_THAT(trail.news({v}), IsEmpty());
  v.number = 3e-4;
  EXPECT_THAT(trail.news({v}, true), IsEmpty());
  ASSERT_EQ(trail.worst().size(), 1u);
  EXPECT_EQ(trail.worst()[0].number, 3e-4);
  EXPECT_TRUE(trail.all_sound());
  v.number = 0.42;
  EXPECT_EQ(trail.news({v}, true).size(), 1u);
  EXPECT_FALSE(trail.all_sound());
}

TEST(AuditTrail, a_mean_does_not_hide_what_an_instant_has_shown) {
  AuditTrail trail;
  const EffectVerdict instant{"waves of pressure", 0.6, 0.05, "density changes by 0.6"};
  EffectVerdict mean{"waves of pressure", 0.3, 0.1, "compressed / displaced = 0.3"};
  mean.cumulative = true;
  EXPECT_EQ(trail.news({instant}).size(), 1u);
  trail.news({mean});
  mean.number = 1e-4;
  trail.news({mean}, true);
  ASSERT_EQ(trail.worst().size(), 1u);
  EXPECT_EQ(trail.worst()[0].number, 0.6);
  mean.number = 2;  // 20 times its limit, the instant 12 times
  trail.news({mean}, true);
  EXPECT_EQ(trail.worst()[0].number, 2);
}

TEST(AuditTrail, tells_bad_news_once) {
  AuditTrail trail;
  EffectVerdict v{"inertia", 0.003, 0.01, "", ""};
  EXPECT_THAT(trail.news({v}), IsEmpty());
  EXPECT_TRUE(trail.all_sound());
  v.number = 0.02;
  EXPECT_EQ(trail.news({v}).size(), 1u);
  EXPECT_THAT(trail.news({v}), IsEmpty());
  EXPECT_THAT(trail.unsound(), ElementsAre("inertia"));
  v.number = 0.001;  // what was bad in the midst of a run is still known at its end
  EXPECT_THAT(trail.news({v}), IsEmpty());
  ASSERT_EQ(trail.worst().size(), 1u);
  EXPECT_EQ(trail.worst().front().number, 0.02);
}

}  // namespace
}  // namespace couplet::testing::cards_test
