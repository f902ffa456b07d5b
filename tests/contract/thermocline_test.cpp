// SPDX-License-Identifier: Apache-2.0
// The elements of a tank that are participants of their own.
#include "tests/contract/contract_suite.hpp"
#include "thermocline/elsewhere.hpp"

namespace couplet::contract {
namespace {

thermocline::ElementParameters element(thermocline::ElementParameters::Type type) {
  thermocline::ElementParameters p;
  p.type = type;
  p.ground.diameter = 18.2, p.ground.initial_temperature = 477;
  p.ground.ground.layers = {{"steel-plate", 0.02}, {"concrete", 0.6}, {"soil", 9}};
  p.blanket.diameter = 18.2, p.blanket.height = 14, p.blanket.sections = 30;
  p.blanket.initial_temperature = 477;

  return p;
}

template <thermocline::ElementParameters::Type type>
struct ElementFactory {
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    ParticipantContext context;
    context.comm = comm;
    context.coupled = true;
    return thermocline::make_element(element(type), context);
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const auto& datum : interface.takes) {
      std::vector<double> values(interface.face_centres.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = datum.unit == "K" ? 477 + factor * (20 + double(i)) : 50;
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

}  // namespace
}  // namespace couplet::contract
