// SPDX-License-Identifier: Apache-2.0
// Manufactured solution u_i = a_i 1e-6 sin(4 pi x) sin(2 pi y) sin(pi z), a = (2, 4, 6), on a cube of 0.2 m
// (the 3-D case of the solids4foam verification suite); in 2-D without the third component and factor.
#include "solid_solver/analysis/displacement_error.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::order_test {
using namespace mesh;

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
std::vector<std::string> body_force_text(int dim, const elastic::LameConstants& lame) {
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

/// sigma n on the side whose normal is x.
std::vector<std::string> traction_text(int dim, const elastic::LameConstants& lame) {
  const auto slope = [&](int component, int axis) {
    std::array<int, 3> once{};
    once[axis] = 1;
    return fmt::format("{:.17g}*{}", amplitude[component], derivative_text(dim, once));
  };
  std::vector<std::string> result;
  for (int i = 0; i < dim; ++i) {
    std::string text = fmt::format("{:.17g}*({} + {})", lame.mu, slope(0, i), slope(i, 0));
    for (int j = 0; i == 0 && j < dim; ++j) text += fmt::format(" + {:.17g}*{}", lame.lambda, slope(j, j));
    result.push_back(text);
  }
  return result;
}

struct Errors {
  double displacement, stress, inner_stress, recovered;
  double estimated = 0;  // displacement_error(), of the symmetric gradient
};

/// d u_a / d x_d of the exact displacement, entry (d, a).
Tensor3 exact_slope(int dim, const Vec3& x) {
  Tensor3 slope = Tensor3::Zero();
  for (int along = 0; along < dim; ++along) {
    double value = 1;
    for (int d = 0; d < dim; ++d)
      value *= d == along ? wave[d] * std::cos(wave[d] * x[d]) : std::sin(wave[d] * x[d]);
    for (int a = 0; a < dim; ++a) slope(along, a) = amplitude[a] * value;
  }
  return slope;
}

/// Root of the mean square over the points, of point_stress(), over that of the exact stress.
double error_at_points(const Solid& solid) {
  const Mesh& mesh = solid.body().mesh();
  const Geometry& geometry = solid.body().geometry();
  const std::vector<double> found = solid.fields().point_stress(solid.fields().point_displacement());
  double error = 0, size = 0;
  for (Index v = 0; v < mesh.points.n_owned(); ++v) {
    const Tensor3 exact = solid.body().elastic().stress(0, exact_slope(mesh.dim, geometry.points[v]));
    const Tensor3 here = unpack({found.data() + std::size_t(v) * tensor_size, tensor_size});
    error += (here - exact).topLeftCorner(mesh.dim, mesh.dim).squaredNorm();
    size += exact.topLeftCorner(mesh.dim, mesh.dim).squaredNorm();
  }
  return std::sqrt(error / size);
}

/// Volume-weighted L2 errors over L2 norms of the exact solution; the inner stress over the cells whose
/// centre is further than an eighth of the cube's side from its sides. `perturbed`: by this part of the
/// spacing, at random.
Errors solve(BoxCells cells, int n, double perturbed, FaceGradient gradient, bool pulled = false) {
  const int dim = dimension_of(cells);
  SolidParameters p = box_parameters(dim);
  p.method.face_gradient = gradient;
  for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, displacement_text(dim));
  if (pulled) p.boundaries["xmax"] = boundary(Type::traction, traction_text(dim, lame_constants(p)));
  for (const std::string& text : body_force_text(dim, lame_constants(p))) p.body_force.push_back({text});
  RawMesh raw = make_box(cells, {n, n, n}, Vec3::Zero(), Vec3(0.2, 0.2, dim == 3 ? 0.2 : 0));
  if (perturbed > 0) perturb_interior(raw, perturbed, 3);
  const auto solid = stepped(raw, p);

  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  const auto stress = solid->fields().cell_stress(solid->fields().point_displacement());
  double error = 0, size = 0, stress_error = 0, stress_size = 0, inner_error = 0, inner_size = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const Vec3& x = geometry.cell_centre[c];
    double product = 1;
    for (int d = 0; d < dim; ++d) product *= std::sin(wave[d] * x[d]);
    for (int a = 0; a < dim; ++a) {
      const double exact = amplitude[a] * product;
      error +=
          geometry.volume[c] * std::pow(solid->stepper().state().cell_u[std::size_t(c) * dim + a] - exact, 2);
      size += geometry.volume[c] * exact * exact;
    }
    const Tensor3 slope = exact_slope(dim, x);
    const Tensor3 exact = solid->body().elastic().stress(0, slope);
    const double here = geometry.volume[c] * (stress[c] - exact).topLeftCorner(dim, dim).squaredNorm();
    const double there = geometry.volume[c] * exact.topLeftCorner(dim, dim).squaredNorm();
    stress_error += here;
    stress_size += there;
    if ((x - Vec3(0.1, 0.1, dim == 3 ? 0.1 : 0)).cwiseAbs().maxCoeff() > 0.075) continue;
    inner_error += here;
    inner_size += there;
  }
  Errors found{std::sqrt(error / size), std::sqrt(stress_error / stress_size),
               std::sqrt(inner_error / inner_size), error_at_points(*solid)};
  if (gradient == FaceGradient::symmetric)
    found.estimated = displacement_error(solid->body(), solid->stepper().state(), solid->fields().loads_now(),
                                         *solid->stepper().method());
  return found;
}

