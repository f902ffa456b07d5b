// SPDX-License-Identifier: Apache-2.0
// A fluid with vertices alone and names of its own, as a program on preCICE's interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"

namespace couplet {
namespace {

namespace fs = std::filesystem;
using Place = Interface::Place;

class Quiet : public Participant {
 public:
  void begin_step(const Step& step) override { step_ = step; }
  StepReport accept_step() override { return {.dt = step_.dt}; }
  void save(CheckpointWriter&) const override {}
  void load(CheckpointReader&) override {}
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 protected:
  Step step_;
};

/// Pushes (1, 2) N at each of its 7 vertices, whatever the motion, which it remembers.
class Gust final : public Quiet {
 public:
  Interface initialise() override {
    Interface line{2, {}, {}, {}, {{"Way", "1", Place::vertices}}, {{"Push", unit, Place::vertices}}};
    for (int i = 0; i < 7; ++i) line.vertices.emplace_back(i / 6., 0, 0);
    return line;
  }
  Exchange solve(const Exchange& in) override {
    EXPECT_FALSE(in.contains("displacement"));
    if (in.contains("Way")) way = in.at("Way");
    std::vector<double> push;
    for (int i = 0; i < 7; ++i) push.insert(push.end(), {1, 2});
    return {{"Push", push}};
  }
  std::vector<double> way;
  std::string unit = "N";
};

/// Moves by x + t, and remembers its loads.
class Sheet final : public Quiet {
 public:
  Interface initialise() override {
    Interface line{2,
                   {},
                   {},
                   {},
                   {{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}},
                   {{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}}};
    line.face_offset = {0};
    for (int i = 0; i < 11; ++i) line.vertices.emplace_back(i / 10., 0, 0);
    for (int i = 0; i < 10; ++i) {
      line.face_centres.emplace_back((i + 0.5) / 10, 0, 0);
      line.face_areas.emplace_back(0, -0.1, 0);
      line.face_vertices.insert(line.face_vertices.end(), {Index(i), Index(i + 1)});
      line.face_offset.push_back(2 * (i + 1));
    }
    return line;
  }
  Exchange solve(const Exchange& in) override {
    if (in.contains("pressure-force")) pressure = in.at("pressure-force"), viscous = in.at("viscous-force");
    std::vector<double> x, v;
    for (int i = 0; i < 11; ++i)
      x.insert(x.end(), {0, i / 10. + step_.time + step_.dt}), v.insert(v.end(), {0, 1});
    return {{"displacement", x}, {"velocity", v}};
  }
  std::vector<double> pressure, viscous;
};

struct Blown {
  CouplingParameters coupling;
  SimulationParameters simulation;
  Gust gust;
  Sheet sheet;
  fs::path folder = fs::temp_directory_path() / ("couplet-blown-" + std::to_string(::getpid()));

  Blown() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = Scheme::implicit;
    coupling.mapping.type = MappingParameters::Type::rbf;
    coupling.fluid.emplace();
    coupling.fluid->displacement = "Way", coupling.fluid->load = "Push";
    simulation.end_time = 0.5;
    simulation.time_step = 0.1;
  }
  ~Blown() { fs::remove_all(folder); }
  std::string operator()() {
    fs::create_directories(folder);
    try {
      Coupler coupler(coupling, simulation,
                      {std::make_unique<LocalChannel>("fluid", gust),
                       std::make_unique<LocalChannel>("solid", sheet), nullptr},
                      {folder, folder / "checkpoints", ""});
      return coupler.run();
    } catch (const Error& e) {
      return e.what();
    }
  }
};

TEST(ForeignFluid, its_force_goes_to_the_structure_and_the_motion_comes_back_by_its_names) {
  Blown run;
  EXPECT_EQ(run(), "");
  ASSERT_EQ(run.sheet.pressure.size(), 20u);
  double along = 0, across = 0, moment = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    along += run.sheet.pressure[2 * i], across += run.sheet.pressure[2 * i + 1];
    moment += (double(i) + 0.5) / 10 * run.sheet.pressure[2 * i + 1];
  }
  EXPECT_NEAR(along, 7, 1e-12);
  EXPECT_NEAR(across, 14, 1e-12);
  EXPECT_NEAR(moment, 7, 1e-12);  // 2 N at i / 6 m each
  EXPECT_EQ(run.sheet.viscous, std::vector<double>(20));
  ASSERT_EQ(run.gust.way.size(), 14u);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(run.gust.way[2 * i + 1], double(i) / 6 + 0.5, 1e-12);
}

TEST(ForeignFluid, data_that_it_does_not_announce_are_named) {
  Blown run;
  run.coupling.fluid->displacement = "Weg";
  EXPECT_EQ(run(),
            "coupling.fluid.displacement: 'fluid' takes no vector 'Weg' [m or 1]. It takes: 'Way' [1].");
  run.coupling.fluid->displacement = "Way", run.gust.unit = "Pa";
  EXPECT_EQ(run(), "coupling.fluid.load: 'fluid' gives no vector 'Push' [N]. It gives: 'Push' [Pa].");
}

}  // namespace
}  // namespace couplet
