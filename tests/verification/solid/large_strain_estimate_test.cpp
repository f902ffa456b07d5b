// SPDX-License-Identifier: Apache-2.0
// What a linear run says large strain would change, held against what it changes.
#include "solid_solver/diagnostics/large_strain.hpp"
#include "tests/support/observed_run.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::large_strain_estimate_test {
using namespace mesh;

struct Pair {
  const char* name;
  std::array<double, 2> size{1, 0.1};  // [m]; of E = 1 MPa
  std::array<int, 2> cells{40, 4};
  std::string along = "0", across = "0";  // traction of the free end [Pa]
  std::string body = "0";                 // force per volume across [N/m^3]
  bool clamped_ends = false;
  double nu = 0.3;
  double least = 0;  // the true change is at least so large: the pair would say nothing below
  FaceGradient gradient = FaceGradient::automatic;
  SolidParameters::Plane plane = SolidParameters::Plane::strain;
};

void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.name; }

// With h / L = 0.1 and b = E / (1 - nu^2): EI / L^2 = b h^3 / (12 L^2) = 91.6 N/m; Euler's load 226 N/m, 2260 Pa.
const std::vector<Pair> pairs{
    {.name = "cantilever", .across = "900*t", .least = 0.15},
    {.name = "cantilever_far", .across = "1600*t", .least = 0.25},
    {.name = "clamped_beam",
     .size = {1, 0.02},
     .cells = {80, 4},
     .body = "120*t",
     .clamped_ends = true,
     .least = 0.08},
    {.name = "compressed_column", .along = "-900*t", .across = "30*t", .least = 0.3},
    {.name = "tensioned_beam", .along = "900*t", .across = "90*t", .least = 0.15},
    {.name = "pulled_block", .size = {1, 1}, .cells = {8, 8}, .along = "6e4*t", .least = 0.05},
    {.name = "cantilever_nearly_incompressible",
     .across = "900*t",
     .nu = 0.49,
     .least = 0.1,
     .gradient = FaceGradient::symmetric},
    // Its work is almost all along the pull, which makes it several times as stiff across.
    {.name = "strip_pulled_hard",
     .size = {1, 0.02},
     .cells = {80, 4},
     .along = "200*t",
     .body = "0.05*t",
     .least = 0.4},
    {.name = "clamped_sheet",
     .size = {1, 0.02},
     .cells = {80, 4},
     .body = "120*t",
     .clamped_ends = true,
     .least = 0.08,
     .plane = SolidParameters::Plane::stress},
    {.name = "compressed_sheet",
     .along = "-800*t",
     .across = "30*t",
     .least = 0.3,
     .plane = SolidParameters::Plane::stress}};

SolidParameters parameters(const Pair& pair) {
  SolidParameters p = box_parameters(2);
  p.material = {1000, 1e6, pair.nu};
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] =
      pair.clamped_ends ? p.boundaries["xmin"] : boundary(Type::traction, {pair.along, pair.across});
  p.body_force = {{"0"}, {pair.body}};
  p.method.face_gradient = pair.gradient;
  p.plane = pair.plane;
  return p;
}

RawMesh mesh_of(const Pair& pair) {
  return make_box(BoxCells::quadrilaterals, {pair.cells[0], pair.cells[1], 1}, Vec3::Zero(),
                  Vec3(pair.size[0], pair.size[1], 0));
}

/// Root mean square over all cells of b - a, over that of a, or of the component above a tenth of a that changes more.
double change_of(const Solid& a, const Solid& b) {
  const Mesh& mesh = a.body().mesh();
  const Geometry& geometry = a.body().geometry();
  const auto &u = a.stepper().state().cell_u, &v = b.stepper().state().cell_u;
  std::array<double, 3> difference{}, size{};
  const auto dim = std::size_t(mesh.dim);
  for (std::size_t i = 0; i < std::size_t(mesh.cells.n_owned()) * dim; ++i) {
    difference.at(i % dim) += geometry.volume[i / dim] * (v[i] - u[i]) * (v[i] - u[i]);
    size.at(i % dim) += geometry.volume[i / dim] * u[i] * u[i];
  }
  double largest = std::sqrt((difference[0] + difference[1] + difference[2]) / (size[0] + size[1] + size[2]));
  for (std::size_t k = 0; k < dim; ++k)
    if (size.at(k) > 0.01 * (size[0] + size[1] + size[2]))
      largest = std::max(largest, std::sqrt(difference.at(k) / size.at(k)));
  return largest;
}

