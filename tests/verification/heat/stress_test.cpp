// SPDX-License-Identifier: Apache-2.0
// Thermal stress against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "common/parallel/collective.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/heat/thermoelastic.hpp"

namespace couplet::testing::stress_test {
using namespace mesh;
namespace {

constexpr double modulus = 200e9, nu = 0.3, alpha = 1.2e-5;

/// A slab that cools by its slowest mode (Bi = 1), free to shrink along x: what the steps of the conduction leave in its displacement.
struct Shrunk {
  double end = 0;  ///< displacement of x = 1 [m]
  diagnostics::ErrorParts parts;
};

Shrunk shrunk(int cells, int steps, const char* pull, bool again = false) {
  SolidParameters p = box_parameters(2);
  p.expansion = ThermalExpansion{300};
  p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
  p.material.heat.conductivity = p.material.heat.specific_heat = config::ExpressionText{"1"};
  p.material.density = 1;
  for (const char* name : {"xmin", "ymin"}) p.boundaries[name] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {pull, "0"});
  p.heat.emplace();
  p.heat->scheme = HeatParameters::Scheme::euler;
  p.heat->initial_temperature = {"300 + 100*cos(0.8603335890193797*x)"};
  HeatBoundary& air = p.heat->boundaries["xmax"];
  air.type = HeatBoundary::Type::convection, air.coefficient = {"1"}, air.ambient = {"300"};
  const LoadedMesh body = distribute(
      MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {cells, 2, 1}, Vec3::Zero(), Vec3(1, 0.5, 0)));
  auto solid = std::make_unique<Solid>(body, p, SolidContext{});
  solid->collect_errors();
  for (int i = 0; i < steps; ++i) {
    step(*solid, 0.5 / steps);
    if (!again) continue;
    auto next = std::make_unique<Solid>(body, p, SolidContext{});
    next->collect_errors();
    support::SavedState(*solid).load_into(*next);
    solid = std::move(next);
  }
  const std::vector<double> u = solid->fields().point_displacement();
  Shrunk found{0, solid->error_parts()};
  for (std::size_t i = 0; i < u.size(); i += 2)
    if (std::abs(body.geometry.points[i / 2].x() - 1) < 1e-9) found.end = u[i];
  return found;
}

TEST(HeatInASolid, the_step_of_the_conduction_is_told_within_a_factor_of_two) {
  const double fine = shrunk(32, 640, "0").end;
  for (const int steps : {5, 10, 20}) {
    const Shrunk found = shrunk(32, steps, "0");
    const double wrong = std::abs(found.end / fine - 1);
    fmt::print("{} steps: estimated {:.3g}, true {:.3g}\n", steps, found.parts.step, wrong);
    EXPECT_GT(found.parts.step, wrong / 2) << steps;
    EXPECT_LT(found.parts.step, wrong * 2) << steps;
    EXPECT_GT(found.parts.step, found.parts.mesh) << steps;
  }
}

TEST(HeatInASolid, counts_by_the_share_of_what_it_moves_and_over_a_restart) {
  const diagnostics::ErrorParts free = shrunk(8, 8, "0").parts, again = shrunk(8, 8, "0", true).parts,
                                pulled = shrunk(8, 8, "1e10").parts;
  EXPECT_EQ(free.step, again.step);
  EXPECT_EQ(free.mesh, again.mesh);
  EXPECT_LT(pulled.step, 0.1 * free.step) << "nearly all of the displacement is that of the load";
}

// A cylinder 1 m < r < 1.5 m between two rigid planes across its axis, T - T_ref = 100 ln(b / r) / ln(b / a)
// (Timoshenko and Goodier, Theory of Elasticity, art. 151): with C = E alpha 100 / (2 (1 - nu) ln(b / a)),
//   sigma_r = C [- ln(b / r) - a^2 / (b^2 - a^2) (1 - b^2 / r^2) ln(b / a)]
//   sigma_t = C [1 - ln(b / r) - a^2 / (b^2 - a^2) (1 + b^2 / r^2) ln(b / a)],  sigma_z = nu (s_r + s_t) - E
//   alpha T
struct HollowCylinder {
  double a = 1, b = 1.5, hot = 100;
  double temperature(double r) const { return hot * std::log(b / r) / std::log(b / a); }
  Vec3 stress(double r) const {
    const double l = std::log(b / a), c = modulus * alpha * hot / (2 * (1 - nu) * l);
    const double g = a * a / (b * b - a * a) * l;
    const double radial = c * (-std::log(b / r) - g * (1 - b * b / (r * r)));
    const double hoop = c * (1 - std::log(b / r) - g * (1 + b * b / (r * r)));
    return {radial, hoop, nu * (radial + hoop) - modulus * alpha * temperature(r)};
  }
  /// Radial displacement: r (strain along the circumference).
  double displacement(double r) const {
    const Vec3 s = stress(r);
    return r * ((s[1] - nu * (s[0] + s[2])) / modulus + alpha * temperature(r));
  }
};

/// A thin wedge of the cylinder, one cell wide, between two symmetry planes: n cells through the wall.
RawMesh wedge(int n, double angle, const HollowCylinder& c) {
  RawMesh raw = make_box(BoxCells::hexahedra, {n, 1, 2}, Vec3(c.a, -0.5, 0), Vec3(c.b, 0.5, 0.2));
  for (Vec3& p : raw.points) {
    const double r = p[0], turn = p[1] * angle;
    // The chord's middle lies on the circle: equal up to angle^2 everywhere.
    p[0] = r * std::cos(turn);
    p[1] = r * std::sin(turn);
  }
  return raw;
}

