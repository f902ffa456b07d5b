// SPDX-License-Identifier: Apache-2.0
#include "coupler/wiring.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.hpp"

namespace couplet {
namespace {

using Place = Interface::Place;
using Data = std::vector<Interface::Datum>;

const Data motion{{"displacement", "m", Place::vertices}, {"velocity", "m/s", Place::vertices}};
const Data load{{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}};

/// Three vertices and two faces on a line, 2-D; the fluid's run the other way.
Side structure() {
  return {"solid",
          {2,
           {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},
           {{0.5, 0, 0}, {1.5, 0, 0}},
           {{0, 1, 0}, {0, 1, 0}},
           load,
           motion}};
}
Side fluid() {
  return {"fluid",
          {2,
           {{2, 0, 0}, {1, 0, 0}, {0, 0, 0}},
           {{1.5, 0, 0}, {0.5, 0, 0}},
           {{0, -1, 0}, {0, -1, 0}},
           motion,
           load}};
}

std::string message(const Side& fluid, const Side& structure, const std::optional<Side>& mesh = {}) {
  try {
    const Wiring wiring(fluid, structure, mesh, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Wiring, motion_goes_to_the_fluid_and_load_to_the_structure) {
  const Wiring wiring(fluid(), structure(), {}, {});
  EXPECT_EQ(wiring.n_unknowns(), 6u);
  const Exchange given = wiring.to_fluid({{1, 2, 3, 4, 5, 6}, {10, 20, 30, 40, 50, 60}});
  EXPECT_EQ(given.at("displacement"), (std::vector<double>{5, 6, 3, 4, 1, 2}));
  EXPECT_EQ(given.at("velocity"), (std::vector<double>{50, 60, 30, 40, 10, 20}));
  const Exchange taken =
      wiring.to_structure({{"pressure-force", {1, 2, 3, 4}}, {"viscous-force", {5, 6, 7, 8}}});
  EXPECT_EQ(taken.at("pressure-force"), (std::vector<double>{3, 4, 1, 2}));
  EXPECT_EQ(taken.at("viscous-force"), (std::vector<double>{7, 8, 5, 6}));
}

TEST(Wiring, a_side_gets_only_what_it_takes) {
  Side mover = fluid();
  mover.interface.takes = {motion[0]};
  const Wiring wiring(fluid(), structure(), mover, {});
  EXPECT_EQ(wiring.to_mesh({std::vector<double>(6), std::vector<double>(6)}).size(), 1u);
}

TEST(Wiring, balance_sums_forces_and_their_work) {
  const Wiring wiring(fluid(), structure(), {}, {});
  const Exchange data{{"pressure-force", {0, 1, 0, 2}}, {"viscous-force", {0.5, 0, 0, 0}}};
  // Increment of the structure's vertices: (0, 0), (0, 1), (2, 1): faces move by (0, 0.5) and (1, 1).
  const Balance balance = wiring.structure_balance(data, {0, 0, 0, 1, 2, 1});
  EXPECT_DOUBLE_EQ(balance.force.x(), 0.5);
  EXPECT_DOUBLE_EQ(balance.force.y(), 3);
  EXPECT_DOUBLE_EQ(balance.work, 1 * 0.5 + 2 * 1 + 0.5 * 0);
}

TEST(Wiring, a_datum_that_nobody_gives_is_named) {
  Side f = fluid();
  f.interface.takes.push_back({"temperature", "K", Place::vertices});
  EXPECT_EQ(message(f, structure()),
            "'fluid' takes 'temperature', which 'solid' does not give. It gives: displacement, velocity.");
}

TEST(Wiring, units_must_agree) {
  Side f = fluid();
  f.interface.takes[0].unit = "mm";
  EXPECT_EQ(message(f, structure()), "'fluid' takes 'displacement' in mm, but 'solid' gives it in m.");
}

TEST(Wiring, dimensions_must_agree) {
  Side f = fluid();
  f.interface.dim = 3;
  EXPECT_EQ(message(f, structure()), "'fluid' has 3 dimensions and 'solid' has 2: both must have the same.");
}

TEST(Wiring, a_structure_that_does_not_move_is_refused) {
  Side s = structure();
  s.interface.gives.pop_back();
  EXPECT_EQ(
      message(fluid(), s),
      "The structure 'solid' does not give 'velocity' at vertices, which is part of the coupling unknown.");
}

TEST(Wiring, a_load_that_nobody_takes_is_noted) {
  Side s = structure();
  s.interface.takes.pop_back();
  const Wiring wiring(fluid(), s, {}, {});
  EXPECT_THAT(wiring.notes(), testing::Contains("note: nobody takes 'viscous-force' of 'fluid'"));
}

TEST(Wiring, data_of_the_wrong_length_are_refused) {
  const Wiring wiring(fluid(), structure(), {}, {});
  EXPECT_THROW(wiring.to_structure({{"pressure-force", {1, 2}}, {"viscous-force", {5, 6, 7, 8}}}), Error);
  EXPECT_THROW(wiring.from_structure({{"displacement", {1, 2}}}), Error);
}

}  // namespace
}  // namespace couplet
