// SPDX-License-Identifier: Apache-2.0
// Orders of accuracy of conduction in space and time.
#include "tests/verification/heat/support.hpp"

namespace couplet::testing::order_test {
using namespace mesh;

double slope_of(double coarse, double fine, double ratio) {
  return std::log(coarse / fine) / std::log(ratio);
}

// T = 300 + sin(2 x + 0.3) cos(3 y) (1 + z^2 / 2) on the unit cube, k = 2: temperatures on x and z sides,
// flux and convection on y sides.
const char* shape = "sin(2*x + 0.3)*cos(3*y)*(1 + z^2/2)";
double exact(const Vec3& x) {
  return 300 + std::sin(2 * x[0] + 0.3) * std::cos(3 * x[1]) * (1 + x[2] * x[2] / 2);
}

double steady_error(BoxCells cells, int n, double perturbation) {
  const int dim = dimension_of(cells);
  HeatParameters p = steady();
  const std::string field = fmt::format("300 + {}", shape);
  for (const std::string& name : box_patches(dim))
    p.boundaries[name] = heat_boundary(HeatType::temperature, field);
  const std::string across = "3*sin(2*x + 0.3)*sin(3*y)*(1 + z^2/2)";  // - dT/dy
  p.boundaries["ymin"] = heat_boundary(HeatType::flux, fmt::format("2*{}", across));
  p.boundaries["ymax"] = convection("5", fmt::format("{} - 2*{}/5", field, across));
  p.source = {fmt::format("26*{} - 2*{}*sin(2*x + 0.3)*cos(3*y)", shape, dim == 3 ? 1 : 0)};
  RawMesh raw = make_box(cells, {n, n, n}, Vec3::Zero(), Vec3(1, 1, dim == 3 ? 1 : 0));
  if (perturbation > 0) perturb_interior(raw, perturbation, 7);
  HeatCase scene(raw, {{1000, 2.0, 500.0}}, p);
  scene.step(1);
  return scene.error(exact);
}

struct SpaceCase {
  const char* name;
  BoxCells cells;
  std::vector<int> sizes;
  double perturbation;
};

class OrderInSpace : public ::testing::TestWithParam<SpaceCase> {};
INSTANTIATE_TEST_SUITE_P(
    Heat, OrderInSpace,
    ::testing::Values(SpaceCase{"quadrilaterals", BoxCells::quadrilaterals, {10, 20, 40}, 0},
                      SpaceCase{"triangles", BoxCells::triangles, {10, 20, 40}, 0},
                      SpaceCase{"hexahedra", BoxCells::hexahedra, {6, 12, 24}, 0},
                      SpaceCase{"tetrahedra", BoxCells::tetrahedra, {6, 12, 18}, 0},
                      SpaceCase{"prisms", BoxCells::prisms, {5, 10, 20}, 0},
                      SpaceCase{"mixed", BoxCells::mixed, {4, 8, 16}, 0},
                      SpaceCase{"perturbed_quadrilaterals", BoxCells::quadrilaterals, {10, 20, 40}, 0.2},
                      SpaceCase{"perturbed_hexahedra", BoxCells::hexahedra, {6, 12, 24}, 0.2},
                      SpaceCase{"perturbed_tetrahedra", BoxCells::tetrahedra, {4, 8, 12}, 0.2}),
    [](const auto& info) { return info.param.name; });

TEST_P(OrderInSpace, of_a_steady_temperature_is_two) {
  std::vector<double> errors;
  for (const int n : GetParam().sizes)
    errors.push_back(steady_error(GetParam().cells, n, GetParam().perturbation));
  const std::size_t last = errors.size() - 1;
  const double slope =
      slope_of(errors[last - 1], errors[last], double(GetParam().sizes[last]) / GetParam().sizes[last - 1]);
  fmt::print("{}: {:.3e} {:.3e} {:.3e}, last slope {:.3f}\n", GetParam().name, errors[0], errors[1],
             errors[2], slope);
  RecordProperty("slope", fmt::format("{:.4f}", slope));
  EXPECT_GE(slope, 1.9);
}

// Linear in space, so that all of the error is made in time; boundary values, flux, convection and source all
// depend on time.
double transient_error(HeatScheme scheme, int n_steps, bool vary_steps) {
  HeatParameters p;
  p.scheme = scheme;
  const std::string g = "(2 + sin(3*t))", rate = "3*cos(3*t)", plane = "(10 + 2*x - y)";
  p.initial_temperature = {plane + "*2"};
  p.source = {fmt::format("4*{}*{}", plane, rate)};  // rho c = 4
  p.boundaries["xmin"] = heat_boundary(HeatType::temperature, plane + "*" + g);
  p.boundaries["xmax"] = heat_boundary(HeatType::flux, "0.5*2*" + g);
  p.boundaries["ymin"] = convection("2 + t", fmt::format("{0}*{1} + 0.5*{1}/(2 + t)", plane, g));
  p.boundaries["ymax"] = heat_boundary(HeatType::temperature, plane + "*" + g);
  RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  perturb_interior(raw, 0.2, 3);
  HeatCase scene(raw, {{2, 0.5, 2.0}}, p);
  const double mean = 1.0 / n_steps;
  for (int i = 0; i < n_steps; ++i) scene.step(mean * (vary_steps ? (i % 2 == 0 ? 0.7 : 1.3) : 1));
  return scene.error([](const Vec3& x) { return (10 + 2 * x[0] - x[1]) * (2 + std::sin(3.0)); });
}

struct TimeCase {
  const char* name;
  HeatScheme scheme;
  bool vary_steps;
  double wanted;
};

class OrderInTime : public ::testing::TestWithParam<TimeCase> {};
INSTANTIATE_TEST_SUITE_P(
    Heat, OrderInTime,
    ::testing::Values(TimeCase{"euler", HeatScheme::euler, false, 0.95},
                      TimeCase{"three_point", HeatScheme::three_point, false, 1.9},
                      TimeCase{"three_point_with_varying_steps", HeatScheme::three_point, true, 1.9},
                      TimeCase{"trapezoidal", HeatScheme::trapezoidal, false, 1.9},
                      TimeCase{"trapezoidal_with_varying_steps", HeatScheme::trapezoidal, true, 1.9}),
    [](const auto& info) { return info.param.name; });

TEST_P(OrderInTime, is_that_of_the_scheme) {
  const double coarse = transient_error(GetParam().scheme, 80, GetParam().vary_steps);
  const double fine = transient_error(GetParam().scheme, 160, GetParam().vary_steps);
  const double slope = slope_of(coarse, fine, 2);
  fmt::print("{}: {:.3e} {:.3e}, slope {:.3f}\n", GetParam().name, coarse, fine, slope);
  RecordProperty("slope", fmt::format("{:.4f}", slope));
  EXPECT_GE(slope, GetParam().wanted);
}

// k = 1 + (T - 300) / 100: with the Kirchhoff transform theta + theta^2 / 200 is linear in x.
TEST(OrderInSpaceOfVaryingConductivity, is_two) {
  const auto error = [](int n) {
    HeatParameters p = steady();
    p.tolerance = 1e-11;
    p.boundaries["xmin"] = heat_boundary(HeatType::temperature, "300");
    p.boundaries["xmax"] = heat_boundary(HeatType::temperature, "400");
    RawMesh raw = make_box(BoxCells::quadrilaterals, {n, 4, 1}, Vec3::Zero(), Vec3(1, 1, 0));
    HeatCase scene(raw, {{1, fv::Property({"table(T, 300, 1, 400, 2)"}, "k"), 1.0}}, p);
    scene.step(1);
    return scene.error([](const Vec3& x) { return 300 + 100 * (std::sqrt(1 + 3 * x[0]) - 1); });
  };
  const double coarse = error(20), fine = error(40), slope = slope_of(coarse, fine, 2);
  fmt::print("k(T): {:.3e} {:.3e}, slope {:.3f}\n", coarse, fine, slope);
  RecordProperty("slope", fmt::format("{:.4f}", slope));
  EXPECT_GE(slope, 1.9);
}

}  // namespace couplet::testing::order_test
