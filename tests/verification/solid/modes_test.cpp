// SPDX-License-Identifier: Apache-2.0
// Free vibrations found by factors of the shifted stiffness or by multigrid: the lowest ones of the dense eigenproblem, none missed, with the
// shapes on the surface that plate_modal takes.
#include "common/modes/modal_checks.hpp"
#include "solid_solver/analysis/modal_analysis.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::modes_test {
using namespace mesh;
using namespace modes;

SolidParameters vibrating(int dim) {
  SolidParameters p = box_parameters(dim);
  p.method.face_gradient = FaceGradient::symmetric;
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {2000, 1e6, 0.3};
  return p;
}

std::vector<double> cell_mass(const Solid& solid) {
  std::vector<double> mass;
  for (Index c = 0; c < solid.body().mesh().cells.n_owned(); ++c)
    mass.push_back(solid.body().density(c) * solid.body().geometry().volume[c]);
  return mass;
}

class SolidModes : public ::testing::TestWithParam<BoxCells> {};

TEST_P(SolidModes, are_the_lowest_of_the_dense_problem_with_equal_ones) {
  const BoxCells cells = GetParam();
  const int dim = dimension_of(cells);
  SolidParameters p = vibrating(dim);
  p.boundaries["xmin"] = clamped(dim);
  const auto solid =
      make_solid(make_box(cells, {6, 2, dim == 3 ? 2 : 1}, Vec3::Zero(), Vec3(6, 1, dim == 3 ? 1 : 0)), p);
  std::vector<double> dense;
  for (const auto& value : eigenvalues(solid->body())) dense.push_back(value.real());
  std::ranges::sort(dense);
  constexpr int n = 8;
  const EigenModes found = solid_modes(*vibration(solid->body()), p.method, cell_mass(*solid), n);
  ASSERT_EQ(found.eigenvalue.size(), std::size_t(n));
  for (int m = 0; m < n && !dense.empty(); ++m)  // rank 0 has the dense ones
    EXPECT_NEAR(found.eigenvalue[m], dense[m], 1e-7 * dense[m]) << m;
  EXPECT_LT(found.worst_residual, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Solid, SolidModes,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms));

TEST(SolidModesOfAFreeBody, carry_its_whole_mass_and_move_its_surface_rigidly) {
  SolidParameters p = vibrating(3);
  const auto solid = make_solid(make_box(BoxCells::hexahedra, {4, 3, 3}, Vec3::Zero(), Vec3(2, 1, 1)), p);
  const EigenModes found = solid_modes(*vibration(solid->body()), p.method, cell_mass(*solid), 8);
  const ModalModel model = modal_model(*vibration(solid->body()), found);
  if (parallel::comm_rank(MPI_COMM_WORLD) != 0) return;
  ASSERT_EQ(model.n_modes(), 8u);
  EXPECT_EQ(problem_of(model), "");
  EXPECT_EQ(model.vertices.size(), 5u * 4u * 4u - 3u * 2u * 2u);  // less those inside
  EXPECT_EQ(model.faces.size(), 2 * (9 + 12 + 12));
  for (int m = 0; m < 6; ++m) EXPECT_EQ(model.frequency[m], 0) << m;
  EXPECT_GT(model.frequency[6], 0);
  for (int a = 0; a < 3; ++a) {
    double mass = 0;
    for (int m = 0; m < 6; ++m) mass += std::pow(model.participation[std::size_t(a) * 8 + m], 2);
    EXPECT_NEAR(mass, 4000, 1e-4) << a;
  }
  // Volume by the faces' outward turn: 2 m^3.
  double volume = 0;
  const std::vector<Vec3> areas = face_areas(model), centres = face_centres(model);
  for (std::size_t f = 0; f < areas.size(); ++f) volume += areas[f].dot(centres[f]) / 3;
  EXPECT_NEAR(volume, 2, 1e-12);
}

