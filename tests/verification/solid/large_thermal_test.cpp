// SPDX-License-Identifier: Apache-2.0
// Thermal strain at large strain: free and held bodies, a ring against its ordinary differential equation, tangent,
// ranks, restart.
#include "solid_solver/laws/laws.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/finite_support.hpp"

namespace couplet::testing::large_thermal_test {
using namespace mesh;
using namespace parallel;

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double E = 1e6, nu = 0.3, reference = 300;

/// Free but for its symmetry planes; alpha = 1e-3 1/K, so that 200 K stretch by 1.2.
SolidParameters warm(int dim, const laws::Entry& law, const std::string& temperature) {
  SolidParameters p = box_parameters(dim);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, E, nu};
  p.material.law = law.name;
  if (law.n_coefficients > 0) p.material.law_coefficients = {0.2, 0.02};
  p.material.law_coefficients.resize(law.n_coefficients);
  p.material.heat.expansion = config::ExpressionText{"1e-3"};
  p.temperature = config::ExpressionText{temperature};
  p.expansion = ThermalExpansion{reference};
  for (const char* name : {"xmin", "ymin", "zmin"})
    if (p.boundaries.contains(name)) p.boundaries[name] = boundary(Type::symmetry);
  return p;
}

RawMesh box(BoxCells cells) {
  RawMesh raw = make_box(cells, {3, 3, 3}, Vec3::Zero(), Vec3(1, 1, dimension_of(cells) == 3 ? 1 : 0));
  perturb_interior(raw, 0.15, 5);
  return raw;
}

double largest_stress(const Solid& solid, const Tensor3& wanted) {
  double error = 0;
  for (const Tensor3& s : solid.fields().cell_stress(solid.fields().point_displacement()))
    error = std::max(error, (s - wanted).norm());
  return max(solid.body().mesh().comm, error);
}

/// Of the points, from u = (factor - 1) x.
double growth_error(const Solid& solid, double factor) {
  const std::vector<double> u = solid.fields().point_displacement();
  const std::size_t dim = std::size_t(solid.body().mesh().dim);
  double error = 0;
  for (std::size_t i = 0; i < u.size(); ++i)
    error = std::max(error,
                     std::abs(u[i] - (factor - 1) * solid.body().geometry().points[i / dim][Index(i % dim)]));
  return max(solid.body().mesh().comm, error);
}

TEST(LargeThermalStrain, a_free_body_grows_without_stress_by_any_law) {
  for (const laws::Entry& law : laws::all())
    for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra, BoxCells::quadrilaterals}) {
      SCOPED_TRACE(fmt::format("{} {}", law.name, name(cells)));
      SolidParameters p = warm(dimension_of(cells), law, "300 + 200*t");
      p.plane = SolidParameters::Plane::stress;
      const auto solid = stepped(box(cells), p);
      EXPECT_LT(largest_stress(*solid, Tensor3::Zero()), 1e-5 * E);
      EXPECT_LT(growth_error(*solid, 1.2), 1e-5);
    }
}

TEST(LargeThermalStrain, one_volume_ratio_a_cell_grows_with_the_cell) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra}) {
    SolidParameters p = warm(3, *laws::find("mooney-rivlin"), "300 + 200*t");
    p.material.poissons_ratio = 0.499;
    const auto solid = make_solid(box(cells), p);
    ASSERT_TRUE(solid->body().elastic().volume_by_cells());
    step(*solid, 1);
    EXPECT_LT(largest_stress(*solid, Tensor3::Zero()), 1e-5 * E);
    EXPECT_LT(growth_error(*solid, 1.2), 1e-5);
  }
}

