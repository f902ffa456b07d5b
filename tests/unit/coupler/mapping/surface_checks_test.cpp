// SPDX-License-Identifier: Apache-2.0
// Tests what is judged before the first step: roles and sizes of surfaces.
#include "coupler/mapping/surface_checks.hpp"
#include "common/coupling/roles.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/coupling/support/surfaces.hpp"

namespace couplet::start_checks_test {
using namespace coupling;
using namespace coupler;
using Place = Interface::Place;
using Data = std::vector<Interface::Datum>;
using testing::HasSubstr;
namespace fs = std::filesystem;

const Data motion{{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}};
const Data loads{{"pressure-force", "N", Place::faces}};

TEST(RoleContracts, each_of_the_projects_programs_plays_its_roles_and_no_other) {
  const std::map<std::string, std::vector<std::string>> plays{{"fluid_solver", {"fluid"}},
                                                              {"solid_solver", {"structure"}},
                                                              {"plate_modal", {"structure"}},
                                                              {"mesh_mover", {"mesh"}},
                                                              {"thermocline", {}}};
  ASSERT_EQ(players().size(), plays.size());
  for (const Player& player : players()) {
    std::vector<std::string> can;
    for (const RoleContract& contract : role_contracts())
      if (problem_of_role(contract, player, true).empty()) can.push_back(contract.role);
    EXPECT_EQ(can, plays.at(player.program)) << player.program;
  }
}

TEST(RoleContracts, unit_place_and_components_count) {
  const RoleContract& fluid = contract_of("fluid");
  EXPECT_EQ(problem_of_role(fluid, motion, loads), "");
  Data takes = motion, gives = loads;
  takes[0].unit = "mm";
  EXPECT_THAT(problem_of_role(fluid, takes, gives), HasSubstr("it takes no 'displacement' [m] at vertices"));
  takes = motion, takes[0].place = Place::faces;
  EXPECT_NE(problem_of_role(fluid, takes, gives), "");
  gives[0].components = 1;  // a vector is asked for
  EXPECT_THAT(problem_of_role(fluid, motion, gives), HasSubstr("it gives no load [N] at faces"));
  EXPECT_NE(problem_of_role(contract_of("mesh"), motion, loads), "");
  EXPECT_EQ(problem_of_role(contract_of("structure"), {{"pressure", "Pa", Place::faces, 1}}, motion), "");
}

Interface scaled(Interface s, double factor) {
  for (Vec3& x : s.vertices) x *= factor;
  for (Vec3& x : s.face_centres) x *= factor;
  for (Vec3& a : s.face_areas) a *= s.dim == 2 ? factor : factor * factor;
  return s;
}

Side side(const std::string& name, Interface i, const Data& takes, const Data& gives) {
  i.takes = takes, i.gives = gives;
  return {MPI_COMM_SELF, name, std::move(i)};
}

/// The finding of compare_surfaces() for two meshes of a surface; empty: none.
std::string difference(const Interface& a, const Interface& b) {
  const Side one = side("solid", a, loads, motion), other = side("fluid", b, motion, loads);
  const SurfaceFacts first = surface_facts(MPI_COMM_SELF, {&one}),
                     second = surface_facts(MPI_COMM_SELF, {&other});
  return difference_of(first, second, faceting(first, second));
}

TEST(Surfaces, meshes_of_one_surface_may_differ) {
  EXPECT_EQ(difference(tests::flap(40, 4, 1), tests::flap(20, 2, -1)), "");
  EXPECT_EQ(difference(tests::flap(40, 4, 1, 0.3), tests::flap(13, 1, -1)), "");
  EXPECT_EQ(difference(tests::plate(8, true, 1), tests::plate(3, false, -1)), "");
  for (const auto& [n, m] :
       std::vector<std::pair<int, int>>{{8, 200}, {12, 31}, {16, 24}, {64, 48}, {100, 200}})
    EXPECT_EQ(difference(tests::ring(n), tests::ring(m)), "") << n << " and " << m << " chords";
}

TEST(Surfaces, a_surface_five_per_cent_larger_or_elsewhere_is_named_with_the_number) {
  EXPECT_THAT(difference(scaled(tests::flap(40, 4, 1), 1.05), tests::flap(20, 2, -1)),
              testing::AllOf(HasSubstr("area 2.205 m^2 ('solid') and 2.1 m^2 ('fluid')"),
                             HasSubstr("which differ by 4.8 % (limit 1.")));
  EXPECT_NE(difference(scaled(tests::ring(32), 1.05), tests::ring(40)), "");
  EXPECT_NE(difference(scaled(tests::plate(8, true, 1), 0.95), tests::plate(8, false, -1)), "");
  Interface moved = tests::flap(20, 2, -1);
  for (Vec3& x : moved.vertices) x.x() += 0.05;
  for (Vec3& x : moved.face_centres) x.x() += 0.05;
  EXPECT_THAT(difference(tests::flap(40, 4, 1), moved), HasSubstr("centroid"));
}

/// A strip of 0.06 by 0.01 m: `n` faces along it, `rows` across.
Interface strip(int n, int rows, double length = 0.06) {
  Interface s;
  s.dim = 3;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= n; ++i) s.vertices.push_back({length * i / n, 0.01 * j / rows - 0.005, 0});
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < n; ++i) {
      s.face_centres.push_back({length * (i + 0.5) / n, 0.01 * (j + 0.5) / rows - 0.005, 0});
      s.face_areas.push_back({0, 0, length * 0.01 / (n * rows)});
    }
  return s;
}

