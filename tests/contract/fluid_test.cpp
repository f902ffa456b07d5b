// SPDX-License-Identifier: Apache-2.0
#include "common/base/error.hpp"
#include "fluid_solver/participant.hpp"
#include "tests/contract/contract_suite.hpp"
#include "tests/contract/standalone_suite.hpp"

namespace couplet::contract {
using namespace coupling;
using namespace mesh;
namespace {

/// Moves the mesh up by an amount that falls from the lower wall to the top, as the last input asked for.
double moved_by = 0;  // NOLINT: the link between an input and the motion that goes with it
class Motion final : public MeshMotionSource {
 public:
  Motion(const Mesh& mesh, std::span<const Vec3> points) : mesh_(mesh), points_(points) {}
  std::vector<double> receive() override {
    std::vector<double> displacement;
    for (const Vec3& x : points_)
      for (int c = 0; c < mesh_.dim; ++c)
        displacement.push_back(c == 1 ? moved_by * x.x() * (2 - x.x()) * (1 - x.y()) : 0);
    return displacement;
  }
  const std::vector<double>& velocity() const override { return none_; }

 private:
  const Mesh& mesh_;
  std::span<const Vec3> points_;
  std::vector<double> none_;
};

fluid::FluidParameters of_a_box() {
  fluid::FluidParameters p;
  p.mesh = "box";
  p.dimension = 2;
  p.density = 1;
  p.viscosity = 0.01;
  return p;
}

/// A channel whose lower wall moves, with or without its mesh.
template <Scheme S, bool Moving>
struct FluidFactory {
  static RawMesh raw_mesh() {
    return make_box(BoxCells::quadrilaterals, {12, 8, 1}, Vec3::Zero(), Vec3(2, 1, 0));
  }
  static fluid::FluidParameters parameters() {
    using namespace fluid;
    FluidParameters p = of_a_box();
    p.pressure_tolerance = 1e-12;
    p.boundaries["xmin"].type = BoundaryType::inlet;
    p.boundaries["xmin"].velocity = {{"1"}, {"0"}};
    p.boundaries["xmax"].type = BoundaryType::outlet;
    p.boundaries["ymax"].type = BoundaryType::slip;
    p.boundaries["ymin"].type = BoundaryType::interface;
    p.initial_velocity = {{"1"}, {"0"}};
    return p;
  }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    using namespace fluid;
    const FluidParameters p = parameters();
    MotionLink link;
    if (Moving)
      link = [](const Mesh& mesh, std::span<const Vec3> points) {
        return std::make_unique<Motion>(mesh, points);
      };
    return make_participant(mesh_of<FluidFactory>(comm), p, FluidContext{}, link);
  }
  static Exchange input(const Interface& interface, double factor) {
    moved_by = 0.01 * factor;
    Exchange in;
    for (const Vec3& x : interface.vertices)
      for (int c = 0; c < interface.dim; ++c) {
        in["displacement"].push_back(0);
        in["velocity"].push_back(c == 1 ? 0.1 * factor * x.x() * (2 - x.x()) : 0);
      }
    return in;
  }
  static Exchange hopeless(const Interface& interface) {
    Exchange in = input(interface, 1);
    for (double& v : in["velocity"]) v *= 1e30;
    return in;
  }
  static constexpr Scheme scheme = S;
  static constexpr double dt = 0.01, repeat_tolerance = 1e-8, rank_tolerance = 1e-7, restart_tolerance = 0;
};

/// The channel as a duct, with multigrid in the place of factors.
struct MovingDuct : FluidFactory<Scheme::implicit, true> {
  static RawMesh raw_mesh() { return make_box(BoxCells::hexahedra, {8, 5, 4}, Vec3::Zero(), Vec3(2, 1, 1)); }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    using namespace fluid;
    FluidParameters p = parameters();
    p.dimension = 3;
    p.boundaries["xmin"].velocity = {{"1"}, {"0"}, {"0"}};
    p.boundaries["zmin"].type = p.boundaries["zmax"].type = BoundaryType::slip;
    p.initial_velocity = p.boundaries["xmin"].velocity;
    const MotionLink link = [](const Mesh& mesh, std::span<const Vec3> points) {
      return std::make_unique<Motion>(mesh, points);
    };
    return make_participant(mesh_of<MovingDuct>(comm), p, FluidContext{}, link);
  }
};

