// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/participant.hpp"
#include "tests/contract/contract_suite.hpp"

namespace couplet::contract {
namespace {

/// A channel whose lower wall moves; the mesh stays.
template <Scheme S>
struct FluidFactory {
  static RawMesh raw_mesh() {
    return make_box(BoxCells::quadrilaterals, {12, 8, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    using namespace fluid;
    FluidParameters p;
    p.mesh = "box";
    p.dimension = 2;
    p.density = 1;
    p.viscosity = 0.01;
    p.pressure_tolerance = 1e-12;
    p.boundaries["xmin"].type = BoundaryType::inlet;
    p.boundaries["xmin"].velocity = {{"1"}, {"0"}};
    p.boundaries["xmax"].type = BoundaryType::outlet;
    p.boundaries["ymax"].type = BoundaryType::slip;
    p.boundaries["ymin"].type = BoundaryType::interface;
    p.initial_velocity = {{"1"}, {"0"}};
    return make_participant(mesh_of<FluidFactory>(comm), p, FluidContext{}, {});
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const Vec3& x : interface.vertices)
      for (const double v : {0., 0.1 * factor * x.x() * (2 - x.x())}) {
        in["displacement"].push_back(0);
        in["velocity"].push_back(v);
      }
    return in;
  }
  static constexpr Scheme scheme = S;
  static constexpr double dt = 0.01, repeat_tolerance = 1e-8, rank_tolerance = 1e-7;
};

using SemiImplicit = FluidFactory<Scheme::semi_implicit>;
using Implicit = FluidFactory<Scheme::implicit>;
INSTANTIATE_TYPED_TEST_SUITE_P(FluidSemiImplicit, ParticipantContract, SemiImplicit);
INSTANTIATE_TYPED_TEST_SUITE_P(FluidImplicit, ParticipantContract, Implicit);

}  // namespace
}  // namespace couplet::contract