TEST(SolidModesByFactors, are_those_by_multigrid) {
  SolidParameters p = vibrating(3);
  const auto solid = make_solid(make_box(BoxCells::tetrahedra, {4, 2, 2}, Vec3::Zero(), Vec3(2, 1, 1)), p);
  const auto by = [&](MethodParameters::Preconditioner preconditioner) {
    MethodParameters method = p.method;
    method.preconditioner = preconditioner;
    return solid_modes(*vibration(solid->body()), method, cell_mass(*solid), 9);
  };
  const EigenModes factors = by(MethodParameters::Preconditioner::factors),
                   multigrid = by(MethodParameters::Preconditioner::multigrid);
  for (int m = 0; m < 6; ++m) EXPECT_EQ(factors.eigenvalue[m], 0) << m;
  for (int m = 6; m < 9; ++m)
    EXPECT_NEAR(factors.eigenvalue[m], multigrid.eigenvalue[m], 1e-7 * multigrid.eigenvalue[m]) << m;
}

TEST(SolidModesOfABeam, are_those_of_euler_and_bernoulli_and_converge_at_second_order) {
  // Plane stress, 20 : 1, E and rho of vibrating(); f_1 = 3.5160/(2 pi L^2) sqrt(E h^2/(12 rho)), less 0.3 % of shear.
  SolidParameters p = vibrating(2);
  p.plane = SolidParameters::Plane::stress;
  p.boundaries["xmin"] = clamped(2);
  const auto first = [&](int n) {
    const auto solid =
        make_solid(make_box(BoxCells::quadrilaterals, {10 * n, n, 1}, Vec3::Zero(), Vec3(20, 1, 0)), p);
    const EigenModes found = solid_modes(*vibration(solid->body()), p.method, cell_mass(*solid), 1);
    return std::sqrt(found.eigenvalue[0]) / (2 * std::numbers::pi);
  };
  const double coarse = first(2), middle = first(4), fine = first(8);
  const double slender = 3.5160 / (2 * std::numbers::pi * 400) * std::sqrt(1e6 / (12 * 2000.0));
  const double limit = fine + (fine - middle) / 3;
  EXPECT_NEAR(limit, slender, 0.006 * slender);
  const double slope = std::log2((coarse - middle) / (middle - fine));
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, 1.7);
}

/// A free prism, 8 : 1. The right frequencies are those of converged finite elements of second order; its bending comes in pairs.
TEST(SolidModesOfAPrism, err_by_no_more_than_what_is_told) {
  SolidParameters p = vibrating(3);
  p.material = {7800, 205e9, 0.29};
  const std::vector<double> right{781.8,  781.8,  1832.3, 1986.7, 1986.7,
                                  3200.6, 3540.7, 3540.7, 3664.3, 5290.8};
  for (const int across : {2, 4}) {
    const auto solid = make_solid(
        make_box(BoxCells::hexahedra, {5 * across, across, across}, Vec3::Zero(), Vec3(0.8, 0.1, 0.1)), p);
    const EigenModes found = solid_modes(*vibration(solid->body()), p.method, cell_mass(*solid), 16);
    double largest = 0, told = 0;
    for (std::size_t m = 6; m < 16; ++m) {
      const double error =
          std::abs(std::sqrt(found.eigenvalue[m]) / (2 * std::numbers::pi * right[m - 6]) - 1);
      const EigenModes one{.eigenvalue = {found.eigenvalue[m]}, .shape = {found.shape[m]}};
      const double bound = mode_errors(solid->body(), one).front();
      EXPECT_LT(error, bound) << m;
      largest = std::max(largest, error), told = std::max(told, bound);
    }
    RecordProperty(fmt::format("error_{}", across), fmt::format("{:.3e}", largest));
    RecordProperty(fmt::format("told_{}", across), fmt::format("{:.3e}", told));
    EXPECT_LT(told, 3 * largest);
  }
}

TEST(SolidModesOfABeam, are_refused_without_a_mass_of_the_kernel) {
  SolidParameters p = vibrating(2);
  p.method.face_gradient = FaceGradient::thesis;
  const auto solid =
      make_solid(make_box(BoxCells::quadrilaterals, {4, 2, 1}, Vec3::Zero(), Vec3(2, 1, 0)), p);
  EXPECT_FALSE(vibration(solid->body()));
}

}  // namespace couplet::testing::modes_test
