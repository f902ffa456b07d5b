// SPDX-License-Identifier: Apache-2.0
// Tests what the coupler's diagnostics find in participants that give the same in every step.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/surfaces.hpp"

namespace couplet::diagnostics_test {
using namespace coupling;
namespace {

namespace fs = std::filesystem;
using Place = Interface::Place;
using testing::HasSubstr;

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
    coupler::CouplerChannels channels{std::make_unique<LocalChannel>("fluid", fluid),
                                      std::make_unique<LocalChannel>("solid", solid), nullptr};
    spdlog::set_level(spdlog::level::off);
    const std::size_t before = diagnostics::findings().size();
    coupler::Coupler coupler(coupling, simulation, std::move(channels), {folder, folder / "checkpoints", {}});
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
  EXPECT_DOUBLE_EQ(lost[0].number, 0.1);
  EXPECT_DOUBLE_EQ(lost[0].share, 0.1 / 1.1);
  EXPECT_TRUE((Scene{.viscous = 0.03, .steps = 1}.findings("viscous-coupling-load").empty()));
}

TEST(StructureAtRest, ten_steps_of_load_without_motion_are_flagged_once) {
  const auto found = Scene{}.findings("structure-at-rest");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].sentence, HasSubstr("'solid': 0 m at every interface vertex for 10 steps under a load "
                                           "of up to 3 N per face"));
  const auto flagged = [](Scene scene) { return scene.findings("structure-at-rest").size(); };
  EXPECT_EQ(flagged({.pressure = 0}), 0u) << "nothing pushes";
  EXPECT_EQ(flagged({.late = 1e-15, .from = 9}), 0u) << "it moves in the tenth step, by however little";
  EXPECT_EQ(flagged({.late = 1e-15, .from = 10}), 1u);
}

TEST(DisplacementScale, a_displacement_in_another_unit_is_flagged_once) {
  const auto found = Scene{.late = 1e3, .from = 5}.findings("displacement-scale");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_GT(found[0].number, 30);
  EXPECT_THAT(found[0].sentence, HasSubstr("displacement of 'solid'"));
  EXPECT_TRUE((Scene{.late = 1, .from = 5}.findings("displacement-scale").empty()));
}

}  // namespace
}  // namespace couplet::diagnostics_test
