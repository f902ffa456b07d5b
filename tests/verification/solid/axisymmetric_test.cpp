// SPDX-License-Identifier: Apache-2.0
// Bodies of revolution: constant stress on any cells, Lame's cylinder and sphere, a rotating disc, a hot cylinder, a
// breathing ring, a wedge in space, ranks, restart, the axis.
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::axisymmetric_test {
using namespace mesh;
using namespace parallel;

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double E = 200e9, nu = 0.3;

SolidParameters round() {
  SolidParameters p = box_parameters(2);
  p.plane = SolidParameters::Plane::axisymmetric;
  p.boundaries["ymin"] = boundary(Type::symmetry);
  return p;
}

void press(SolidParameters& p, const char* patch, double pressure) {
  p.boundaries[patch] = pressed(fmt::format("{:.17g}", pressure));
}

/// Of the cells' displacement.
template <class Wanted>
double displacement_error(const Solid& solid, const Wanted& wanted) {
  return l2_errors(solid, wanted).displacement;
}

TEST(Axisymmetric, constant_stress_is_exact_on_any_cells_with_the_axis_and_without) {
  constexpr double q = 1e6;
  for (const double inner : {0., 1.})
    for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
      SCOPED_TRACE(fmt::format("{} {}", inner, name(cells)));
      RawMesh raw = make_box(cells, {4, 3, 1}, Vec3(inner, 0, 0), Vec3(inner + 1, 1, 0));
      perturb_interior(raw, 0.2, 7);
      SolidParameters p = round();
      if (inner == 0)
        p.boundaries["xmin"] = boundary(Type::symmetry);
      else
        press(p, "xmin", q);
      press(p, "xmax", q), press(p, "ymax", q);
      const auto squeezed = stepped(raw, p);
      const L2Errors off = l2_errors(
          *squeezed, [](const Vec3& x) { return Vec3(-q * (1 - 2 * nu) / E * x); },
          [](const Vec3&) { return Tensor3(-q * Tensor3::Identity()); });
      EXPECT_LT(off.displacement, 1e-9);
      EXPECT_LT(off.stress, 1e-9);
      if (inner == 0) continue;
      for (const char* side : {"xmin", "xmax"}) p.boundaries[side] = boundary(Type::free);
      p.boundaries["ymax"] = boundary(Type::traction, {"0", fmt::format("{}", q)});
      const auto pulled = stepped(raw, p);
      EXPECT_LT(displacement_error(*pulled,
                                   [](const Vec3& x) { return Vec3(-nu * q / E * x[0], q / E * x[1], 0); }),
                1e-9);
    }
}

using Errors = L2Errors;

void expect_second_order(const char* what, const Errors& coarse, const Errors& fine, double least_of_stress) {
  const double u = std::log2(coarse.displacement / fine.displacement),
               s = std::log2(coarse.stress / fine.stress);
  fmt::print("{}: displacement {:.3e} {:.3e} slope {:.2f}, stress {:.3e} {:.3e} slope {:.2f}\n", what,
             coarse.displacement, fine.displacement, u, coarse.stress, fine.stress, s);
  ::testing::Test::RecordProperty("displacement_slope", fmt::format("{:.4f}", u));
  ::testing::Test::RecordProperty("stress_slope", fmt::format("{:.4f}", s));
  EXPECT_GE(u, 1.9) << what;
  EXPECT_GE(s, least_of_stress) << what;
}

/// Between radii 1 and 2, in plane strain.
Errors cylinder(BoxCells cells, int n) {
  constexpr double q = 1e8, a = 1, b = 2, A = q * a * a / (b * b - a * a), B = A * b * b;
  SolidParameters p = round();
  p.boundaries["ymax"] = boundary(Type::symmetry);
  press(p, "xmin", q);
  const auto solid = stepped(make_box(cells, {n, std::max(2, n / 4), 1}, Vec3(a, 0, 0), Vec3(b, 0.25, 0)), p);
  return l2_errors(
      *solid, [](const Vec3& x) { return Vec3((1 + nu) / E * (A * (1 - 2 * nu) * x[0] + B / x[0]), 0, 0); },
      [](const Vec3& x) {
        return Tensor3(Vec3(A - B / (x[0] * x[0]), 2 * nu * A, A + B / (x[0] * x[0])).asDiagonal());
      });
}

