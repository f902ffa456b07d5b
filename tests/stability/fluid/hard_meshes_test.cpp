// SPDX-License-Identifier: Apache-2.0
// Meshes that nobody should make: the fluid solves them or refuses with the reason; it never gives NaN.
#include "../../verification/fluid/fluid_case.hpp"
#include "common/mesh/quality.hpp"

namespace couplet::fluid::test::hard_meshes_test {
using namespace mesh;

struct Outcome {
  bool solved = false;
  double error = 0, non_orthogonality = 0;
  std::string reason;
};

/// What a refusal has to say: which part, and a number of the mesh.
const char* const reasons[] = {"non-orthogonal correction of the viscous term",
                               "non-orthogonal correction of the pressure", "The flow diverges at t ="};

/// Channel flow u = 4 y (1 - y) through a box [0, 2] x [0, 1] (x [0, 0.5]) whose points were moved by `map`.
template <int D>
Outcome channel_on(RawMesh raw, ViscousTreatment viscous) {
  FluidParameters p = fluid_of(1.3, 0.05, 1e-6);
  p.viscous = viscous;
  std::vector<std::string> profile{"4*y*(1-y)", "0"};
  if (D == 3) {
    profile.push_back("0");
    p.boundaries["zmin"] = p.boundaries["zmax"] = boundary(BoundaryType::slip);
  }
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::no_slip);
  p.boundaries["xmin"] = boundary(BoundaryType::inlet, profile);
  p.boundaries["xmax"] = boundary(BoundaryType::outlet);
  for (const std::string& text : profile) p.initial_velocity.push_back({text});
  Outcome outcome;
  try {
    FluidCase<D> c(MPI_COMM_WORLD, raw, p);
    outcome.non_orthogonality = measure_quality(c.mesh(), c.geometry()).max_non_orthogonality;
    c.run(0.4, 8);
    outcome.error = c.velocity_error([](const Vec3& x) { return Vec3(4 * x.y() * (1 - x.y()), 0, 0); });
    outcome.solved = true;
  } catch (const Error& e) {
    outcome.reason = e.what();
  }
  return outcome;
}

/// `may_be_refused`: for one of the reasons above; else the mesh has to be solved.
void judge(const char* name, const Outcome& o, double largest_error, bool may_be_refused = false) {
  printf("%s: non-orthogonality %.1f degrees, %s %.2e %s\n", name, o.non_orthogonality,
         o.solved ? "solved, error" : "refused", o.error, o.reason.substr(0, 150).c_str());
  ::testing::Test::RecordProperty("solved", o.solved ? 1 : 0);
  if (o.solved) ::testing::Test::RecordProperty("error", fmt::format("{:.3e}", o.error));
  if (o.solved) {
    EXPECT_TRUE(std::isfinite(o.error));
    EXPECT_LT(o.error, largest_error);
  } else {
    EXPECT_TRUE(may_be_refused) << "others like it are solved: " << o.reason;
    EXPECT_TRUE(std::ranges::any_of(reasons, [&](const char* r) {
      return o.reason.find(r) != o.reason.npos;
    })) << o.reason;
  }
}

class HardMeshes : public ::testing::TestWithParam<ViscousTreatment> {};

/// Columns lean over: so many degrees between the normals of the rows and the lines between cell centres.
RawMesh leaning(double degrees) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {30, 16, 1}, Vec3::Zero(), Vec3(2, 1, 1));
  const double slope = std::tan(degrees * std::numbers::pi / 180);
  for (Vec3& x : raw.points) x.x() += slope * (0.5 - std::abs(x.y() - 0.5));
  return raw;
}

TEST_P(HardMeshes, sheared_by_sixty_degrees) {
  const Outcome o = channel_on<2>(leaning(60), GetParam());
  EXPECT_TRUE(o.solved && o.non_orthogonality > 59);
  judge("60 degrees", o, 0.1);
}

TEST_P(HardMeshes, sheared_by_seventy_degrees) {
  const RawMesh raw = leaning(70);
  const Outcome o = channel_on<2>(raw, GetParam());
  EXPECT_TRUE(!o.solved || o.non_orthogonality > 69);
  judge("70 degrees", o, 0.2);
}

