// SPDX-License-Identifier: Apache-2.0
// What `effects: auto` chooses, scene by scene, beside what somebody who knows the field would.
#include "fluid_solver/parameters/parameters.hpp"
#include "solid_solver/choices.hpp"
#include "tests/support/test.hpp"

namespace couplet::testing::automatic_effects_test {
using namespace mesh;

using namespace solid;

using config::ExpressionText;
using ::testing::HasSubstr;

MeshFacts box(int dim, const Vec3& size, double cell) {
  MeshFacts mesh;
  mesh.dim = dim;
  mesh.size = size;
  mesh.shortest_edge = mesh.mean_cell = cell;
  mesh.cells = 1000;
  return mesh;
}

/// What was chosen for a key ("" for what is only told), and why.
template <class Choices>
std::string chosen(const Choices& choices, const std::string& key) {
  for (const diagnostics::EffectChoice& c : choices)
    if (c.key == key) {
      EXPECT_FALSE(c.reason.empty()) << key;
      EXPECT_EQ(c.reason.find('\n'), std::string::npos) << key;
      return c.what;
    }
  return "no choice";
}

// -- fluids ---------------------------------------------------------------------------------------------------
fluid::FluidParameters flow(double speed, double viscosity) {
  fluid::FluidParameters p;
  p.density = 1;
  p.viscosity = viscosity;
  p.boundaries["inlet"].type = fluid::BoundaryType::inlet;
  p.boundaries["inlet"].velocity = {{std::to_string(speed)}, {"0"}};
  return p;
}

std::string fluid_choice(const fluid::FluidParameters& p, const MeshFacts& mesh, const std::string& key,
                         const diagnostics::CaseScene& scene = {.end_time = 1, .time_step = 0.1}) {
  return chosen(fluid::choose_effects(p, mesh, scene), key);
}

const Vec3 flat(1, 1, 0), room(6, 4, 2);

TEST(AutoFluid, scene_1_cavity_in_the_plane_is_two_dimensional_and_without_a_model) {
  EXPECT_EQ(fluid_choice(flow(1, 1e-6), box(2, flat, 0.01), "dimension"), "2");
  EXPECT_EQ(fluid_choice(flow(1, 1e-6), box(2, flat, 0.01), "turbulence"), "none, laminar");
}
TEST(AutoFluid, scene_2_air_through_a_room_on_a_coarse_mesh_is_an_eddy_simulation) {
  EXPECT_EQ(fluid_choice(flow(1, 1.5e-5), box(3, room, 0.05), "turbulence"), "wale");
  EXPECT_EQ(fluid_choice(flow(1, 1.5e-5), box(3, room, 0.05), "dimension"), "3");
}
TEST(AutoFluid, scene_3_the_same_with_a_mesh_that_resolves_it_needs_no_model) {
  EXPECT_EQ(fluid_choice(flow(1, 1.5e-5), box(3, room, 1e-4), "turbulence"), "none, laminar");
}
TEST(AutoFluid, scene_4_oil_through_the_room_is_laminar) {
  EXPECT_EQ(fluid_choice(flow(1, 1e-3), box(3, room, 0.05), "turbulence"), "none, laminar");
  EXPECT_EQ(fluid_choice(flow(1, 8e-4), box(3, room, 0.05), "turbulence"), "wale");  // Re 2500: the neighbour
}
TEST(AutoFluid, scene_5_honey_on_small_cells_is_implicit) {
  EXPECT_EQ(fluid_choice(flow(0.01, 10), box(2, flat, 0.01), "viscous"), "implicit");
}
TEST(AutoFluid, scene_6_fast_air_is_explicit) {
  EXPECT_EQ(fluid_choice(flow(10, 1.5e-5), box(2, flat, 0.01), "viscous"), "explicit");
}
TEST(AutoFluid, pressure_waves_by_their_time_and_by_parts_that_are_shut) {
  auto air = flow(1, 1.8e-5);
  air.density = 1.2;
  EXPECT_EQ(fluid_choice(air, box(2, flat, 0.01), "compressibility"), "none, incompressible");
  air.boundaries["inlet"].velocity[0] = {"1 + 0.1*sin(2*pi*100*t)"};
  const diagnostics::CaseScene fine{.end_time = 1, .time_step = 5e-4};
  EXPECT_EQ(fluid_choice(air, box(2, flat, 0.01), "compressibility", fine), "three-level");
  EXPECT_EQ(fluid_choice(air, box(2, 0.1 * flat, 0.01), "compressibility", fine), "none, incompressible");
  auto valve = flow(1, 1.8e-5);
  valve.density = 1.2;
  valve.gaps["seat"] = {.between = {"lid", "floor"}, .opening = 0.01, .height = {}, .direction = {}};
  EXPECT_EQ(fluid_choice(valve, box(2, flat, 0.01), "compressibility"), "three-level");
  EXPECT_EQ(fluid_choice(flow(1, 1), box(2, flat, 0.01), "compressibility"), "none, incompressible");
  auto cavity = air;
  cavity.boundaries.clear();
  cavity.boundaries["lid"].type = fluid::BoundaryType::interface;
  EXPECT_EQ(fluid_choice(cavity, box(2, flat, 0.01), "compressibility",
                         {.end_time = 1, .time_step = 0.1, .coupled = true}),
            "three-level");
}
TEST(AutoFluid, scene_7_a_flap_with_a_mover_has_a_moving_mesh) {
  auto p = flow(10, 1);
  p.boundaries["flap"].type = fluid::BoundaryType::interface;
  EXPECT_EQ(fluid_choice(p, box(2, flat, 0.01), "", {.end_time = 1, .coupled = true, .has_mover = true}),
            "moving mesh");
}
TEST(AutoFluid, scene_8_without_a_mover_the_mesh_rests_and_the_run_watches_the_interface) {
  auto p = flow(10, 1);
  p.boundaries["flap"].type = fluid::BoundaryType::interface;
  const auto choices = fluid::choose_effects(p, box(2, flat, 0.01), {.end_time = 1, .coupled = true});
  EXPECT_EQ(chosen(choices, ""), "mesh at rest");
  EXPECT_THAT(choices.back().reason, HasSubstr("a tenth of a cell"));
}
TEST(AutoFluid, a_speed_that_grows_in_time_counts_at_its_largest) {
  auto p = flow(0, 1.5e-5);
  p.boundaries["inlet"].velocity = {{"t"}, {"0"}, {"0"}};
  for (const auto& [end, model] : {std::pair(1., "wale"), std::pair(0.01, "none, laminar")})
    EXPECT_EQ(fluid_choice(p, box(3, room, 0.05), "turbulence", {.end_time = end, .time_step = 1e-3}), model);
}

// -- solids ---------------------------------------------------------------------------------------------------
/// A steel bar of 1 m x 0.1 m under a traction: lowest period 12 ms.
SolidParameters bar(const std::string& traction) {
  SolidParameters p;
  p.material = {.density = 7850, .youngs_modulus = 2e11, .poissons_ratio = 0.3};
  p.boundaries["root"].type = SolidCondition::Type::fixed_displacement;
  p.boundaries["root"].value = {{"0"}, {"0"}, {"0"}};
  p.boundaries["tip"].type = SolidCondition::Type::traction;
  p.boundaries["tip"].value = {{"0"}, {traction}, {"0"}};
  return p;
}

std::string solid_choice(const SolidParameters& p, const std::string& key,
                         const diagnostics::CaseScene& scene = {.end_time = 10, .time_step = 0.1}) {
  return chosen(choose_effects(p, box(3, Vec3(1, 0.1, 0.1), 0.02), scene), key);
}

TEST(AutoSolid, scene_9_a_bracket_under_a_constant_load_is_static) {
  EXPECT_EQ(solid_choice(bar("1e6"), "analysis"), "static");
  EXPECT_EQ(solid_choice(bar("1e6*x"), "analysis"), "static");
}
TEST(AutoSolid, scene_10_a_press_that_takes_ten_seconds_is_static) {
  EXPECT_EQ(solid_choice(bar("1e6*t"), "analysis"), "static");
}
// A beam that is held at one end: 2 pi l^2 / 3.516 sqrt(12 rho / (E h^2)).
TEST(AutoSolid, the_lowest_period_is_that_of_a_beam_held_at_one_end) {
  const auto choices =
      choose_effects(bar("1e6*t"), box(3, Vec3(1, 0.1, 0.1), 0.02), {.end_time = 10, .time_step = 0.1});
  EXPECT_THAT(choices.back().reason, HasSubstr("the longest natural period is about 0.0123 s"));
}
TEST(AutoSolid, scene_11_a_blow_of_a_few_milliseconds_is_dynamic) {
  EXPECT_EQ(solid_choice(bar("1e6*exp(-(t-0.005)^2/1e-6)"), "analysis", {.end_time = 0.01}), "dynamic");
  EXPECT_EQ(solid_choice(bar("1e6*sin(500*t)"), "analysis", {.end_time = 0.1}), "dynamic");
}
TEST(AutoSolid, scene_12_a_body_that_starts_with_a_speed_is_dynamic) {
  auto p = bar("0");
  p.initial_velocity = {{"0"}, {"x"}, {"0"}};
  EXPECT_EQ(solid_choice(p, "analysis"), "dynamic");
}
TEST(AutoSolid, scene_13_in_a_fluid_it_is_dynamic) {
  auto p = bar("0");
  p.boundaries["tip"].type = SolidCondition::Type::interface_;
  EXPECT_EQ(solid_choice(p, "analysis", {.end_time = 10, .coupled = true}), "dynamic");
}
TEST(AutoSolid, scene_14_beside_a_tank_that_gives_temperatures_it_is_static) {
  auto p = bar("0");
  p.boundaries["tip"].type = SolidCondition::Type::interface_;
  p.interface_data.emplace();
  p.interface_data->temperature = true;
  EXPECT_EQ(solid_choice(p, "analysis", {.end_time = 1e5, .coupled = true}), "static");
}
TEST(AutoSolid, scene_15_damping_asks_for_motion_and_a_plane_mesh_for_two_dimensions) {
  auto p = bar("1e6");
  p.damping.emplace();
  EXPECT_EQ(solid_choice(p, "analysis"), "dynamic");
  EXPECT_EQ(chosen(choose_effects(p, box(2, flat, 0.1), {.end_time = 1}), "dimension"), "2");
}

// -- meshes ---------------------------------------------------------------------------------------------------
TEST(MeshFacts, are_those_of_a_box) {
  const RawMesh raw = make_box(BoxCells::hexahedra, {4, 2, 1}, Vec3::Zero(), Vec3(2, 1, 1));
  const MeshFacts facts = facts_of(raw);
  EXPECT_EQ(facts.dim, 3);
  EXPECT_EQ(facts.cells, 8u);
  EXPECT_NEAR((facts.size - Vec3(2, 1, 1)).norm(), 0, 1e-14);
  EXPECT_DOUBLE_EQ(facts.shortest_edge, 0.5);
  EXPECT_NEAR(facts.mean_cell, std::cbrt(0.25), 1e-14);
  EXPECT_DOUBLE_EQ(facts.smallest_side(), 1);
  const RawMesh flat = make_box(BoxCells::triangles, {4, 2, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  EXPECT_EQ(facts_of(flat).dim, 2);
}

}  // namespace couplet::testing::automatic_effects_test