Errors slope(const Errors& coarse, const Errors& fine, double refinement) {
  return {std::log(coarse.displacement / fine.displacement) / std::log(refinement),
          std::log(coarse.stress / fine.stress) / std::log(refinement),
          std::log(coarse.inner_stress / fine.inner_stress) / std::log(refinement),
          std::log(coarse.recovered / fine.recovered) / std::log(refinement)};
}

struct Meshes {
  const char* name;
  BoxCells cells;
  std::vector<int> sizes;  // cells along a side
  double perturbed = 0;    // part of the spacing
  double least_stress_slope = 0.95;
};

/// For the gradient of the source, whose blocks take long on many cells in space.
const std::vector<Meshes> coarser_meshes{
    {"hexahedra", BoxCells::hexahedra, {5, 10}},
    {"tetrahedra", BoxCells::tetrahedra, {4, 8}},
    {"prisms", BoxCells::prisms, {5, 10}},
    {"mixed", BoxCells::mixed, {6, 12}},
    {"quadrilaterals", BoxCells::quadrilaterals, {10, 20, 40, 80}, 0, 1.4},
    {"triangles", BoxCells::triangles, {10, 20, 40}},
    {"perturbed_quadrilaterals", BoxCells::quadrilaterals, {20, 40, 80}, 0.2},
    {"perturbed_triangles", BoxCells::triangles, {10, 20, 40}, 0.2},
};

/// The symmetric gradient's slopes settle one refinement later.
const std::vector<Meshes> finer_meshes{
    {"hexahedra", BoxCells::hexahedra, {10, 20}},
    {"tetrahedra", BoxCells::tetrahedra, {8, 16}},
    {"prisms", BoxCells::prisms, {14, 28}},
    {"mixed", BoxCells::mixed, {12, 24}},
    {"quadrilaterals", BoxCells::quadrilaterals, {40, 80}},
    {"triangles", BoxCells::triangles, {40, 80}},
    {"perturbed_hexahedra", BoxCells::hexahedra, {12, 24}, 0.2},
    {"perturbed_tetrahedra", BoxCells::tetrahedra, {8, 16}, 0.2},
    {"perturbed_prisms", BoxCells::prisms, {14, 28}, 0.2},
    {"perturbed_mixed", BoxCells::mixed, {12, 24}, 0.2},
    {"perturbed_quadrilaterals", BoxCells::quadrilaterals, {40, 80}, 0.2},
    {"perturbed_triangles", BoxCells::triangles, {40, 80}, 0.2},
};