TEST_P(HardMeshes, cells_a_thousand_times_longer_than_thick) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 30, 1}, Vec3::Zero(), Vec3(2, 1, 1));
  for (Vec3& x : raw.points) {  // first row 0.5 / 1000 thick
    const double s = 2 * x.y() - 1;
    x.y() = 0.5 * (1 + std::tanh(3.65 * s) / std::tanh(3.65));
  }
  judge("aspect ratio 1000", channel_on<2>(raw, GetParam()), 0.1);
}

TEST_P(HardMeshes, cells_a_hundred_thousand_times_longer_than_thick) {
  if (GetParam() == ViscousTreatment::explicit_) GTEST_SKIP() << "its stable step is 3e-10 s";
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 30, 1}, Vec3::Zero(), Vec3(2, 1, 1));
  for (Vec3& x : raw.points) x.y() = 0.5 * (1 + std::tanh(6.235 * (2 * x.y() - 1)) / std::tanh(6.235));
  EXPECT_NEAR(0.5 / raw.points[5].y(), 1e5, 1e4);
  judge("aspect ratio 1e5", channel_on<2>(raw, GetParam()), 0.1);
}

/// Vortices that decay between slip walls, periodic along them, on parallelograms that lean by `degrees`.
/// Largest kinetic energy over that of the exact solution.
double energy_over_exact(double degrees, double nu, int n, ViscousTreatment viscous) {
  using std::numbers::pi;
  FluidParameters p = fluid_of(1, nu);
  p.viscous = viscous;
  p.initial_velocity = {{"sin(x)*cos(y)"}, {"-cos(x)*sin(y)"}};
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(BoundaryType::slip);
  p.boundaries["xmin"] = p.boundaries["xmax"] = boundary(BoundaryType::periodic);
  RawMesh raw = make_box(BoxCells::quadrilaterals, {2 * n, n, 1}, Vec3::Zero(), Vec3(2 * pi, pi, 1));
  for (Vec3& x : raw.points) x.x() += std::tan(degrees * pi / 180) * x.y();
  raw.periodic = {{"xmin", "xmax"}};
  FluidCase<2> c(MPI_COMM_WORLD, raw, p);
  double largest = 0;
  for (int i = 0; i < 30; ++i) {
    c.step(0.1);
    const double exact = pi * pi / 2 * std::exp(-4 * nu * c.state().time);
    largest = std::max(largest, c.state().ledger.energy / exact);
  }
  return largest;
}

// Two passes of the pressure's non-orthogonal part let the energy grow to many times the exact one here.
TEST_P(HardMeshes, vortices_on_cells_sheared_by_55_degrees_decay) {
  for (const auto& [nu, n] : {std::pair{1.0, 16}, {0.1, 16}, {0.1, 32}})
    EXPECT_LT(energy_over_exact(55, nu, n, GetParam()), 1.02) << "nu " << nu << ", n " << n;
}
TEST_P(HardMeshes, vortices_on_cells_sheared_by_75_degrees_decay) {
  if (GetParam() == ViscousTreatment::explicit_)
    GTEST_SKIP() << "its two passes of the pressure do not hold here";
  EXPECT_LT(energy_over_exact(75, 0.1, 16, GetParam()), 1.02);
}

TEST_P(HardMeshes, needle_tetrahedra) {
  RawMesh raw = make_box(BoxCells::tetrahedra, {20, 5, 2}, Vec3::Zero(), Vec3(2, 1, 0.01));
  perturb_interior(raw, 0.2, 3);
  judge("needles", channel_on<3>(raw, GetParam()), 0.2, true);
}

TEST_P(HardMeshes, tetrahedra_stretched_to_slivers) {
  RawMesh raw = make_box(BoxCells::tetrahedra, {8, 6, 3}, Vec3::Zero(), Vec3(2, 1, 0.5));
  perturb_interior(raw, 0.33, 5);
  judge("slivers", channel_on<3>(raw, GetParam()), 0.5);
}

INSTANTIATE_TEST_SUITE_P(viscous, HardMeshes,
                         ::testing::Values(ViscousTreatment::explicit_, ViscousTreatment::implicit),
                         [](const auto& info) {
                           return info.param == ViscousTreatment::explicit_ ? "explicit" : "implicit";
                         });

}  // namespace couplet::fluid::test::hard_meshes_test
