// SPDX-License-Identifier: Apache-2.0
// A fluid with vertices alone and names of its own, as a program on preCICE's interface.
#include "tests/unit/coupler/foreign.hpp"

namespace couplet::foreign_fluid_test {
using namespace coupling;
namespace {

using Place = Interface::Place;

/// Pushes (1, 2) N at each of its 7 vertices, whatever the motion, which it remembers.
class Gust final : public Quiet {
 public:
  Interface initialise() override {
    Interface line{2, {}, {}, {}, {{"Way", "1", Place::vertices}}, {{"Push", unit, Place::vertices}}};
    lay_out(line, 7);
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
    lay_out(line, 11, true, -1);
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

struct Blown : ForeignCase {
  Gust gust;
  Sheet sheet;

  Blown() {
    coupling.fluid.emplace();
    coupling.fluid->displacement = "Way", coupling.fluid->load = "Push";
    simulation.end_time = 0.5;
    simulation.time_step = 0.1;
  }
  std::string operator()() {
    try {
      return coupler(gust, sheet)->run();
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
  EXPECT_EQ(
      run(),
      "coupling.fluid.displacement: 'fluid' takes no vector 'Weg' [m, or without a unit]. It takes: 'Way' [1] at vertices.");
  run.coupling.fluid->displacement = "Way", run.gust.unit = "Pa";
  EXPECT_EQ(run(),
            "coupling.fluid.load: 'fluid' gives no force 'Push' [N]. It gives: 'Push' [Pa] at vertices.");
}

}  // namespace
}  // namespace couplet::foreign_fluid_test