struct Errors {
  double displacement = 0, stress = 0;
};

Errors wedge_errors(int n, bool solve_for_temperature) {
  const HollowCylinder cylinder;
  SolidParameters p = box_parameters(3);
  p.expansion = ThermalExpansion{300};
  p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
  for (const char* name : {"ymin", "ymax", "zmin", "zmax"}) p.boundaries[name] = boundary(Type::symmetry);
  if (solve_for_temperature) {
    p.heat.emplace();
    p.heat->analysis = HeatParameters::Analysis::steady;
    p.material.heat.conductivity = config::ExpressionText{"50"};
    for (const auto& [name, value] : {std::pair{"xmin", "400"}, std::pair{"xmax", "300"}}) {
      p.heat->boundaries[name].type = HeatBoundary::Type::temperature;
      p.heat->boundaries[name].value = {value};
    }
  } else {
    p.temperature = config::ExpressionText{"300 + 100*ln(1.5/sqrt(x^2 + y^2))/ln(1.5)"};
  }
  const auto solid = make_solid(wedge(n, 0.002, cylinder), p);
  step(*solid, 1);
  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  const auto stress = solid->fields().cell_stress(solid->fields().point_displacement());
  double error = 0, size = 0, stress_error = 0, stress_size = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double r = geometry.cell_centre[c].head<2>().norm(), v = geometry.volume[c];
    const double u = cylinder.displacement(r);
    error += v * std::pow(solid->stepper().state().cell_u[3 * std::size_t(c)] - u, 2);
    size += v * u * u;
    const Vec3 exact = cylinder.stress(r);
    stress_error += v * (stress[c].diagonal() - exact).squaredNorm();
    stress_size += v * exact.squaredNorm();
  }
  return {std::sqrt(error / size), std::sqrt(stress_error / stress_size)};
}

class Wedge : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(HollowCylinder, Wedge, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "solved" : "prescribed"; });

TEST_P(Wedge, thermal_stress_of_a_cylinder_converges_to_the_closed_form) {
  const Errors coarse = wedge_errors(20, GetParam()), fine = wedge_errors(40, GetParam());
  const double u = std::log2(coarse.displacement / fine.displacement);
  const double s = std::log2(coarse.stress / fine.stress);
  fmt::print("displacement {:.3e} {:.3e} slope {:.2f}, stress {:.3e} {:.3e} slope {:.2f}\n",
             coarse.displacement, fine.displacement, u, coarse.stress, fine.stress, s);
  RecordProperty("displacement_slope", fmt::format("{:.4f}", u));
  RecordProperty("stress_slope", fmt::format("{:.4f}", s));
  RecordProperty("stress_error", fmt::format("{:.3e}", fine.stress));
  EXPECT_GE(u, 1.9);
  EXPECT_GE(s, 0.95);
  EXPECT_LT(fine.stress, 0.02);
}

// A linear temperature bends a free body without stress: u = alpha [(g . x) x - g |x|^2 / 2]. An operator
// that is exact for linear displacements reaches that in second order.
double linear_temperature_stress(BoxCells cells, int n) {
  const int dim = dimension_of(cells);
  SolidParameters p = box_parameters(dim);
  if (dim == 2) p.plane = SolidParameters::Plane::stress;
  p.temperature = config::ExpressionText{"300 + 100*x + 50*y"};
  p.expansion = ThermalExpansion{300};
  p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
  const std::string turn = dim == 3 ? "(x^2 + y^2 + z^2)" : "(x^2 + y^2)";
  std::vector<std::string> u{fmt::format("1.2e-5*((100*x + 50*y)*x - 50*{})", turn),
                             fmt::format("1.2e-5*((100*x + 50*y)*y - 25*{})", turn)};
  if (dim == 3) u.emplace_back("1.2e-5*(100*x + 50*y)*z");
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, u);
  const auto solid = make_solid(make_box(cells, {n, n, n}, Vec3::Zero(), Vec3(1, 1, dim == 3 ? 1 : 0)), p);
  step(*solid, 1);
  const auto stress = solid->fields().cell_stress(solid->fields().point_displacement());
  double squares = 0;
  for (std::size_t c = 0; c < stress.size(); ++c)
    squares += solid->body().geometry().volume[c] * stress[c].squaredNorm();
  return std::sqrt(squares) / (modulus * alpha * 100);
}

TEST(LinearTemperature, leaves_a_free_body_without_stress_as_cells_shrink) {
  for (const auto& [cells, sizes] : {std::pair{BoxCells::quadrilaterals, std::pair{16, 32}},
                                     std::pair{BoxCells::hexahedra, std::pair{6, 12}}}) {
    const double coarse = linear_temperature_stress(cells, sizes.first);
    const double fine = linear_temperature_stress(cells, sizes.second);
    const double slope = std::log2(coarse / fine);
    fmt::print("linear temperature, cells {}: {:.3e} {:.3e}, slope {:.2f}\n", int(cells), coarse, fine,
               slope);
    RecordProperty(fmt::format("slope_{}", int(cells)), fmt::format("{:.4f}", slope));
    EXPECT_GE(slope, 1.3);
  }
}

}  // namespace
}  // namespace couplet::testing::stress_test