TEST(Surfaces, one_row_of_faces_covers_the_same_strip_as_two) {
  EXPECT_EQ(difference(strip(24, 2), strip(30, 1)), "");
  EXPECT_EQ(difference(strip(24, 2), strip(60, 8)), "");
  EXPECT_NE(difference(strip(24, 2), strip(30, 1, 0.055)), "");
}

TEST(Surfaces, doubts_are_counted_and_a_mover_that_holds_a_wall_is_refused) {
  Schedule schedule;
  schedule.mover = "mover", schedule.moved = "fluid";
  MappingParameters nearest;
  nearest.type = MappingParameters::Type::nearest;
  const auto doubts = [&](const Interface& solid, const Interface& mover) {
    const std::vector<Side> sides{side("mover", mover, {motion[0]}, {}),
                                  side("fluid", tests::flap(20, 2, -1), motion, loads),
                                  side("solid", solid, loads, motion)};
    const int before = diagnostics::doubts();
    compare_surfaces(MPI_COMM_SELF, sides, Links(MPI_COMM_SELF, sides, nearest), schedule);
    return diagnostics::doubts() - before;
  };
  const Interface all = tests::flap(20, 2, -1);
  EXPECT_EQ(doubts(tests::flap(40, 4, 1), all), 0);
  EXPECT_EQ(doubts(scaled(tests::flap(40, 4, 1), 1.05), all), 1);
  Interface half = all;  // one side and the tip
  half.face_centres.resize(22), half.face_areas.resize(22), half.face_offset.resize(23),
      half.face_vertices.resize(44);
  half.vertices.resize(23);
  try {
    doubts(tests::flap(40, 4, 1), half);
    ADD_FAILURE() << "a mover with half of the walls is let pass";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("'mover' moves 22 of the 42 faces of the interface of 'fluid' (1.1 of 2.1 m^2)"));
  }
}

TEST(Surfaces, who_follows_the_motion_and_gives_no_load_may_cover_a_part) {
  MappingParameters nearest;
  nearest.type = MappingParameters::Type::nearest;
  Interface one_side = tests::flap(20, 2, -1);
  one_side.face_centres.resize(20), one_side.face_areas.resize(20), one_side.face_offset.resize(21),
      one_side.face_vertices.resize(40);
  one_side.vertices.resize(21);
  const auto doubts = [&](const Data& gives) {
    const std::vector<Side> sides{side("fluid", tests::flap(20, 2, -1), motion, loads),
                                  side("solid", tests::flap(40, 4, 1), loads, motion),
                                  side("heater", one_side, {motion[0]}, gives)};
    const int before = diagnostics::doubts();
    compare_surfaces(MPI_COMM_SELF, sides, Links(MPI_COMM_SELF, sides, nearest), Schedule());
    return diagnostics::doubts() - before;
  };
  EXPECT_EQ(doubts({{"temperature", "K", Place::faces, 1}}), 0);
  EXPECT_EQ(doubts({{"magnetic-force", "N", Place::faces}}), 1);
}

// Tests what the coupler's diagnostics find in participants that give the same in every step.