TEST(Axisymmetric, lames_cylinder_converges_in_second_order) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles})
    expect_second_order(name(cells), cylinder(cells, 32), cylinder(cells, 64), 1.3);
}

/// A quarter of the section of a hollow sphere, 1 <= R <= 2, from the axis to the plane across it.
Errors sphere(BoxCells cells, int n, double* surface = nullptr) {
  constexpr double q = 1e8, a = 1, b = 2, A = q / (b * b * b - 1), B = A * b * b * b / 2;
  RawMesh raw = make_box(cells, {n, n, 1}, Vec3(a, 0, 0), Vec3(b, std::numbers::pi / 2, 0));
  for (Vec3& x : raw.points) {
    const double r = x[0] * std::cos(x[1]), z = x[0] * std::sin(x[1]);
    x = Vec3(r < 1e-12 ? 0 : r, z, 0);
  }
  SolidParameters p = round();
  p.boundaries["ymax"] = boundary(Type::symmetry);  // the axis
  press(p, "xmin", q);
  const auto solid = stepped(raw, p);
  const auto radial = [](double R) { return A - 2 * B / (R * R * R); };
  const auto hoop = [](double R) { return A + B / (R * R * R); };
  if (surface) {
    const auto points = solid->fields().point_displacement();
    const std::vector<double> stress = solid->fields().point_stress(points);
    double error = 0;
    for (Index v = 0; v < solid->body().mesh().points.n_owned(); ++v) {
      const Vec3& x = solid->body().geometry().points[v];
      if (x.norm() < a + 1e-9)
        error = std::max(error, std::abs(stress[std::size_t(v) * 6 + 2] - hoop(a)) / hoop(a));
    }
    *surface = max(MPI_COMM_WORLD, error);
  }
  return l2_errors(
      *solid,
      [](const Vec3& x) {
        const double R = x.norm();
        return Vec3(((1 - 2 * nu) * A * R + (1 + nu) * B / (R * R)) / E * x / R);
      },
      [&](const Vec3& x) {
        const double R = x.norm();
        const Vec3 n = x / R;
        return Tensor3(hoop(R) * Tensor3::Identity() + (radial(R) - hoop(R)) * n * n.transpose());
      });
}

TEST(Axisymmetric, a_sphere_under_pressure_converges_in_second_order) {
  double coarse = 0, fine = 0;
  expect_second_order("sphere", sphere(BoxCells::quadrilaterals, 24, &coarse),
                      sphere(BoxCells::quadrilaterals, 48, &fine), 1.5);
  fmt::print("hoop stress at the inner surface: {:.3e} {:.3e}\n", coarse, fine);
  EXPECT_LT(fine, 0.02);
}

/// Omega^2 r rho on a thin disc with a hole, free all around: u of plane stress.
TEST(Axisymmetric, a_rotating_disc_has_the_displacement_of_plane_stress) {
  const auto error = [](int n) {
    constexpr double rho = 7800, w2 = 1e4, a = 0.2, b = 1;
    SolidParameters p = round();
    p.body_force = {{fmt::format("{}*x", rho * w2)}, {"0"}};
    const auto solid =
        stepped(make_box(BoxCells::quadrilaterals, {n, 2, 1}, Vec3(a, 0, 0), Vec3(b, 0.005, 0)), p);
    return displacement_error(*solid, [](const Vec3& x) {
      const double r = x[0], k = (3 + nu) * rho * w2 / (8 * E);
      const double u = k * r *
                       ((1 - nu) * (a * a + b * b) + (1 + nu) * a * a * b * b / (r * r) -
                        (1 - nu * nu) / (3 + nu) * r * r);
      const double sum_of_stresses = E * k * (2 * (a * a + b * b) - r * r * (1 + (1 + 3 * nu) / (3 + nu)));
      return Vec3(u, -nu / E * sum_of_stresses * x[1], 0);
    });
  };
  const double coarse = error(40), fine = error(80);
  fmt::print("disc: {:.3e} {:.3e} slope {:.2f}\n", coarse, fine, std::log2(coarse / fine));
  EXPECT_GE(std::log2(coarse / fine), 1.9);
}