using Study = std::tuple<Meshes, FaceGradient>;
class SolidOrder : public ::testing::TestWithParam<Study> {};

std::string name_of(const ::testing::TestParamInfo<Study>& info) {
  const auto& [meshes, gradient] = info.param;
  const char* name = gradient == FaceGradient::thesis ? "thesis" : "symmetric";
  return fmt::format("{}_{}", meshes.name, name);
}

INSTANTIATE_TEST_SUITE_P(All, SolidOrder,
                         ::testing::Combine(::testing::ValuesIn(coarser_meshes),
                                            ::testing::Values(FaceGradient::thesis)),
                         name_of);
INSTANTIATE_TEST_SUITE_P(OnAnEnergy, SolidOrder,
                         ::testing::Combine(::testing::ValuesIn(finer_meshes),
                                            ::testing::Values(FaceGradient::symmetric)),
                         name_of);

/// Prints what was measured and judges the slope of the last refinement.
TEST_P(SolidOrder, displacement_and_stress_converge) {
  const auto& [meshes, gradient] = GetParam();
  std::vector<Errors> errors;
  Errors last{};
  for (std::size_t i = 0; i < meshes.sizes.size(); ++i) {
    errors.push_back(solve(meshes.cells, meshes.sizes[i], meshes.perturbed, gradient));
    fmt::print("{} {}: displacement {:.3e}, stress {:.3e}, inner stress {:.3e}, at points {:.3e}",
               meshes.name, meshes.sizes[i], errors[i].displacement, errors[i].stress, errors[i].inner_stress,
               errors[i].recovered);
    if (i > 0) {
      last = slope(errors[i - 1], errors[i], double(meshes.sizes[i]) / meshes.sizes[i - 1]);
      fmt::print(", slopes {:.2f} {:.2f} {:.2f} {:.2f}", last.displacement, last.stress, last.inner_stress,
                 last.recovered);
    }
    fmt::print("\n");
  }
  RecordProperty("displacement_slope", fmt::format("{:.4f}", last.displacement));
  RecordProperty("stress_slope", fmt::format("{:.4f}", last.stress));
  RecordProperty("inner_stress_slope", fmt::format("{:.4f}", last.inner_stress));
  RecordProperty("displacement_error", fmt::format("{:.4e}", errors.back().displacement));
  RecordProperty("stress_error", fmt::format("{:.4e}", errors.back().stress));
  EXPECT_GE(last.displacement, 1.9);
  EXPECT_GE(last.stress, meshes.least_stress_slope);
  RecordProperty("recovered_stress_slope", fmt::format("{:.4f}", last.recovered));
  if (gradient == FaceGradient::symmetric) {
    EXPECT_GE(last.recovered, 1.3);  // cells at the fixed rim are of first order
  }
}

/// The estimate from one run beside the true error, with all sides given, and with a traction on one of them.
TEST(SolidError, of_a_smooth_field_is_estimated_on_all_cells_without_drift) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed,
                               BoxCells::quadrilaterals, BoxCells::triangles})
    for (const bool pulled : {false, true}) {
      std::vector<double> ratios;
      for (const int n : dimension_of(cells) == 3 ? std::vector{4, 6, 9} : std::vector{8, 16, 32}) {
        const Errors found = solve(cells, n, 0, FaceGradient::symmetric, pulled);
        ratios.push_back(found.estimated / found.displacement);
        fmt::print("{} {}{}: estimated {:.3g}, true {:.3g}, ratio {:.2f}\n", name(cells), n,
                   pulled ? ", pulled" : "", found.estimated, found.displacement, ratios.back());
        EXPECT_GT(ratios.back(), 0.5);
        EXPECT_LT(ratios.back(), 3);
      }
      EXPECT_GT(ratios[2] / ratios[1], 0.7) << name(cells);
      EXPECT_LT(ratios[2] / ratios[1], 1.4) << name(cells);
    }
}

}  // namespace couplet::testing::order_test
