// SPDX-License-Identifier: Apache-2.0
// Plane stress at large strain: sheets whose answer is known, any law, near incompressibility, a free sheet in space,
// second order, tangent, ranks, restart.
#include "solid_solver/laws/laws.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/finite_support.hpp"

namespace couplet::testing::large_sheet_test {
using namespace mesh;
using namespace parallel;

constexpr double E = 1e6;

/// Free, with symmetry at xmin, ymin (and zmin).
SolidParameters sheet(const laws::Entry& law, double nu, int dim = 2) {
  SolidParameters p = box_parameters(dim);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.plane = SolidParameters::Plane::stress;
  p.material = {1000, E, nu};
  p.material.law = law.name;
  if (law.n_coefficients > 0) p.material.law_coefficients = {0.2, 0.02};
  p.material.law_coefficients.resize(law.n_coefficients);
  for (const char* name : {"xmin", "ymin", "zmin"})
    if (p.boundaries.contains(name)) p.boundaries[name] = boundary(Type::symmetry);
  return p;
}

RawMesh box(BoxCells cells, int n = 3, double thickness = 0) {
  RawMesh raw = make_box(cells, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, thickness));
  if (thickness == 0) perturb_interior(raw, 0.15, 5);
  return raw;
}

Tensor3 stress_of(const Solid& solid) {
  return solid.fields().cell_stress(solid.fields().point_displacement()).front();
}

/// (2.31) with mu, lambda: P of a stretch a beside b and c.
double along(double mu, double lambda, double a, double b, double c) {
  return mu * (a - 1 / a) + lambda * std::log(a * b * c) / a;
}

/// c with P = 0 across: by bisection.
double across(double mu, double lambda, double a, double b) {
  double low = 0.05, high = 5;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (along(mu, lambda, middle, a, b) < 0 ? low : high) = middle;
  }
  return low;
}

TEST(LargeSheet, equibiaxial_stretch_has_the_stress_of_neo_hookes_law) {
  for (const double nu : {0.3, 0.499}) {
    const double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), a = 1.5;
    SolidParameters p = sheet(*laws::find("neo-hookean"), nu);
    for (const char* name : {"xmax", "ymax"})
      p.boundaries[name] = boundary(Type::fixed_displacement, {"0.5*t*x", "0.5*t*y"});
    const double c = across(mu, lambda, a, a), wanted = along(mu, lambda, a, a, c) / (a * c);
    for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
      const auto solid = make_solid(box(cells), p);
      for (int i = 0; i < 2; ++i) step(*solid, 0.5);
      for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement())) {
        EXPECT_NEAR(s(0, 0), wanted, 1e-6 * wanted) << nu;
        EXPECT_NEAR(s(1, 1), wanted, 1e-6 * wanted) << nu;
        EXPECT_NEAR(s(2, 2), 0, 1e-8 * wanted) << nu;
      }
    }
  }
}

/// Of an incompressible sheet: P = mu (a - a^-2) along its pull; nu = 0.4999 differs by about 1e-4. No mixed form is needed.
TEST(LargeSheet, uniaxial_tension_meets_the_incompressible_limit) {
  const double mu = E / 3, a = 2, pull = mu * (a - 1 / (a * a));
  for (const char* law : {"neo-hookean", "nearly-incompressible-neo-hookean"}) {
    SolidParameters p = sheet(*laws::find(law), 0.4999);
    p.boundaries["xmax"] = boundary(Type::traction, {fmt::format("{:.17g}*t", pull), "0"});
    const auto solid = make_solid(box(BoxCells::quadrilaterals), p);
    for (int i = 0; i < 4; ++i) step(*solid, 0.25);
    const SolidState& s = solid->stepper().state();
    double most = 0;
    for (std::size_t i = 0; i < s.face_u.size(); i += 2) most = std::max(most, s.face_u[i]);
    most = max(MPI_COMM_WORLD, most);
    EXPECT_NEAR(1 + most, a, 1e-3 * a) << law;
    if (solid->body().mesh().cells.n_owned() > 0)
      EXPECT_NEAR(stress_of(*solid)(0, 0), pull * a, 2e-3 * pull * a) << law;
  }
}