/// T = T0 ln(b/r) / ln(b/a) between planes of symmetry: Timoshenko and Goodier's displacement by quadrature.
TEST(Axisymmetric, a_hot_cylinder_converges_in_second_order) {
  const auto error = [](int n) {
    constexpr double a = 1, b = 2, alpha = 1.2e-5, T0 = 100;
    SolidParameters p = round();
    p.boundaries["ymax"] = boundary(Type::symmetry);
    p.temperature = config::ExpressionText{"300 + 100*ln(2/x)/ln(2)"};
    p.expansion = ThermalExpansion{300};
    p.material.heat.expansion = config::ExpressionText{"1.2e-5"};
    const auto solid =
        stepped(make_box(BoxCells::quadrilaterals, {n, 2, 1}, Vec3(a, 0, 0), Vec3(b, 0.1, 0)), p);
    const auto integral = [](double r) {  // of T r from a
      const double L = std::log(b / a);
      const auto F = [&](double x) { return T0 / L * (x * x / 2 * std::log(b / x) + x * x / 4); };
      return F(r) - F(a);
    };
    const auto wanted = [&](const Vec3& x) {
      const double r = x[0], k = alpha * (1 + nu) / (1 - nu);
      return Vec3(k * (integral(r) / r + ((1 - 2 * nu) * r + a * a / r) / (b * b - a * a) * integral(b)), 0,
                  0);
    };
    return displacement_error(*solid, wanted);
  };
  const double coarse = error(16), fine = error(32);
  fmt::print("hot cylinder: {:.3e} {:.3e} slope {:.2f}\n", coarse, fine, std::log2(coarse / fine));
  EXPECT_GE(std::log2(coarse / fine), 1.9);
  EXPECT_LT(fine, 1e-3);
}

/// A thin ring that is set off radially: w = sqrt(E / rho) / R.
TEST(Axisymmetric, a_thin_ring_breathes_with_its_frequency) {
  constexpr double R = 1, t = 0.01, v = 0.1;
  SolidParameters p = round();
  p.analysis = SolidParameters::Analysis::dynamic;
  p.initial_velocity = {{"0.1"}, {"0"}};
  const auto solid = make_solid(
      make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3(R - t / 2, 0, 0), Vec3(R + t / 2, t, 0)), p);
  const double w = std::sqrt(E / 7800) / R, dt = std::numbers::pi / w / 100;
  for (int i = 0; i < 50; ++i) step(*solid, dt);
  double most = 0;
  for (std::size_t c = 0; c < std::size_t(solid->body().mesh().cells.n_owned()); ++c)
    most = std::max(most, solid->stepper().state().cell_u[2 * c]);
  EXPECT_NEAR(max(MPI_COMM_WORLD, most), v / w, 0.01 * v / w);
  for (int i = 0; i < 50; ++i) step(*solid, dt);
  most = 0;
  for (std::size_t c = 0; c < std::size_t(solid->body().mesh().cells.n_owned()); ++c)
    most = std::max(most, std::abs(solid->stepper().state().cell_u[2 * c]));
  EXPECT_LT(max(MPI_COMM_WORLD, most), 0.02 * v / w);
}

