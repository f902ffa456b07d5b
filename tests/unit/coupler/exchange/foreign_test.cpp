// SPDX-License-Identifier: Apache-2.0
// A structure with vertices alone, names of its own and no velocity, as a program on preCICE's interface.
#include "tests/unit/coupler/foreign.hpp"
#include "common/app/loop/step_loop.hpp"
#include "coupler/output/record.hpp"

namespace couplet::foreign_structure_test {
using namespace coupling;

using Place = Interface::Place;

/// Moves by 3 t^2 whatever its load, which it remembers.
class Shaker final : public Quiet {
 public:
  Interface initialise() override {
    Interface line{2, {}, {}, {}, {{"Push", "N", Place::vertices}}, {{"Way", unit, Place::vertices}}};
    if (gives_velocity) line.gives.push_back({"velocity", "m/s", Place::vertices});
    lay_out(line, 12);
    return line;
  }
  Exchange solve(const Exchange& in) override {
    if (in.contains("Push")) load = in.at("Push");
    EXPECT_FALSE(in.contains("pressure-force") || in.contains("viscous-force"));
    const double t = step_.time + step_.dt;
    std::vector<double> way(24, 0.), velocity(24, 0.);
    for (int i = 0; i < 12; ++i)
      way[std::size_t(2 * i + 1)] = 3 * t * t, velocity[std::size_t(2 * i + 1)] = 6 * t;
    if (gives_velocity) return {{"Way", way}, {"velocity", velocity}};
    return {{"Way", way}};
  }
  std::vector<double> load;
  std::string unit = "1";
  bool gives_velocity = false;
};

class Wind final : public Quiet {
 public:
  Interface initialise() override {
    Interface line{2,
                   {},
                   {},
                   {},
                   {{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}},
                   {{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}}};
    lay_out(line, 6, true);
    return line;
  }
  Exchange solve(const Exchange&) override {
    return {{"pressure-force", {0, 1, 0, 2, 0, 3, 0, 4, 0, 5}},
            {"viscous-force", std::vector<double>(10, 0.5)}};
  }
};

struct Shaken : ForeignCase {
  Shaker shaker;
  Wind wind;
  std::vector<double> way, velocity;

  Shaken() {
    coupling.structure.emplace();
    coupling.structure->displacement = "Way", coupling.structure->load = "Push";
    simulation.end_time = 0.97;
    simulation.time_step = 0.05;
  }
  std::string operator()() {
    const auto job = coupler(wind, shaker);
    std::string problem = job->run();
    way = job->given_by("solid").at("displacement"), velocity = job->given_by("solid").at("velocity");
    return problem;
  }
  std::string error() {
    return support::error_of([&] { (*this)(); });
  }
};

TEST(ForeignStructure, its_displacement_goes_on_with_a_velocity_of_second_order_in_steps_of_any_length) {
  Shaken run;
  EXPECT_EQ(run(), "");
  for (std::size_t i = 1; i < 24; i += 2) {
    EXPECT_NEAR(run.way[i], 3 * 0.97 * 0.97, 1e-12);
    EXPECT_NEAR(run.velocity[i], 6 * 0.97, 1e-10);  // a parabola exactly, after a last step of 0.02 s
  }
  run.simulation.end_time = 0.05;
  EXPECT_EQ(run(), "");
  EXPECT_NEAR(run.velocity[1], 3 * 0.05, 1e-12);  // of first order in the first step
}

TEST(ForeignStructure, takes_the_sum_of_all_forces_at_its_vertices_with_its_moment) {
  Shaken run;
  EXPECT_EQ(run(), "");
  double along = 0, across = 0, moment = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    along += run.shaker.load[2 * i], across += run.shaker.load[2 * i + 1];
    moment += double(i) / 11 * run.shaker.load[2 * i + 1];
  }
  EXPECT_NEAR(along, 2.5, 1e-12);
  EXPECT_NEAR(across, 15 + 2.5, 1e-12);
  EXPECT_NEAR(moment, 0.1 * (1.5 + 3 * 2.5 + 5 * 3.5 + 7 * 4.5 + 9 * 5.5), 1e-12);
}

TEST(ForeignStructure, data_that_it_does_not_announce_are_named) {
  Shaken run;
  run.coupling.structure->displacement = "Weg";
  EXPECT_EQ(
      run.error(),
      "coupling.structure.displacement: 'solid' gives no vector 'Weg' [m, or without a unit] at vertices. It gives: "
      "'Way' [1] at vertices.");
  run.coupling.structure->displacement = "Way", run.coupling.structure->load = "Pull";
  EXPECT_EQ(run.error(),
            "coupling.structure.load: 'solid' takes no force 'Pull' [N]. It takes: 'Push' [N] at vertices.");
  run.coupling.structure->load = "Push", run.shaker.unit = "mm";
  EXPECT_THAT(run.error(), testing::HasSubstr("'Way' [mm] at vertices"));
}

TEST(ForeignStructure, continues_from_a_checkpoint_bit_for_bit_whether_its_velocity_is_given_or_derived) {
  for (const bool gives : {false, true}) {
    Shaken whole, run;
    whole.shaker.gives_velocity = run.shaker.gives_velocity = gives;
    whole.folder += "-whole";
    EXPECT_EQ(whole(), "");
    run.simulation.end_time = 0.5;
    EXPECT_EQ(run(), "");
    EXPECT_NEAR(run.velocity[1], 6 * 0.5, 1e-10);
    run.restart = app::find_checkpoint(run.folder / "checkpoints");
    // One step: its velocity follows from both displacements that were kept.
    run.simulation.end_time = 0.55;
    EXPECT_EQ(run(), "");
    EXPECT_NEAR(run.velocity[1], 6 * 0.55, 1e-10);
    run.simulation.end_time = whole.simulation.end_time;
    EXPECT_EQ(run(), "");
    EXPECT_EQ(run.way, whole.way);
    EXPECT_EQ(run.velocity, whole.velocity);
  }
}

TEST(ForeignStructure, a_checkpoint_of_one_that_gives_its_velocity_has_no_displacements_to_derive_it_from) {
  Shaken run;
  run.shaker.gives_velocity = true;
  run.simulation.end_time = 0.5;
  EXPECT_EQ(run(), "");
  run.restart = app::find_checkpoint(run.folder / "checkpoints");
  run.shaker.gives_velocity = false;
  run.simulation.end_time = 0.9;
  EXPECT_THAT(run.error(), testing::HasSubstr("solid-displacement"));
}

TEST(Balancing, forces_at_vertices_have_a_sum_a_moment_and_work) {
  const coupler::Side side(MPI_COMM_SELF, "solid", {2, {{1, 0, 0}, {3, 0, 0}}, {}, {}, {}, {}});
  const coupler::Balance b = coupler::Balancing(MPI_COMM_SELF, side)(
      {{"Push", {0, 2, 1, 5}}}, {{"Push", "N", Place::vertices}}, {0.5, 0.1, 0.2, 0.3});
  EXPECT_EQ(b.force, Vec3(1, 7, 0));
  EXPECT_EQ(b.moment, Vec3(0, 0, 17));
  EXPECT_DOUBLE_EQ(b.work, 0.2 + 0.2 + 1.5);
}

}  // namespace couplet::foreign_structure_test