/// One cell thick in space, free above: the same, by any law.
TEST(LargeSheet, any_law_agrees_with_a_free_sheet_in_space) {
  for (const laws::Entry& law : laws::all()) {
    const auto tip = [&](int dim) {
      SolidParameters p = sheet(law, 0.35, dim);
      p.method.volume_strain = MethodParameters::VolumeStrain::faces;
      std::vector<std::string> pull{"3e5*t", "1e5*t"};
      if (dim == 3) pull.emplace_back("0");
      p.boundaries["xmax"] = boundary(Type::traction, pull);
      const auto solid = make_solid(
          box(dim == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra, 4, dim == 2 ? 0 : 0.02), p);
      for (int i = 0; i < 2; ++i) step(*solid, 0.5);
      Vec3 found = displacement_at(*solid, Vec3(1, 1, 0));
      found[2] = 0;
      return found;
    };
    const Vec3 plane = tip(2), space = tip(3);
    fmt::print("{}: plane ({:.5f}, {:.5f}), space ({:.5f}, {:.5f})\n", law.name, plane[0], plane[1], space[0],
               space[1]);
    EXPECT_LT((plane - space).norm(), 0.01 * space.norm()) << law.name;
  }
}

/// A disc with a hole, 1 <= R <= 2, whose hole is opened by prescribed displacement, against its differential equation.
namespace disc {

constexpr double inner = 1, outer = 2, nu = 0.3, mu = E / (2 * (1 + nu)),
                 lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
constexpr double opened = 1.4;

double radial(double a, double b) { return along(mu, lambda, a, b, across(mu, lambda, a, b)); }

/// dr/dR of a radial stress, by bisection.
double slope_of(double P, double b) {
  double low = 0.2, high = 3;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (radial(middle, b) < P ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// r, P at `to`: dP/dR = (P_hoop - P) / R.
std::array<double, 2> shoot(double P, double to, int n) {
  std::array<double, 2> y{opened, P};
  const auto rate = [](double R, const std::array<double, 2>& at) {
    const double a = slope_of(at[1], at[0] / R);
    return std::array<double, 2>{a, (radial(at[0] / R, a) - at[1]) / R};
  };
  const double h = (to - inner) / n;
  for (int i = 0; i < n; ++i) {
    const double R = inner + i * h;
    const auto moved = [&](const std::array<double, 2>& by, double s) {
      return std::array<double, 2>{y[0] + s * by[0], y[1] + s * by[1]};
    };
    const auto k1 = rate(R, y), k2 = rate(R + h / 2, moved(k1, h / 2)),
               k3 = rate(R + h / 2, moved(k2, h / 2)), k4 = rate(R + h, moved(k3, h));
    for (std::size_t k = 0; k < 2; ++k) y[k] += h / 6 * (k1[k] + 2 * k2[k] + 2 * k3[k] + k4[k]);
  }
  return y;
}

double start() {
  double low = -2 * E, high = 0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (shoot(middle, outer, 30)[1] < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double error(int n, double P) {
  SolidParameters p = sheet(*laws::find("neo-hookean"), nu);
  p.boundaries["xmin"] =
      boundary(Type::fixed_displacement, {"0.4*t*x/sqrt(x^2 + y^2)", "0.4*t*y/sqrt(x^2 + y^2)"});
  p.boundaries["ymax"] = boundary(Type::symmetry);
  const auto solid = make_solid(quarter_ring(BoxCells::quadrilaterals, n, n, inner, outer), p);
  for (int i = 0; i < 2; ++i) step(*solid, 0.5);
  double square = 0;
  const Geometry& geometry = solid->body().geometry();
  // One row of cells across the ring has the radii of all.
  for (Index c = 0; c < solid->body().mesh().cells.n_owned(); ++c) {
    const Vec3& x = geometry.cell_centre[c];
    if (std::atan2(x[1], x[0]) > std::acos(0.0) / n) continue;
    const double R = x.norm(), u = shoot(P, R, 20)[0] - R;
    square += geometry.volume[c] * n * (cell_u(*solid, c) - u / R * x).squaredNorm();
  }
  return std::sqrt(sum(MPI_COMM_WORLD, square));
}

}  // namespace disc

TEST(LargeSheet, an_opened_disc_converges_to_its_differential_equation_in_second_order) {
  const double P = disc::start(), coarse = disc::error(8, P), fine = disc::error(16, P);
  fmt::print("P {:.6g}, errors {:.3e} {:.3e}, slope {:.2f}\n", P, coarse, fine, std::log2(coarse / fine));
  RecordProperty("slope", fmt::format("{:.4f}", std::log2(coarse / fine)));
  EXPECT_GE(std::log2(coarse / fine), 1.9);
  EXPECT_LT(fine, 2e-3);
}

/// Rounding of det F times the bulk modulus would be more than the tolerance of the forces.
TEST(LargeSheet, rounding_stops_no_iteration_however_near_nu_is_to_one_half) {
  for (const double nu : {0.499, 0.49999, 0.4999999}) {
    SolidParameters p = sheet(*laws::find("nearly-incompressible-neo-hookean"), nu);
    p.boundaries["xmin"] = boundary(Type::free);
    p.boundaries["xmax"] = boundary(Type::fixed_displacement, {"0.5*t*x", "0.5*t*y"});
    p.boundaries["ymax"] = boundary(Type::symmetry);
    const auto solid = make_solid(quarter_ring(BoxCells::quadrilaterals, 8, 8), p);
    for (int i = 0; i < 2; ++i) {
      step(*solid, 0.5);
      EXPECT_LT(solid->stepper().effort().residual, 1e-10) << nu;
      EXPECT_LT(solid->stepper().effort().iterations, 10) << nu;
    }
  }
}

TEST(LargeSheet, condensed_tangent_is_the_derivative_of_the_forces_and_symmetric) {
  for (const laws::Entry& law : laws::all())
    for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
      SCOPED_TRACE(law.name);
      const auto solid = make_solid(box(cells), sheet(law, 0.3));
      const auto own = law.make(lame_constants(E, 0.3), std::vector<double>(law.n_coefficients, 0.1));
      const auto kernel = std::make_unique<elastic::FiniteKernel>(
          solid->body().mesh(), solid->body().elastic(), std::vector{own}, true);
      expect_derivatives(*kernel, solid->body().elastic().n_unknowns(), true, 1e-9);
    }
}

TEST(LargeSheet, ranks_agree_and_restart_is_bit_for_bit) {
  SolidParameters p = sheet(*laws::find("mooney-rivlin"), 0.45);
  p.boundaries["xmax"] = boundary(Type::traction, {"4e5*t", "2e5*t"});
  const RawMesh raw = box(BoxCells::triangles, 4);
  const double whole = norm_of(*stepped(raw, p, MPI_COMM_SELF));
  EXPECT_NEAR(norm_of(*stepped(raw, p)), whole, 1e-7 * whole);
  expect_same_after_restart(raw, p, 0.5, 0.5);
}

/// No stretch across the sheet has no stress once Saint Venant-Kirchhoff's sheet is stretched this far: the step fails.
TEST(LargeSheet, a_law_without_a_stretch_across_fails_the_step) {
  SolidParameters p = sheet(*laws::find("saint-venant-kirchhoff"), 0.45);
  for (const char* name : {"xmax", "ymax"})
    p.boundaries[name] = boundary(Type::fixed_displacement, {"t*x", "t*y"});
  const auto solid = make_solid(box(BoxCells::quadrilaterals), p);
  step(*solid, 0.1);
  solid->begin_step({0.1, 0.9, coupling::Scheme::standalone, 1});
  EXPECT_THROW(solid->solve({}), SolveFailure);
}

}  // namespace couplet::testing::large_sheet_test
