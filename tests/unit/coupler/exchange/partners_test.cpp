// SPDX-License-Identifier: Apache-2.0
// Programs that read their configuration themselves, and the case that was made of it.
#include "coupler/exchange/partners.hpp"

#include "tests/coupling/support/local_channel.hpp"
#include "tests/unit/coupler/foreign.hpp"

namespace couplet::introductions_test {
using namespace coupling;
using namespace coupler;
namespace {

class Nobody final : public Quiet {
 public:
  Interface initialise() override { return {}; }
  Exchange solve(const Exchange&) override { return {}; }
};

/// What is said of "Left" and "Right" that introduce themselves so; empty: nothing.
std::string said(const CouplingParameters& coupling, const std::string& left, const std::string& right) {
  Nobody nobody;
  std::vector<Partner> partners(2);
  partners[0].channel = std::make_unique<LocalChannel>("Left", nobody), partners[0].introduction = left;
  partners[1].channel = std::make_unique<LocalChannel>("Right", nobody), partners[1].introduction = right;
  return support::error_of([&] { check_introductions(coupling, partners); });
}

CouplingParameters imported(Scheme scheme, ExchangeParameters::Order order) {
  CouplingParameters p;
  p.scheme = scheme;
  p.exchange = {{"Left", "Right"}, order, "xml-1"};
  return p;
}

using Order = ExchangeParameters::Order;
const std::string serial =
    "xml-1\x1e"
    "implicit\x1fserial\x1fLeft\x1fRight";
const std::string side_by_side =
    "xml-1\x1e"
    "explicit\x1fparallel";

TEST(Introductions, programs_and_a_case_of_one_configuration_agree) {
  EXPECT_EQ(said(imported(Scheme::implicit, Order::serial), serial, serial), "");
  EXPECT_EQ(said(imported(Scheme::explicit_, Order::parallel), side_by_side, side_by_side), "");
}

TEST(Introductions, another_configuration_than_the_cases_or_the_partners_is_refused) {
  CouplingParameters p = imported(Scheme::implicit, Order::serial);
  p.exchange->digest = "xml-2";
  EXPECT_EQ(
      said(p, "", serial),
      "coupling.exchange.digest: 'Right' reads a preCICE configuration that differs from the one this case was created from: "
      "either it was edited since, or it is a different file. Recreate the case with `couplet import FILE --force`.");
  p.exchange->digest = "";
  EXPECT_EQ(
      said(p, "xml-2", serial),
      "'Left' and 'Right' read different preCICE configurations: give both the same file. If it was edited, recreate the case "
      "with `couplet import FILE --force`.");
}

TEST(Introductions, a_scheme_or_an_order_that_is_not_the_configurations_is_refused) {
  const std::string again =
      " in the configuration that 'Left' reads. Recreate the case with `couplet import FILE --force`.";
  EXPECT_EQ(said(imported(Scheme::explicit_, Order::serial), serial, serial),
            "coupling.scheme: explicit here, but implicit" + again);
  EXPECT_EQ(said(imported(Scheme::implicit, Order::parallel), serial, serial),
            "coupling.exchange.order: parallel here, but serial" + again);
  CouplingParameters p = imported(Scheme::implicit, Order::serial);
  std::swap(p.exchange->participants[0], p.exchange->participants[1]);
  EXPECT_EQ(said(p, serial, serial),
            "coupling.exchange.participants: 'Right' before 'Left' here, but after it" + again);
}

TEST(Introductions, a_case_by_hand_and_programs_that_say_nothing_or_something_else_are_let_be) {
  CouplingParameters p = imported(Scheme::explicit_, Order::parallel);
  p.exchange->digest = "";
  EXPECT_EQ(said(p, serial, serial), "");
  p.exchange->digest = "xml-2";
  EXPECT_EQ(said(p, "", "version 7 of mine"), "");
  EXPECT_EQ(said(imported(Scheme::implicit, Order::serial),
                 "xml-1\x1e"
                 "odd\x1f\x1f\x1f\x1f\x1e\x1f",
                 "xml-1"),
            "");
  p = {};
  EXPECT_EQ(said(p, serial, serial), "") << "beside programs of this project the case has the scheme";
}

}  // namespace
}  // namespace couplet::introductions_test