/// F = I: with l = 1 / theta, P = theta^2 [mu (l - 1/l) + lambda ln(l^3) / l] of (2.31) and theta^2 K (l^3 - 1) l^2 of the others.
TEST(LargeThermalStrain, a_held_body_is_under_the_pressure_of_its_law) {
  const double theta = 1.2, l = 1 / theta, mu = E / (2 * (1 + nu)), K = E / (3 * (1 - 2 * nu)),
               lambda = K - 2 * mu / 3;
  for (const laws::Entry& law : laws::all())
    for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::tetrahedra}) {
      const std::string what = law.name;
      double wanted = theta * theta * K * (l * l * l - 1) * l * l;
      if (what == "neo-hookean")
        wanted = theta * theta * (mu * (l - 1 / l) + lambda * std::log(l * l * l) / l);
      if (what == "saint-venant-kirchhoff") wanted = theta * theta * l * 3 * K * 0.5 * (l * l - 1);
      SolidParameters p = warm(3, law, "300 + 200*t");
      for (auto& [patch, b] : p.boundaries) b = clamped(3);
      const auto solid = stepped(box(cells), p);
      EXPECT_LT(largest_stress(*solid, wanted * Tensor3::Identity()), 1e-6 * std::abs(wanted)) << what;
    }
}

/// A quarter of a ring, 1 <= R <= 2, in plane strain, hottest inside.
namespace ring {

constexpr double inner = 1, outer = 2, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));

double stretch(double R) { return 1 + 0.3 * std::log(outer / R) / std::log(outer); }
constexpr const char* temperature = "300 + t*300*ln(2/sqrt(x^2 + y^2))/ln(2)";

/// First Piola-Kirchhoff stress of (2.31) along the first of three principal stretches.
double along(double theta, double a, double b, double c) {
  a /= theta, b /= theta, c /= theta;
  return theta * theta * (mu * (a - 1 / a) + lambda * std::log(a * b * c) / a);
}

/// dr/dR that has this radial stress.
double slope_of(double P, double R, double r) {
  const double theta = stretch(R), b = r / R;
  double a = theta;
  for (int i = 0; i < 50; ++i) {
    const double h = 1e-6;
    const double d = (along(theta, a + h, b, 1) - along(theta, a - h, b, 1)) / (2 * h);
    a -= (along(theta, a, b, 1) - P) / d;
  }
  return a;
}

/// r and P at `to` from r at the inner radius, which has no traction, by Runge and Kutta: dP/dR = (P_hoop - P) / R.
std::array<double, 2> shoot(double r, double to, int n) {
  std::array<double, 2> y{r, 0};
  const auto rate = [](double R, const std::array<double, 2>& at) {
    const double a = slope_of(at[1], R, at[0]);
    return std::array<double, 2>{a, (along(stretch(R), at[0] / R, a, 1) - at[1]) / R};
  };
  const auto moved = [](std::array<double, 2> at, const std::array<double, 2>& by, double h) {
    return std::array<double, 2>{at[0] + h * by[0], at[1] + h * by[1]};
  };
  const double h = (to - inner) / n;
  for (int i = 0; i < n; ++i) {
    const double R = inner + i * h;
    const auto k1 = rate(R, y), k2 = rate(R + h / 2, moved(y, k1, h / 2)),
               k3 = rate(R + h / 2, moved(y, k2, h / 2)), k4 = rate(R + h, moved(y, k3, h));
    for (std::size_t k = 0; k < 2; ++k) y[k] += h / 6 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
  }
  return y;
}

