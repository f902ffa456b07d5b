// SPDX-License-Identifier: Apache-2.0
// The elements of a tank that are participants of their own.
#include "common/base/error.hpp"
#include "tests/contract/contract_suite.hpp"
#include "thermocline/model/elements.hpp"

namespace couplet::contract {
using namespace coupling;
namespace {

thermocline::ElementParameters element(thermocline::ElementParameters::Type type) {
  thermocline::ElementParameters p;
  p.type = type;
  p.ground.diameter = 18.2, p.ground.initial_temperature = 477;
  p.ground.ground.layers = {{"steel-plate", 0.02}, {"concrete", 0.6}, {"soil", 9}};
  // As high as wide: one number stands for all lengths that a tank tells.
  p.blanket.diameter = p.blanket.height = 18.2, p.blanket.sections = 30;
  p.blanket.initial_temperature = 477;

  return p;
}

template <thermocline::ElementParameters::Type type>
struct ElementFactory {
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    app::ParticipantContext context;
    context.comm = comm;
    context.coupled = true;
    return thermocline::make_element(element(type), context);
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const auto& datum : interface.takes) {
      std::vector<double> values(interface.face_centres.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = datum.unit == "K" ? 477 + factor * (20 + double(i)) : datum.unit == "m" ? 18.2 : 50;
      in[datum.name] = values;
    }
    return in;
  }
  static constexpr Scheme scheme = Scheme::explicit_;
  static constexpr double dt = 900, repeat_tolerance = 0, rank_tolerance = 0, restart_tolerance = 0;
};
using Ground = ElementFactory<thermocline::ElementParameters::Type::ground>;
using Blanket = ElementFactory<thermocline::ElementParameters::Type::insulation>;

INSTANTIATE_TYPED_TEST_SUITE_P(TankGround, ParticipantContract, Ground);
INSTANTIATE_TYPED_TEST_SUITE_P(TankBlanket, ParticipantContract, Blanket);

/// On every rank, for each element: a tank of another diameter or height is refused.
template <class Factory>
void refuses_another_length(const char* name, double slack) {
  for (const double length : {18.2, 18.2 * (1 + 0.5 * slack), 18.2 * (1 + 2 * slack), 20.0}) {
    const auto part = Factory::make(MPI_COMM_WORLD);
    const Interface interface = part->initialise();
    Exchange in = Factory::input(interface, 1);
    if (in.count(name)) in[name].assign(in[name].size(), length);
    part->begin_step({0, 900});
    if (length < 18.2 * (1 + slack))
      EXPECT_NO_THROW(part->solve(in)) << length;
    else
      EXPECT_THROW(part->solve(in), Error) << length;
  }
}
TEST(TankParts, a_contradicting_length_is_refused_on_every_rank) {
  refuses_another_length<Ground>("tank-diameter", 1e-3);
  refuses_another_length<Blanket>("wall-diameter", 0.02);
  refuses_another_length<Blanket>("wall-height", 1e-3);
}

}  // namespace
}  // namespace couplet::contract