/// A flange under a pressure that grows along the bore: the same section turned by 0.02 in space, one cell around.
TEST(Axisymmetric, agrees_with_a_wedge_in_space) {
  const auto tip = [](int dim) {
    RawMesh raw = make_box(dim == 2 ? BoxCells::quadrilaterals : BoxCells::hexahedra, {12, 12, 1},
                           Vec3(0.5, 0, 0), Vec3(1, 1, dim == 2 ? 0 : 0.02));
    if (dim == 3)
      for (Vec3& x : raw.points) x = Vec3(x[0] * std::cos(x[2] - 0.01), x[1], x[0] * std::sin(x[2] - 0.01));
    SolidParameters p = dim == 2 ? round() : box_parameters(3);
    for (const char* side : {"ymin", "zmin", "zmax"})
      if (p.boundaries.contains(side)) p.boundaries[side] = boundary(Type::symmetry);
    p.boundaries["xmin"] = pressed("1e8*y");
    const auto solid = stepped(raw, p);
    Vec3 found(-1, -1, 0);
    const std::vector<double> u = solid->fields().point_displacement();
    for (std::size_t i = 0; i < u.size(); i += std::size_t(dim)) {
      const Vec3& x = solid->body().geometry().points[i / std::size_t(dim)];
      if (std::abs(std::hypot(x[0], x[2]) - 1) < 1e-9 && std::abs(x[1] - 1) < 1e-9)
        found = Vec3(std::hypot(u[i], dim == 3 ? u[i + 2] : 0), u[i + 1], 0);
    }
    for (double& v : found) v = max(MPI_COMM_WORLD, v);
    return found;
  };
  const Vec3 plane = tip(2), space = tip(3);
  fmt::print("axisymmetric ({:.5e}, {:.5e}), wedge ({:.5e}, {:.5e})\n", plane[0], plane[1], space[0],
             space[1]);
  EXPECT_LT((plane - space).norm(), 0.005 * space.norm());
}

SolidParameters flange() {
  SolidParameters p = round();
  p.boundaries["ymin"] = clamped(2);
  p.boundaries["ymax"] = boundary(Type::traction, {"1e6*t", "2e6*t"});
  return p;
}

RawMesh tube() { return make_box(BoxCells::triangles, {5, 5, 1}, Vec3(1, 0, 0), Vec3(2, 1, 0)); }

/// The load on the ring between 1 and 2 is 3 pi times the axial traction.
TEST(Axisymmetric, the_axial_reaction_is_that_of_the_whole_ring) {
  const auto solid = stepped(tube(), flange());
  const double load = 3 * std::numbers::pi * 2e6;
  EXPECT_NEAR(solid->fields().total_load()[1], load, 1e-9 * load);
  const auto reactions = solid->fields().reactions(solid->fields().point_displacement());
  ASSERT_EQ(reactions.size(), 1U);
  EXPECT_NEAR(reactions[0].force[1], -load, 1e-7 * load);
}

TEST(Axisymmetric, ranks_agree_and_restart_is_bit_for_bit) {
  SolidParameters p = flange();
  const double whole = norm_of(*stepped(tube(), p, MPI_COMM_SELF));
  EXPECT_NEAR(norm_of(*stepped(tube(), p)), whole, 1e-8 * whole);
  p.analysis = SolidParameters::Analysis::dynamic;
  expect_same_after_restart(tube(), p, 1e-5, 1e-5);
}

TEST(Axisymmetric, a_mesh_behind_the_axis_or_an_open_axis_is_refused) {
  SolidParameters p = round();
  const auto made = [&](double inner) {
    return [&p, inner] {
      make_solid(make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3(inner, 0, 0), Vec3(1, 1, 0)), p);
    };
  };
  EXPECT_THAT(made(-0.5), ThrowsMessage<Error>(HasSubstr("must not be negative")));
  EXPECT_THAT(made(0), ThrowsMessage<Error>(HasSubstr("the patch on the axis x = 0 needs 'type: symmetry'")));
  p.boundaries["xmax"] = boundary(Type::symmetry);
  EXPECT_THAT(made(0.5), ThrowsMessage<Error>(HasSubstr("must be the axis x = 0 or a plane y = constant")));
  p.boundaries["xmax"] = p.boundaries["ymin"] = boundary(Type::free);
  press(p, "xmax", 1);
  EXPECT_THAT(made(0.5), ThrowsMessage<Error>(HasSubstr("translation along y, the axis")));
}

}  // namespace couplet::testing::axisymmetric_test
