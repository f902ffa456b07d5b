// SPDX-License-Identifier: Apache-2.0
#include "tests/contract/contract_suite.hpp"
#include "tests/coupling/toy/piston.hpp"
#include "tests/coupling/toy/spring.hpp"

namespace couplet::contract {
using namespace coupling;
namespace {

struct SpringFactory {
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    return std::make_unique<toy::Spring>(comm, toy::SpringParameters{7, 0.5, 3});
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const Vec3& x : interface.face_centres) {
      in["pressure-force"].push_back(0);
      in["pressure-force"].push_back(factor * (1 + x.x()));
    }
    return in;
  }
  static constexpr Scheme scheme = Scheme::implicit;
  static constexpr double dt = 0.1, repeat_tolerance = 0, rank_tolerance = 0, restart_tolerance = 0;
};

struct PistonFactory {
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    app::ParticipantContext context;
    context.comm = comm;
    toy::PistonParameters parameters;
    parameters.vertices = 7;
    return std::make_unique<toy::Piston>(context, parameters);
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const Vec3& x : interface.vertices)
      for (const double v : {0., factor * x.x()}) {
        in["displacement"].push_back(0.1 * v);
        in["velocity"].push_back(v);
      }
    return in;
  }
  static constexpr Scheme scheme = Scheme::implicit;
  static constexpr double dt = 0.1, repeat_tolerance = 0, rank_tolerance = 0, restart_tolerance = 0;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Spring, ParticipantContract, SpringFactory);
INSTANTIATE_TYPED_TEST_SUITE_P(Piston, ParticipantContract, PistonFactory);

}  // namespace
}  // namespace couplet::contract
