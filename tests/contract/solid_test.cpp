// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/solid.hpp"
#include "tests/contract/contract_suite.hpp"
#include "tests/contract/standalone_suite.hpp"

namespace couplet::contract {
using namespace coupling;

using namespace solid;
namespace {

using Kinematics = SolidParameters::Kinematics;

/// A clamped column, wetted on three sides.
template <Kinematics kinematics, int nu_by_ten_thousand = 3000>
struct SolidFactory {
  static mesh::RawMesh raw_mesh() {
    return mesh::make_box(mesh::BoxCells::quadrilaterals, {3, 12, 1}, Vec3::Zero(), Vec3(0.1, 1, 0));
  }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    SolidParameters p;
    p.mesh = "box";
    p.dimension = 2;
    p.analysis = SolidParameters::Analysis::dynamic;
    p.kinematics = kinematics;
    p.material = {3000, 4e6, nu_by_ten_thousand * 1e-4};
    if (kinematics == Kinematics::finite_strain) p.material.law = "nearly-incompressible-neo-hookean";
    p.boundaries["ymin"].type = SolidBoundary::Type::fixed_displacement;
    p.boundaries["ymin"].value = {{"0"}, {"0"}};
    for (const char* side : {"xmin", "xmax", "ymax"})
      p.boundaries[side].type = SolidBoundary::Type::interface_;
    return std::make_unique<Solid>(mesh_of<SolidFactory>(comm), p, SolidContext{});
  }
  static Exchange input(const Interface& interface, double factor) {
    Exchange in;
    for (const Vec3& area : interface.face_areas)
      for (int c = 0; c < 2; ++c) {
        in["pressure-force"].push_back(c == 0 && area.x() < 0 ? 10 * factor * area.norm() : 0);
        in["viscous-force"].push_back(c == 1 ? factor * area.norm() : 0);
      }
    return in;
  }
  static constexpr Scheme scheme = Scheme::implicit;
  static constexpr double dt = 0.01, repeat_tolerance = 1e-11, rank_tolerance = 1e-9,
                          restart_tolerance = 1e-11;
};

/// The column on its own, pushed by a traction.
template <Kinematics kinematics, int nu_by_ten_thousand = 3000>
struct SolidAlone {
  static mesh::RawMesh raw_mesh() { return SolidFactory<kinematics>::raw_mesh(); }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    SolidParameters p;
    p.mesh = "box";
    p.dimension = 2;
    p.analysis = SolidParameters::Analysis::dynamic;
    p.kinematics = kinematics;
    p.material = {3000, 4e6, nu_by_ten_thousand * 1e-4};
    if (kinematics == Kinematics::finite_strain) p.material.law = "nearly-incompressible-neo-hookean";
    p.boundaries["ymin"].type = SolidBoundary::Type::fixed_displacement;
    p.boundaries["ymin"].value = {{"0"}, {"0"}};
    for (const char* side : {"xmin", "xmax"}) {
      p.boundaries[side].type = SolidBoundary::Type::traction;
      p.boundaries[side].value = {{"0"}, {"0"}};
    }
    p.boundaries["ymax"].type = SolidBoundary::Type::traction;
    p.boundaries["ymax"].value = {{"1000*t"}, {"0"}};
    return std::make_unique<Solid>(mesh_of<SolidAlone>(comm), p, SolidContext{});
  }
  static constexpr double dt = 0.01, restart_tolerance = 1e-11;
};

using Factories =
    ::testing::Types<SolidFactory<Kinematics::small_strain>, SolidFactory<Kinematics::finite_strain>>;
using Alone = ::testing::Types<SolidAlone<Kinematics::small_strain>, SolidAlone<Kinematics::finite_strain>,
                               SolidAlone<Kinematics::finite_strain, 4999>>;
INSTANTIATE_TYPED_TEST_SUITE_P(SolidAlone, StandaloneContract, Alone);
INSTANTIATE_TYPED_TEST_SUITE_P(Solid, ParticipantContract, Factories);

}  // namespace
}  // namespace couplet::contract