double inner_radius() {
  double low = 1, high = 1.6;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (shoot(middle, outer, 100)[1] < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double error(int n, double start, MPI_Comm comm = MPI_COMM_WORLD) {
  SolidParameters p = warm(2, *laws::find("neo-hookean"), temperature);
  p.boundaries["xmin"] = boundary(Type::free);
  p.boundaries["ymax"] = boundary(Type::symmetry);
  const auto solid = stepped(quarter_ring(BoxCells::quadrilaterals, n, n, inner, outer), p, comm);
  double square = 0;
  const Geometry& geometry = solid->body().geometry();
  for (Index c = 0; c < solid->body().mesh().cells.n_owned(); ++c) {
    const double R = geometry.cell_centre[c].norm(), u = shoot(start, R, 40)[0] - R;
    square += geometry.volume[c] * (cell_u(*solid, c) - u / R * geometry.cell_centre[c]).squaredNorm();
  }
  return std::sqrt(sum(comm, square));
}

}  // namespace ring

TEST(LargeThermalStrain, of_a_ring_converges_to_its_differential_equation_in_second_order) {
  const double start = ring::inner_radius();
  const double coarse = ring::error(8, start), fine = ring::error(16, start), finest = ring::error(32, start);
  fmt::print("inner radius {:.6f}, errors {:.3e} {:.3e} {:.3e}, slopes {:.2f} {:.2f}\n", start, coarse, fine,
             finest, std::log2(coarse / fine), std::log2(fine / finest));
  RecordProperty("slope", fmt::format("{:.4f}", std::log2(fine / finest)));
  EXPECT_GE(std::log2(fine / finest), 1.9);
  EXPECT_LT(finest, 1e-3);
}

TEST(LargeThermalStrain, ranks_agree) {
  const SolidParameters p = warm(3, *laws::find("yeoh"), "300 + t*(100*x + 50*y*z)");
  const double whole = norm_of(*stepped(box(BoxCells::tetrahedra), p, MPI_COMM_SELF));
  EXPECT_NEAR(norm_of(*stepped(box(BoxCells::tetrahedra), p)), whole, 1e-6 * whole);
}

/// With stretches that differ from face to face; of the energy forces are the derivative, of the forces the tangent.
TEST(LargeThermalStrain, tangent_is_the_derivative_of_the_forces) {
  for (const auto volume : {MethodParameters::VolumeStrain::faces, MethodParameters::VolumeStrain::cells})
    for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::hexahedra, BoxCells::tetrahedra}) {
      SCOPED_TRACE(name(cells));
      SolidParameters p = warm(dimension_of(cells), *laws::find("mooney-rivlin"), "300");
      p.method.volume_strain = volume;
      const auto solid = make_solid(box(cells), p);
      const Mesh& mesh = solid->body().mesh();
      const auto law = laws::find("mooney-rivlin")->make(lame_constants(E, nu), std::vector{0.3});
      const auto kernel =
          std::make_unique<elastic::FiniteKernel>(mesh, solid->body().elastic(), std::vector{law});
      std::vector<double> stretch;
      for (Index f = 0; f < mesh.n_flux_faces(); ++f)
        stretch.push_back(1 + 0.2 * solid->body().geometry().face_centre[f][0]);
      kernel->set_stretch(stretch);
      expect_derivatives(*kernel, solid->body().elastic().n_unknowns());
    }
}

/// Half of its length may be left, not none.
TEST(LargeThermalStrain, a_strain_of_minus_one_is_refused) {
  const auto heat = [](const char* temperature) {
    SolidParameters p = warm(2, *laws::find("neo-hookean"), temperature);
    p.plane = SolidParameters::Plane::stress;
    p.material.heat.expansion = config::ExpressionText{"-1e-3"};
    const auto solid = make_solid(box(BoxCells::quadrilaterals), p);
    for (int i = 0; i < 4; ++i) step(*solid, 0.25);
    return growth_error(*solid, 0.5);
  };
  EXPECT_LT(heat("300 + 500*t"), 1e-6);
  EXPECT_THAT(
      [&] { heat("300 + 1000*t"); },
      ThrowsMessage<Error>(HasSubstr("a thermal strain of -1 or less would shrink the body to nothing")));
}

TEST(LargeThermalStrain, restart_goes_on_bit_for_bit_with_conduction) {
  SolidParameters p = warm(2, *laws::find("neo-hookean"), "300");
  p.temperature.reset();
  p.heat.emplace();
  p.heat->analysis = HeatParameters::Analysis::transient;
  p.material.heat.conductivity = config::ExpressionText{"50"};
  p.material.heat.specific_heat = config::ExpressionText{"1"};
  p.heat->initial_temperature = {"300"};
  p.heat->boundaries["xmax"].type = HeatBoundary::Type::temperature;
  p.heat->boundaries["xmax"].value = {"500"};
  expect_same_after_restart(box(BoxCells::quadrilaterals), p, 1, 2);
  const auto moved = stepped(box(BoxCells::quadrilaterals), p);
  step(*moved, 2);
  EXPECT_GT(max(MPI_COMM_WORLD, std::ranges::max(moved->stepper().state().cell_u)), 0.001);
}

}  // namespace couplet::testing::large_thermal_test
