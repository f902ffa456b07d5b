// SPDX-License-Identifier: Apache-2.0
// Plane problems with solutions in closed form: Lame's cylinder, also within a rigid wall, and Kirsch's hole.
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::closed_forms_test {
using namespace mesh;

using Errors = L2Errors;

/// The stress of principal stresses along and across the radius.
Tensor3 cartesian(const Vec3& x, double radial, double hoop) {
  const Vec3 along = x.normalized(), across(-along[1], along[0], 0);
  return radial * along * along.transpose() + hoop * across * across.transpose();
}

void record(const char* name, const Errors& coarse, const Errors& fine, bool with_displacement = true) {
  const double u = std::log2(coarse.displacement / fine.displacement),
               s = std::log2(coarse.stress / fine.stress);
  if (with_displacement) ::testing::Test::RecordProperty("displacement_slope", fmt::format("{:.4f}", u));
  ::testing::Test::RecordProperty("stress_slope", fmt::format("{:.4f}", s));
  ::testing::Test::RecordProperty("displacement_error", fmt::format("{:.3e}", fine.displacement));
  ::testing::Test::RecordProperty("stress_error", fmt::format("{:.3e}", fine.stress));
  fmt::print("{}: displacement {:.3e}, slope {:.2f}; stress {:.3e}, slope {:.2f}\n", name, fine.displacement,
             u, fine.stress, s);
  if (with_displacement) {
    EXPECT_GE(u, 1.9);
  }
  EXPECT_GE(s, 0.95);
}

// -- Lame: ri = 7, ro = 18.625, p = 100 MPa, E = 10 GPa, nu = 0.3 (thick cylinder of the solids4foam
// verification) ----
constexpr double inner = 7, outer = 18.625, pressure = 100e6;

SolidParameters cylinder(SolidParameters::Plane plane, FaceGradient gradient) {
  SolidParameters p = box_parameters(2);
  p.method.face_gradient = gradient;
  p.plane = plane;
  p.material = {7800, 10e9, 0.3};
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
  p.boundaries["xmin"] = pressed(fmt::format("{}", pressure));
  return p;
}

std::unique_ptr<Solid> solve_cylinder(const SolidParameters& p, BoxCells cells, int n) {
  auto solid = stepped(quarter_ring(cells, n, 2 * n, inner, outer), p);
  return solid;
}

/// u_r = a r + b / r with the constants of the plane problem.
Errors cylinder_errors(const Solid& solid, double a, double b) {
  const elastic::LameConstants l = solid.body().elastic().lame(0);
  return l2_errors(
      solid, [&](const Vec3& x) { return Vec3((a + b / x.squaredNorm()) * x); },
      [&](const Vec3& x) {
        const double mean = 2 * (l.mu + l.lambda) * a, swing = 2 * l.mu * b / x.squaredNorm();
        return cartesian(x, mean - swing, mean + swing);
      });
}

class SolidClosedForms : public ::testing::TestWithParam<FaceGradient> {};
INSTANTIATE_TEST_SUITE_P(Gradients, SolidClosedForms, ::testing::Values(FaceGradient::thesis),
                         [](const auto&) { return "thesis"; });

TEST_P(SolidClosedForms, lame_cylinder_converges_with_second_order) {
  for (const auto plane : {SolidParameters::Plane::strain, SolidParameters::Plane::stress})
    for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
      const SolidParameters p = cylinder(plane, GetParam());
      const elastic::LameConstants l = lame_constants(p);
      // sigma_r(ri) = -p, sigma_r(ro) = 0.
      const double swing = pressure / (1 / (inner * inner) - 1 / (outer * outer));
      const double b = swing / (2 * l.mu), a = swing / (outer * outer) / (2 * (l.mu + l.lambda));
      // The values of the case's sheet: u_r(7) = 0.111956 m in plane strain, 0.114029 m in plane stress.
      EXPECT_NEAR(a * inner + b / inner, plane == SolidParameters::Plane::strain ? 0.111956 : 0.114029, 1e-6);
      const Errors coarse = cylinder_errors(*solve_cylinder(p, cells, 10), a, b),
                   fine = cylinder_errors(*solve_cylinder(p, cells, 20), a, b);
      record("Lame cylinder", coarse, fine);
      EXPECT_LT(fine.displacement, 3e-3);
    }
}

// The outside slides along a rigid wall: the facets of the patch are not one plane.
TEST_P(SolidClosedForms, cylinder_in_a_frictionless_rigid_wall_converges_with_second_order) {
  SolidParameters p = cylinder(SolidParameters::Plane::strain, GetParam());
  p.boundaries["xmax"] = boundary(Type::frictionless);
  const elastic::LameConstants l = lame_constants(p);
  // a ro + b / ro = 0 and 2 (mu + lambda) a - 2 mu b / ri^2 = -p.
  const double b = pressure / (2 * (l.mu + l.lambda) / (outer * outer) + 2 * l.mu / (inner * inner));
  const double a = -b / (outer * outer);
  const Errors coarse = cylinder_errors(*solve_cylinder(p, BoxCells::quadrilaterals, 10), a, b),
               fine = cylinder_errors(*solve_cylinder(p, BoxCells::quadrilaterals, 20), a, b);
  record("cylinder in a rigid wall", coarse, fine);
}

