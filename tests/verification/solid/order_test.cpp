// SPDX-License-Identifier: Apache-2.0
// Manufactured solution u_i = a_i 1e-6 sin(4 pi x) sin(2 pi y) sin(pi z), a = (2, 4, 6), on a cube of 0.2 m
// (the 3-D case of the solids4foam verification suite); in 2-D without the third component and factor.
#include <gtest/gtest.h>

#include <cmath>

#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {
namespace {

constexpr std::array<double, 3> amplitude{2e-6, 4e-6, 6e-6};
constexpr std::array<double, 3> wave{4 * M_PI, 2 * M_PI, M_PI};

/// amplitude * d^n/dx^n ... of the product of sines, as text: `derivatives[d]` times along axis d.
std::string derivative_text(int dim, const std::array<int, 3>& derivatives) {
  const char* axis = "xyz";
  double factor = 1;
  std::string text;
  for (int d = 0; d < dim; ++d) {
    factor *= std::pow(wave[d], derivatives[d]) * (derivatives[d] == 2 ? -1 : 1);
    text += fmt::format("*{}({:.17g}*{})", derivatives[d] == 1 ? "cos" : "sin", wave[d], axis[d]);
  }
  return fmt::format("({:.17g}){}", factor, text);
}

/// - div sigma = - mu lap u - (mu + lambda) grad div u.
std::vector<std::string> body_force_text(int dim, const LameConstants& lame) {
  std::vector<std::string> result;
  for (int i = 0; i < dim; ++i) {
    std::string text = "0";
    for (int j = 0; j < dim; ++j) {
      std::array<int, 3> twice{}, mixed{};
      twice[j] += 2;
      mixed[i] += 1;
      mixed[j] += 1;
      text += fmt::format(" - {:.17g}*{} - {:.17g}*{}", lame.mu * amplitude[i], derivative_text(dim, twice),
                          (lame.mu + lame.lambda) * amplitude[j], derivative_text(dim, mixed));
    }
    result.push_back(text);
  }
  return result;
}

std::vector<std::string> displacement_text(int dim) {
  std::vector<std::string> result;
  for (int i = 0; i < dim; ++i)
    result.push_back(fmt::format("{:.17g}*{}", amplitude[i], derivative_text(dim, {})));
  return result;
}

struct Errors {
  double displacement, stress;
};

/// Volume-weighted L2 errors over L2 norms of the exact solution.
Errors solve(BoxCells cells, int n) {
  const int dim = dimension_of(cells);
  SolidParameters p = box_parameters(dim);
  for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, displacement_text(dim));
  for (const std::string& text : body_force_text(dim, lame_constants(p))) p.body_force.push_back({text});
  const auto solid =
      make_solid(make_box(cells, {n, n, n}, Vec3::Zero(), Vec3(0.2, 0.2, dim == 3 ? 0.2 : 0)), p);
  step(*solid, 1);

  const Mesh& mesh = solid->mesh();
  const auto stress = solid->cell_stress(solid->point_displacement());
  double error = 0, size = 0, stress_error = 0, stress_size = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const Vec3& x = mesh.reference.cell_centre[c];
    const auto product = [&](int along) {
      double value = 1;
      for (int d = 0; d < dim; ++d)
        value *= d == along ? wave[d] * std::cos(wave[d] * x[d]) : std::sin(wave[d] * x[d]);
      return value;
    };
    Tensor3 slope = Tensor3::Zero();
    for (int a = 0; a < dim; ++a) {
      const double exact = amplitude[a] * product(-1);
      error +=
          mesh.reference.volume[c] * std::pow(solid->state().cell_u[std::size_t(c) * dim + a] - exact, 2);
      size += mesh.reference.volume[c] * exact * exact;
      for (int d = 0; d < dim; ++d) slope(d, a) = amplitude[a] * product(d);
    }
    const Tensor3 exact = solid->elastic().stress(slope);
    stress_error += mesh.reference.volume[c] * (stress[c] - exact).topLeftCorner(dim, dim).squaredNorm();
    stress_size += mesh.reference.volume[c] * exact.topLeftCorner(dim, dim).squaredNorm();
  }
  return {std::sqrt(error / size), std::sqrt(stress_error / stress_size)};
}

Errors slope(const Errors& coarse, const Errors& fine, double refinement) {
  return {std::log(coarse.displacement / fine.displacement) / std::log(refinement),
          std::log(coarse.stress / fine.stress) / std::log(refinement)};
}

/// Prints what was measured and gives the slope of the last refinement.
Errors measured_slope(BoxCells cells, const char* name, const std::vector<int>& sizes) {
  std::vector<Errors> errors;
  Errors last{};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    errors.push_back(solve(cells, sizes[i]));
    fmt::print("{} {}: displacement {:.3e}, stress {:.3e}", name, sizes[i], errors[i].displacement,
               errors[i].stress);
    if (i > 0) {
      last = slope(errors[i - 1], errors[i], double(sizes[i]) / sizes[i - 1]);
      fmt::print(", slopes {:.2f} {:.2f}", last.displacement, last.stress);
    }
    fmt::print("\n");
  }
  ::testing::Test::RecordProperty("displacement_slope", fmt::format("{:.4f}", last.displacement));
  ::testing::Test::RecordProperty("stress_slope", fmt::format("{:.4f}", last.stress));
  return last;
}

TEST(SolidOrder, displacement_is_second_order_on_hexahedra) {
  const Errors s = measured_slope(BoxCells::hexahedra, "hexahedra", {5, 10, 20});
  EXPECT_GE(s.displacement, 1.9);
  EXPECT_GE(s.stress, 1.4);
}

TEST(SolidOrder, displacement_is_second_order_on_quadrilaterals) {
  const Errors s = measured_slope(BoxCells::quadrilaterals, "quadrilaterals", {10, 20, 40, 80});
  EXPECT_GE(s.displacement, 1.9);
  EXPECT_GE(s.stress, 1.4);
}

TEST(SolidOrder, displacement_is_second_order_on_triangles) {
  const Errors s = measured_slope(BoxCells::triangles, "triangles", {10, 20, 40});
  EXPECT_GE(s.displacement, 1.8);
  EXPECT_GE(s.stress, 0.9);
}

TEST(SolidOrder, displacement_is_second_order_on_tetrahedra) {
  const Errors s = measured_slope(BoxCells::tetrahedra, "tetrahedra", {4, 8});
  EXPECT_GE(s.displacement, 1.7);
}

}  // namespace
}  // namespace couplet::testing