/// A channel on its own, on a skewed mesh; given sub-steps, so that a step has several.
template <fluid::ViscousTreatment Viscous>
struct FluidAlone {
  static RawMesh raw_mesh() {
    RawMesh raw = make_box(BoxCells::quadrilaterals, {12, 8, 1}, Vec3::Zero(), Vec3(2, 1, 0));
    perturb_interior(raw, 0.15, 3);
    return raw;
  }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    using namespace fluid;
    FluidParameters p = of_a_box();
    p.viscous = Viscous;
    p.boundaries["xmin"].type = BoundaryType::inlet;
    p.boundaries["xmin"].velocity = {{"1+sin(9*t)"}, {"0"}};
    p.boundaries["xmax"].type = BoundaryType::outlet;
    p.boundaries["ymax"].type = BoundaryType::slip;
    p.boundaries["ymin"].type = BoundaryType::no_slip;
    return make_participant(mesh_of<FluidAlone>(comm), p, FluidContext{}, {});
  }
  static constexpr double dt = 0.05, restart_tolerance = 0;
};
/// A duct with a moving middle, on its own.
struct FluidInMotion {
  static RawMesh raw_mesh() { return FluidAlone<fluid::ViscousTreatment::explicit_>::raw_mesh(); }
  static std::unique_ptr<Participant> make(MPI_Comm comm) {
    using namespace fluid;
    FluidParameters p = of_a_box();
    p.motion.emplace();
    p.motion->angle = {"0.3*sin(t)"};
    p.motion->centre = Vec3(1, 0.5, 0);
    p.motion->outer_radius = 0.45;
    p.boundaries["xmin"].type = BoundaryType::inlet;
    p.boundaries["xmin"].velocity = {{"1"}, {"0"}};
    p.boundaries["xmax"].type = BoundaryType::outlet;
    p.boundaries["ymax"].type = p.boundaries["ymin"].type = BoundaryType::no_slip;
    return make_participant(mesh_of<FluidInMotion>(comm), p, FluidContext{}, {});
  }
  static constexpr double dt = 0.05, restart_tolerance = 0;
};
INSTANTIATE_TYPED_TEST_SUITE_P(FluidInMotion, StandaloneContract, FluidInMotion);
using FluidAloneExplicit = FluidAlone<fluid::ViscousTreatment::explicit_>;
using FluidAloneImplicit = FluidAlone<fluid::ViscousTreatment::implicit>;
INSTANTIATE_TYPED_TEST_SUITE_P(FluidAloneExplicit, StandaloneContract, FluidAloneExplicit);
INSTANTIATE_TYPED_TEST_SUITE_P(FluidAloneImplicit, StandaloneContract, FluidAloneImplicit);