TEST_P(SolidClosedForms, a_curved_symmetry_patch_is_refused) {
  SolidParameters p = cylinder(SolidParameters::Plane::strain, GetParam());
  p.boundaries["xmax"] = boundary(Type::symmetry);
  EXPECT_THAT(
      [&] { solve_cylinder(p, BoxCells::quadrilaterals, 8); },
      ::testing::ThrowsMessage<Error>(::testing::HasSubstr("a patch of 'type: symmetry' is not flat at (")));
}

// -- Kirsch: hole a = 0.5 in a quarter plate of 2 x 2, T = 1 MPa along x, tractions of the infinite plate
// outside -----
constexpr double hole = 0.5, side = 2, tension = 1e6;

Vec3 kirsch_stress(const Vec3& x) {
  const double r2 = x.squaredNorm(), q = hole * hole / r2;
  const double c2 = (x[0] * x[0] - x[1] * x[1]) / r2, s2 = 2 * x[0] * x[1] / r2;
  const double c4 = 2 * c2 * c2 - 1, s4 = 2 * s2 * c2;
  return tension * Vec3(1 - q * (1.5 * c2 + c4) + 1.5 * q * q * c4, -q * (0.5 * c2 - c4) - 1.5 * q * q * c4,
                        -q * (0.5 * s2 + s4) + 1.5 * q * q * s4);
}

/// xx, yy, xy as expressions.
std::array<std::string, 3> kirsch_text() {
  const std::string r2 = "(x^2 + y^2)", q = "(0.25/" + r2 + ")", c2 = "((x^2 - y^2)/" + r2 + ")",
                    s2 = "(2*x*y/" + r2 + ")", c4 = "(2*" + c2 + "^2 - 1)", s4 = "(2*" + s2 + "*" + c2 + ")";
  return {"1e6*(1 - " + q + "*(1.5*" + c2 + " + " + c4 + ") + 1.5*" + q + "^2*" + c4 + ")",
          "1e6*(-" + q + "*(0.5*" + c2 + " - " + c4 + ") - 1.5*" + q + "^2*" + c4 + ")",
          "1e6*(-" + q + "*(0.5*" + s2 + " + " + s4 + ") + 1.5*" + q + "^2*" + s4 + ")"};
}

/// Also the largest error of the hoop stress on the faces of the hole, over 3 T.
Errors kirsch_errors(FaceGradient gradient, int n, double& at_hole) {
  SolidParameters p = box_parameters(2);
  p.method.face_gradient = gradient;
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
  const auto [xx, yy, xy] = kirsch_text();
  // xmax is the right side and, beyond the corner, the upper one.
  p.boundaries["xmax"] = boundary(Type::traction, {xx, xy});
  SolidPart upper;
  upper.where = {"y > x"};
  static_cast<SolidCondition&>(upper) = boundary(Type::traction, {xy, yy});
  p.boundaries["xmax"].parts = {upper};
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, 2 * n, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  for (Vec3& x : raw.points) {
    const double a = x[1] * M_PI / 2, c = std::cos(a), d = std::sin(a), g = x[0] * (0.4 + 0.6 * x[0]);
    const Vec3 rim(hole * c, hole * d, 0), edge(side * std::min(1.0, c / d), side * std::min(1.0, d / c), 0);
    x = (1 - g) * rim + g * edge;
  }
  const auto solid = stepped(raw, p);
  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  const Patch& rim = *mesh.find_patch("xmin");
  const auto faces = solid->fields().face_stress(rim.first, rim.count, solid->fields().point_displacement());
  at_hole = 0;
  for (Index i = 0; i < rim.count; ++i) {
    const Vec3 n = geometry.face_area[rim.first + i].normalized(), along(-n[1], n[0], 0);
    const Vec3 exact = kirsch_stress(geometry.face_centre[rim.first + i].normalized() * hole);
    const double hoop =
        exact[0] * along[0] * along[0] + exact[1] * along[1] * along[1] + 2 * exact[2] * along[0] * along[1];
    at_hole = std::max(at_hole, std::abs(along.dot(faces[i] * along) - hoop) / (3 * tension));
  }
  return l2_errors(
      *solid, [](const Vec3&) { return Vec3(Vec3::Zero()); },
      [](const Vec3& x) {
        const Vec3 s = kirsch_stress(x);
        Tensor3 stress = Tensor3::Zero();
        stress.topLeftCorner<2, 2>() << s[0], s[2], s[2], s[1];
        return stress;
      });
}

TEST_P(SolidClosedForms, kirsch_hole_under_analytic_tractions_converges) {
  double hole_coarse = 0, hole_fine = 0;
  const Errors coarse = kirsch_errors(GetParam(), 16, hole_coarse),
               fine = kirsch_errors(GetParam(), 32, hole_fine);
  record("Kirsch hole", coarse, fine, false);
  RecordProperty("hoop_stress_error_at_hole", fmt::format("{:.3e}", hole_fine));
  RecordProperty("hoop_stress_slope_at_hole", fmt::format("{:.4f}", std::log2(hole_coarse / hole_fine)));
  fmt::print("  hoop stress at the hole: {:.3e} of 3 T, slope {:.2f}\n", hole_fine,
             std::log2(hole_coarse / hole_fine));
  EXPECT_LT(hole_fine, 0.02);
  EXPECT_GE(std::log2(hole_coarse / hole_fine), 0.95);
}

}  // namespace couplet::testing::closed_forms_test