/// The change of the accepted displacement by large strain; 0 if it cannot matter.
LargeStrainEstimate estimate_of(const Solid& solid) {
  double seen = 0;
  return estimate_large_strain(solid.body(), *solid.stepper().method(), solid.stepper().last_solve().unknowns,
                               solid.stepper().state().known, seen)
      .value_or(LargeStrainEstimate{});
}

class LargeStrainPair : public ::testing::TestWithParam<Pair> {};

TEST_P(LargeStrainPair, is_estimated_within_a_factor_of_1_5_of_the_true_difference) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "one rank; ranks_agree holds the others to it";
  SolidParameters p = parameters(GetParam());
  const auto linear = stepped(mesh_of(GetParam()), p);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.method.face_gradient = FaceGradient::automatic;
  if (p.material.poissons_ratio > 0.4) p.material.law = "nearly-incompressible-neo-hookean";
  const auto large = make_solid(mesh_of(GetParam()), p);
  for (int i = 0; i < 4; ++i) step(*large, 0.25);
  const double told = estimate_of(*linear).change, found = change_of(*linear, *large);
  RecordProperty("told", fmt::format("{:.4f}", told));
  RecordProperty("found", fmt::format("{:.4f}", found));
  EXPECT_GT(found, GetParam().least);
  EXPECT_LT(told, 1.5 * found);
  EXPECT_GT(told, found / 1.5);
}

INSTANTIATE_TEST_SUITE_P(All, LargeStrainPair, ::testing::ValuesIn(pairs),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(LargeStrainEstimate, vanishes_with_the_load) {
  Pair pair = pairs[0];
  pair.across = "0.9*t";
  SolidParameters p = parameters(pair);
  const auto solid = stepped(mesh_of(pair), p);
  EXPECT_EQ(estimate_of(*solid).change, 0) << "its bound is below 2 %, so nothing is solved";
}

TEST(LargeStrainEstimate, ranks_agree) {
  Pair pair = pairs[0];
  pair.cells = {12, 2};
  SolidParameters p = parameters(pair);
  Solid whole(distribute(MPI_COMM_SELF, mesh_of(pair)), p, SolidContext{}),
      parts(distribute(MPI_COMM_WORLD, mesh_of(pair)), p, SolidContext{});
  step(whole, 1);
  step(parts, 1);
  const LargeStrainEstimate a = estimate_of(whole), b = estimate_of(parts);
  EXPECT_GT(a.change, 0.1);
  EXPECT_NEAR(b.change, a.change, 1e-6 * a.change);
}

// A column under four times Euler's load: linear theory bends it a little, it would buckle.
TEST(LargeStrainEstimate, does_not_call_a_column_beyond_its_load_harmless) {
  Pair pair = pairs[3];
  pair.along = "-9000*t";
  SolidParameters p = parameters(pair);
  const auto solid = stepped(mesh_of(pair), p);
  const LargeStrainEstimate told = estimate_of(*solid);
  EXPECT_TRUE(!told.is_known() || told.change > 1) << told.text();
}

// The verdict and the estimate are one number: a beam held at both ends stretches by 8 % of its deflection and more at a
// gradient of 0.02, which alone looks harmless.
TEST(LargeStrainEstimate, is_the_share_that_the_verdict_on_small_strain_tells) {
  for (const bool matters : {false, true}) {
    Pair pair = pairs[2];
    if (!matters) pair.body = "6*t";
    const SolidParameters p = parameters(pair);
    const auto solid = make_solid(mesh_of(pair), p);
    const diagnostics::Finding found = support::observe(*solid, 1, 1).finding("geometric-non-linearity");
    EXPECT_EQ(found.severity > base::Severity::note, matters) << found.sentence;
    EXPECT_EQ(found.share > 0.05, matters) << found.share;
    if (matters) EXPECT_EQ(found.share, estimate_of(*solid).change);
  }
}

}  // namespace couplet::testing::large_strain_estimate_test