/// Semi-implicit: where the wall moves otherwise than guessed, a later pass gives what a first one with that
/// motion gives; where it was guessed well the prediction is kept.
TEST(SemiImplicitFluid, renews_its_prediction_where_friction_would_say_something_else) {
  using Factory = FluidFactory<Scheme::semi_implicit, false>;
  fluid::FluidParameters p = Factory::parameters();
  p.viscosity = 1;
  p.viscous = fluid::ViscousTreatment::implicit;  // the explicit one of a first step does not know w yet
  const auto passes = [&](const std::vector<double>& factors) {
    const auto fluid =
        fluid::make_participant(mesh_of<Factory>(MPI_COMM_WORLD), p, fluid::FluidContext{}, {});
    const Interface interface = fluid->initialise();
    std::vector<Exchange> out;
    fluid->begin_step({0, Factory::dt, Factory::scheme, 0});
    for (const double factor : factors) out.push_back(fluid->solve(Factory::input(interface, factor)));
    return out;
  };
  const auto renewed = passes({1, 50, 50, 50}), told = passes({50}), kept = passes({50, 50.001, 50, 50});
  if (parallel::comm_rank(MPI_COMM_WORLD) != 0) return;
  EXPECT_GT(difference(renewed[1], told[0]), 1e-5) << "friction does not matter here: the case shows nothing";
  EXPECT_LT(difference(renewed[3], told[0]), 1e-8);
  EXPECT_LT(difference(kept[3], told[0]), 1e-8);
  EXPECT_LT(difference(kept[2], kept[3]), 1e-12);
}

/// The floor of a box without an outlet.
TEST(ClosedFluid, whose_interface_would_have_to_change_its_volume_is_refused_at_the_start) {
  using namespace fluid;
  FluidParameters p = of_a_box();
  for (const char* side : {"xmin", "xmax", "ymax"}) p.boundaries[side].type = BoundaryType::no_slip;
  p.boundaries["ymin"].type = BoundaryType::interface;
  const auto begin = [&](Scheme scheme) {
    using Factory = FluidFactory<Scheme::semi_implicit, false>;
    make_participant(mesh_of<Factory>(MPI_COMM_WORLD), p, FluidContext{}, {})
        ->begin_step({0, 0.01, scheme, 0});
  };
  EXPECT_NE(support::error_of([&] { begin(Scheme::semi_implicit); }).find("has no outlet"),
            std::string::npos);
  EXPECT_NO_THROW(begin(Scheme::standalone)) << "a wall at rest there";
  p.boundaries["xmax"].type = BoundaryType::outlet;
  EXPECT_NO_THROW(begin(Scheme::semi_implicit));
}

/// A box whose four walls are the interface, as of a body around it: its walls may move, but not with an
/// inlet open.
TEST(ClosedFluid, that_is_pumped_up_is_refused_with_the_flow) {
  using namespace fluid;
  FluidParameters p = of_a_box();
  p.boundaries["ymax"].type = p.boundaries["ymin"].type = p.boundaries["xmax"].type = BoundaryType::interface;
  p.boundaries["xmin"].type = BoundaryType::inlet;
  p.boundaries["xmin"].velocity = {{"1"}, {"0"}};
  using Factory = FluidFactory<Scheme::semi_implicit, false>;
  const auto& [mesh, geometry] = mesh_of<Factory>(MPI_COMM_WORLD);
  Fluid<2> fluid(mesh, geometry, p, false);
  fluid.begin_step(0, 0.01);
  const Vectors<2> rest(mesh.boundary.n_owned(), Vec<2>::Zero());
  EXPECT_THROW(fluid.solve({}, rest), Error);
}

using SemiImplicit = FluidFactory<Scheme::semi_implicit, false>;
using Implicit = FluidFactory<Scheme::implicit, false>;
using MovingSemiImplicit = FluidFactory<Scheme::semi_implicit, true>;
using MovingImplicit = FluidFactory<Scheme::implicit, true>;
INSTANTIATE_TYPED_TEST_SUITE_P(FluidSemiImplicit, ParticipantContract, SemiImplicit);
INSTANTIATE_TYPED_TEST_SUITE_P(FluidImplicit, ParticipantContract, Implicit);
INSTANTIATE_TYPED_TEST_SUITE_P(FluidMovingSemiImplicit, ParticipantContract, MovingSemiImplicit);
INSTANTIATE_TYPED_TEST_SUITE_P(FluidMovingImplicit, ParticipantContract, MovingImplicit);
INSTANTIATE_TYPED_TEST_SUITE_P(FluidMovingDuct, ParticipantContract, MovingDuct);

}  // namespace
}  // namespace couplet::contract
