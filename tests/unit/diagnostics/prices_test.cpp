// SPDX-License-Identifier: Apache-2.0
#include "common/diagnostics/prices.hpp"

#include "common/diagnostics/effects.hpp"
#include "fluid_solver/parameters/effects.hpp"
#include "mesh_mover/parameters.hpp"
#include "plate_modal/model/parameters.hpp"
#include "solid_solver/effects.hpp"
#include "tests/support/test.hpp"
#include "thermocline/model/elements.hpp"

namespace couplet::testing::prices_test {
using namespace diagnostics;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

template <class Cards>
std::set<std::string> names(Cards cards) {
  std::set<std::string> found;
  for (const auto& card : cards) found.insert(card.name);
  return found;
}

std::map<std::string, std::set<std::string>> cards_of_all() {
  return {{"solid_solver", names(solid::solid_effect_cards())},
          {"fluid_solver", names(fluid::fluid_effect_cards())},
          {"mesh_mover", names(mesh_mover::effect_cards())},
          {"plate_modal", names(plate::plate_effect_cards())},
          {"thermocline", names(thermocline::effect_cards())}};
}

// A price that no card has, or under another name than the card's, would be shown nowhere.
TEST(PriceList, each_price_is_that_of_a_card_once) {
  const auto cards = cards_of_all();
  std::set<std::tuple<std::string_view, std::string_view, int>> seen;
  for (const Price& p : price_list()) {
    EXPECT_TRUE(cards.at(std::string(p.program)).contains(std::string(p.effect)))
        << p.program << " has no card '" << p.effect << "'";
    EXPECT_TRUE(seen.insert({p.program, p.effect, p.dimension}).second) << p.program << ' ' << p.effect;
  }
  EXPECT_GT(seen.size(), 50u);
}

TEST(PriceList, no_price_is_negative_and_none_ends_below_where_it_begins) {
  for (const Price& p : price_list())
    for (const Spread& s : {p.bytes, p.step}) {
      EXPECT_GE(s.least, 0) << p.program << ' ' << p.effect;
      EXPECT_GE(s.most, s.least) << p.program << ' ' << p.effect;
    }
}

// Of programs with meshes every effect that is priced in the plane is priced in space, too.
TEST(PriceList, prices_of_meshes_are_those_of_two_and_three_dimensions) {
  for (const std::string_view program : {"solid_solver", "fluid_solver", "mesh_mover"})
    for (const Price& p : price_list())
      if (p.program == program) {
        EXPECT_EQ(prices_of(program, p.effect).size(), 2u) << program << ' ' << p.effect;
      }
}

TEST(PriceList, what_a_scene_and_the_documents_show_is_of_the_list) {
  solid::SolidParameters p;
  p.analysis = solid::SolidParameters::Analysis::dynamic;
  p.output.energies = true;
  const std::vector<Effect> effects = effects_of("solid_solver", solid::solid_effect_cards(), p);
  const std::vector<Price> prices = prices_of("solid_solver", "energies");
  ASSERT_EQ(prices.size(), 2u);
  for (const Price& price : prices) {
    ASSERT_THAT(time_text(price), Not(IsEmpty()));
    EXPECT_THAT(explanation(effects), HasSubstr(price_text(price)));
    EXPECT_THAT(markdown("solid_solver", effects), HasSubstr(time_text(price)));
  }
}

TEST(PriceList, text_of_a_spread_names_both_ends_where_they_differ) {
  const Price price{"p", "e", 2, {16, 62}, {0.6, 0.6}};
  EXPECT_EQ(price_text(price), "2-D: 16 to 62 B per cell, +60 % of a step");
  EXPECT_EQ(price_text({"p", "e", 3, {0, 62}, {0, 0}}), "3-D: up to 62 B per cell");
  EXPECT_EQ(price_text({"p", "e", 1, {0, 0}, {0.1, 0.24}}), "+10 to +24 % of a step");
  EXPECT_EQ(price_text({"p", "e", 3, {0, 0}, {0, 0}}), "");
  EXPECT_EQ(column({{"p", "e", 2, {0, 0}, {0, 0}}}, memory_text, "B"), "next to none");
  EXPECT_EQ(column({}, memory_text, "B"), "");
}

// What leaving it out saves is what it takes at least: 48 % more of a step without it is a third of one with it.
TEST(PriceList, what_is_saved_is_the_least_of_the_scenes) {
  double least = 1e300;
  for (const Price& p : prices_of("fluid_solver", "turbulence model")) least = std::min(least, p.step.least);
  EXPECT_DOUBLE_EQ(saved_share("fluid_solver", "turbulence model"), least / (1 + least));
  EXPECT_EQ(saved_share("fluid_solver", "nothing"), 0);
}

}  // namespace couplet::testing::prices_test