/// Gives the same in every step, whatever it takes; its displacement is `late` from step `from` on.
struct Constant final : Participant {
  Interface interface;
  Exchange gives;
  double late = 0;
  int from = 1000, step = 0;
  Interface initialise() override { return interface; }
  void begin_step(const Step& s) override { step = int(s.number); }
  Exchange solve(const Exchange&) override {
    Exchange out = gives;
    if (step >= from && out.contains("displacement")) std::ranges::fill(out.at("displacement"), late);
    return out;
  }
  StepReport accept_step() override { return {}; }
  void save(io::CheckpointWriter&) const override {}
  void load(io::CheckpointReader&) override {}
  void write_output(double, int) override {}
  void write_monitors(double) override {}
};

/// Forces per face, and when and how far the structure moves.
struct Scene {
  double pressure = 3, viscous = 0, late = 0;
  int from = 1000, steps = 25;

  /// Findings of this id.
  std::vector<diagnostics::Finding> findings(const std::string& id) const {
    const fs::path folder = fs::temp_directory_path() / ("couplet-diagnostics-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    const std::vector<Interface::Datum> motion{{"displacement", "m", Place::vertices},
                                               {"velocity", "m/s", Place::vertices}},
        loads{{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}};
    Constant fluid, solid;
    fluid.interface = tests::flap(2, 1, -1), solid.interface = tests::flap(2, 1, 1);
    fluid.interface.takes = solid.interface.gives = motion;
    fluid.interface.gives = loads;
    solid.interface.takes = {loads.front()};
    const std::size_t faces = fluid.interface.face_centres.size(), vertices = solid.interface.vertices.size();
    fluid.gives = {{"pressure-force", std::vector<double>(2 * faces, pressure)},
                   {"viscous-force", std::vector<double>(2 * faces, viscous)}};
    solid.gives = {{"displacement", std::vector<double>(2 * vertices, 0.)},
                   {"velocity", std::vector<double>(2 * vertices, 0.)}};
    solid.late = late, solid.from = from;
    coupler::CouplingParameters coupling;
    coupling.scheme = Scheme::explicit_;
    app::SimulationParameters simulation;
    simulation.time_step = 1, simulation.end_time = steps;
    spdlog::set_level(spdlog::level::off);
    const std::size_t before = diagnostics::findings().size();
    tests::LocalCoupler coupler(coupling, simulation, fluid, solid, nullptr,
                                {folder, folder / "checkpoints", {}});
    EXPECT_EQ(coupler.run(), "");
    fs::remove_all(folder);
    std::vector<diagnostics::Finding> found;
    for (std::size_t i = before; i < diagnostics::findings().size(); ++i)
      if (diagnostics::findings()[i].id == id) found.push_back(diagnostics::findings()[i]);
    return found;
  }
};

TEST(LostLoad, forces_that_nobody_takes_are_compared_with_those_taken) {
  const auto lost = Scene{.viscous = 0.3, .steps = 1}.findings("viscous-coupling-load");
  ASSERT_EQ(lost.size(), 1u);
  EXPECT_DOUBLE_EQ(lost[0].number, 0.1 / 1.1);
  EXPECT_DOUBLE_EQ(lost[0].share, 0.1 / 1.1);
  EXPECT_TRUE((Scene{.viscous = 0.03, .steps = 1}.findings("viscous-coupling-load").empty()));
}

TEST(StructureAtRest, ten_steps_of_load_without_motion_are_flagged_once) {
  const auto found = Scene{}.findings("structure-at-rest");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].sentence, HasSubstr("'solid': 0 m at every interface vertex for 25 steps under a load "
                                           "of up to 3 N per face"));
  const auto flagged = [](Scene scene) { return scene.findings("structure-at-rest").size(); };
  EXPECT_EQ(flagged({.pressure = 0}), 0u) << "nothing pushes";
  EXPECT_EQ(flagged({.late = 1e-15, .from = 9}), 0u) << "it moves in the tenth step, by however little";
  EXPECT_EQ(flagged({.late = 1e-15, .from = 10}), 1u);
}

TEST(DisplacementScale, a_displacement_in_another_unit_is_flagged_once) {
  const auto found = [](double late) {
    auto all = Scene{.late = late, .from = 5}.findings("questionable-displacement");
    std::erase_if(all, [](const auto& one) { return one.sentence.find("velocity of") != std::string::npos; });
    return all;
  };
  ASSERT_EQ(found(1e3).size(), 1u);
  EXPECT_GT(found(1e3)[0].number, 30);
  EXPECT_THAT(found(1e3)[0].sentence, HasSubstr("displacement of 'solid'"));
  EXPECT_TRUE(found(1).empty());
}

}  // namespace couplet::start_checks_test
