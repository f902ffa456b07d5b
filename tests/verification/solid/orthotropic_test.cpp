// SPDX-License-Identifier: Apache-2.0
// Orthotropic bodies: constant strain in turned axes, bars cut off-axis and a ring with axes along its circles against
// their closed forms.
#include "common/elasticity/anisotropic.hpp"
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::orthotropic_test {
using namespace mesh;

using Plane = SolidParameters::Plane;

/// A carbon ply, roughly: 15 times as stiff along its fibres as across.
Orthotropic ply() {
  Orthotropic m;
  m.youngs_moduli = {150e9, 10e9, 9e9};
  m.poissons_ratios = {0.3, 0.4, 0.25};
  m.shear_moduli = {5e9, 3.2e9, 4.5e9};
  return m;
}

SolidParameters ply_parameters(int dim) {
  SolidParameters p = to_round_off(box_parameters(dim), FaceGradient::automatic);
  p.material = {1600, 0, 0};
  p.material.orthotropic = ply();
  if (dim == 2)
    p.material.orthotropic->first_axis = {{"cos(0.5)"}, {"sin(0.5)"}};
  else
    p.material.orthotropic->first_axis = {{"1"}, {"0.7"}, {"-0.4"}},
    p.material.orthotropic->second_axis = {{"0.2"}, {"1"}, {"0.9"}};
  return p;
}

std::vector<std::string> texts(const Vec3& v, int dim) {
  std::vector<std::string> result;
  for (int a = 0; a < dim; ++a) result.push_back(fmt::format("{:.17g}", v[a]));
  return result;
}

class Orthotropy : public ::testing::TestWithParam<BoxCells> {};
std::string kind_of(const ::testing::TestParamInfo<BoxCells>& info) { return name(info.param); }
INSTANTIATE_TEST_SUITE_P(Solid, Orthotropy, ::testing::ValuesIn(all_cells), kind_of);

TEST_P(Orthotropy, constant_strain_is_exact_in_turned_axes) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the ring and the beam compare the ranks";
  const int dim = dimension_of(GetParam());
  const LinearField field = general_field(dim);
  SolidParameters p = ply_parameters(dim);
  for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, field.text(dim));
  const auto held = stepped(distorted_box(GetParam()), p);
  expect_exact(*held, field);
  const std::vector<std::pair<std::string, Vec3>> loaded{{"xmax", Vec3(1, 0, 0)},
                                                         {"ymin", Vec3(0, -1, 0)},
                                                         {"ymax", Vec3(0, 1, 0)},
                                                         {"zmin", Vec3(0, 0, -1)},
                                                         {"zmax", Vec3(0, 0, 1)}};
  const Tensor3 stress = held->body().elastic().stress(0, field.slope);
  for (const auto& [name, normal] : loaded)
    if (p.boundaries.contains(name))
      p.boundaries[name] = boundary(Type::traction, texts(stress * normal, dim));
  const auto pulled = stepped(distorted_box(GetParam()), p);
  expect_exact(*pulled, field);
  EXPECT_LT(audit_of(*pulled).mismatch(), 1e-9);  // the operator is symmetric
}

/// Compliances of a sheet whose fibres stand at `angle` to x [lekhnitskii1963, 9.8]: of xx, of yy for xx, of xy for xx.
struct OffAxis {
  double s11, s12, s16;
};
OffAxis off_axis(const Orthotropic& m, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), e1 = m.youngs_moduli[0], e2 = m.youngs_moduli[1];
  const double nu = m.poissons_ratios[0], g = m.shear_moduli[0];
  const double mixed = 1 / g - 2 * nu / e1;
  return {std::pow(c, 4) / e1 + mixed * c * c * s * s + std::pow(s, 4) / e2,
          (1 / e1 + 1 / e2 - 1 / g) * c * c * s * s - nu / e1 * (std::pow(c, 4) + std::pow(s, 4)),
          (2 / e1 + 2 * nu / e1 - 1 / g) * s * std::pow(c, 3) -
              (2 / e2 + 2 * nu / e1 - 1 / g) * std::pow(s, 3) * c};
}

/// A strip 4 x 1 cut at 30 degrees to its fibres, held at x = 0 as the closed form moves there.
std::unique_ptr<Solid> strip(BoxCells cells, int n, const std::vector<std::string>& root,
                             const std::string& pull) {
  SolidParameters p = ply_parameters(2);
  p.plane = Plane::stress;
  p.method.preconditioner = MethodParameters::Preconditioner::factors;
  p.material.orthotropic->first_axis = {{"cos(pi/6)"}, {"sin(pi/6)"}};
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, root);
  p.boundaries["xmax"] = boundary(Type::traction, {pull, "0"});
  auto solid = stepped(make_box(cells, {4 * n, n, 1}, Vec3(0, -0.5, 0), Vec3(4, 0.5, 0)), p);
  return solid;
}

TEST(Orthotropic, of_equal_constants_is_the_isotropic_matrix) {
  const double e = 200e9, nu = 0.3, g = e / (2 * (1 + nu));
  const elastic::ElasticMatrix isotropic = elastic::isotropic_matrix(lame_constants(e, nu));
  EXPECT_LT((elastic::orthotropic_matrix({{e, e, e}, {nu, nu, nu}, {g, g, g}}) - isotropic).norm(),
            1e-12 * isotropic.norm());
}

TEST(Orthotropic, a_bar_cut_off_axis_stretches_and_shears_as_its_closed_form) {
  const OffAxis s = off_axis(ply(), std::numbers::pi / 6);
  const double pull = 1e8;
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
    // u = s11 p x + s16 p y, v = s12 p y.
    const auto solid = strip(
        cells, 3, {fmt::format("{:.17g}*y", s.s16 * pull), fmt::format("{:.17g}*y", s.s12 * pull)}, "1e8");
    const L2Errors e = l2_errors(
        *solid,
        [&](const Vec3& x) { return Vec3(pull * (s.s11 * x[0] + s.s16 * x[1]), pull * s.s12 * x[1], 0); },
        [&](const Vec3&) { return Tensor3(Vec3(pull, 0, 0).asDiagonal()); });
    RecordProperty(cells == BoxCells::triangles ? "triangles" : "quadrilaterals",
                   fmt::format("u {:.1e}, stress {:.1e}", e.displacement, e.stress));
    EXPECT_LT(e.displacement, 1e-10);
    EXPECT_LT(e.stress, 1e-10);
    EXPECT_LE(solid->stepper().effort().iterations, 3);  // the assembled factors are those of the operator
  }
}

// sigma_xx = p y: u = p (s11 x y + s16 y^2 / 2), v = p (s12 y^2 - s11 x^2) / 2.
TEST(Orthotropic, a_bar_cut_off_axis_bends_as_its_closed_form_with_second_order) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the ring and the beam compare the ranks";
  const OffAxis s = off_axis(ply(), std::numbers::pi / 6);
  const double p = 1e8;
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles}) {
    L2Errors before;
    for (const int n : {8, 16}) {
      const auto solid = strip(
          cells, n, {fmt::format("{:.17g}*y^2", p * s.s16 / 2), fmt::format("{:.17g}*y^2", p * s.s12 / 2)},
          "1e8*y");
      const L2Errors e = l2_errors(
          *solid,
          [&](const Vec3& x) {
            return Vec3(p * (s.s11 * x[0] * x[1] + s.s16 * x[1] * x[1] / 2),
                        p * (s.s12 * x[1] * x[1] - s.s11 * x[0] * x[0]) / 2, 0);
          },
          [&](const Vec3& x) { return Tensor3(Vec3(p * x[1], 0, 0).asDiagonal()); });
      if (n == 16) {
        const double order = std::log2(before.displacement / e.displacement);
        RecordProperty(cells == BoxCells::triangles ? "triangles" : "quadrilaterals",
                       fmt::format("u {:.2e}, order {:.2f}; stress {:.2e}, order {:.2f}", e.displacement,
                                   order, e.stress, std::log2(before.stress / e.stress)));
        EXPECT_GT(order, 1.8);
        EXPECT_LT(e.displacement, 0.01);
      }
      before = e;
    }
  }
}

/// Quarter of a ring 1 to 2, its axes along radius and circle, under inner pressure, plane stress. Cells n along the radius.
std::unique_ptr<Solid> ring(int n, MPI_Comm comm) {
  SolidParameters p = ply_parameters(2);
  p.plane = Plane::stress;
  p.material.orthotropic->youngs_moduli = {10e9, 40e9, 10e9};  // radius, circle
  p.material.orthotropic->poissons_ratios = {0.1, 0.3, 0.2};
  p.material.orthotropic->first_axis = {{"x"}, {"y"}};
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
  p.boundaries["xmin"] = pressed("1e7");
  return stepped(quarter_ring(BoxCells::quadrilaterals, n, 2 * n), p, comm);
}

// [lekhnitskii1968, 23]: k = sqrt(E_t / E_r), sigma_r = C r^(k-1) + D r^(-k-1), sigma_t = k (C r^(k-1) - D r^(-k-1)).
TEST(Orthotropic, a_ring_with_axes_along_its_circles_is_that_of_the_closed_form) {
  const double k = 2, p = 1e7, et = 40e9, nu_tr = 0.4;  // nu_rt E_t / E_r
  // sigma_r = -p at 1, 0 at 2: C = p / (4^k - 1), D = -4^k C.
  const double c = p / (std::pow(4, k) - 1), d = -std::pow(4, k) * c;
  const auto stress_at = [&](const Vec3& x) {
    const double r = x.norm(), sr = c * std::pow(r, k - 1) + d * std::pow(r, -k - 1);
    const double st = k * (c * std::pow(r, k - 1) - d * std::pow(r, -k - 1));
    const Vec3 e = x / r, t(-e[1], e[0], 0);
    return Tensor3(sr * e * e.transpose() + st * t * t.transpose());
  };
  const auto u_at = [&](const Vec3& x) {
    const double r = x.norm(), sr = c * std::pow(r, k - 1) + d * std::pow(r, -k - 1);
    const double st = k * (c * std::pow(r, k - 1) - d * std::pow(r, -k - 1));
    return Vec3((st - nu_tr * sr) / et * x);
  };
  const L2Errors coarse = l2_errors(*ring(8, MPI_COMM_WORLD), u_at, stress_at);
  const auto fine = ring(16, MPI_COMM_WORLD);
  const L2Errors e = l2_errors(*fine, u_at, stress_at);
  const double order = std::log2(coarse.displacement / e.displacement);
  RecordProperty("ring", fmt::format("u {:.2e}, order {:.2f}; stress {:.2e}, order {:.2f}", e.displacement,
                                     order, e.stress, std::log2(coarse.stress / e.stress)));
  EXPECT_GT(order, 1.8);
  EXPECT_LT(e.displacement, 0.01);
  EXPECT_LT(e.stress, 0.02);
  const double alone = audit_of(*ring(16, MPI_COMM_SELF)).strain_energy;
  EXPECT_NEAR(audit_of(*fine).strain_energy / alone, 1, 1e-8);
}

/// A beam of tetrahedra with its fibres askew, cantilevered, on these ranks.
double energy_of_beam(MPI_Comm comm) {
  SolidParameters p = ply_parameters(3);
  p.boundaries["xmin"] = clamped(3);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "1e5", "0"});
  Solid solid(distribute(comm, make_box(BoxCells::tetrahedra, {6, 2, 2}, Vec3::Zero(), Vec3(3, 1, 1))), p,
              SolidContext{});
  step(solid, 1);
  return audit_of(solid).strain_energy;
}

TEST(Orthotropic, ranks_agree_on_tetrahedra_whose_edges_share) {
  EXPECT_NEAR(energy_of_beam(MPI_COMM_WORLD) / energy_of_beam(MPI_COMM_SELF), 1, 1e-8);
}

// Undamped motion keeps its energy: the matrix stands in the kernel, in the mass step and in the energies alike.
TEST(Orthotropic, undamped_motion_keeps_its_energy) {
  SolidParameters p = ply_parameters(3);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.time_scheme.type = time::TimeScheme::trapezoidal;
  p.boundaries["xmin"] = clamped(3);
  p.initial_velocity = {{"x*y"}, {"x^2"}, {"0.5*x*sin(9*z)"}};
  auto solid = make_solid(distorted_box(BoxCells::tetrahedra), p);
  for (int i = 0; i < 10; ++i) step(*solid, 1e-4);
  RecordProperty("drift", fmt::format("{:.1e}", created_energy(*solid)));
  EXPECT_LT(std::abs(created_energy(*solid)), 1e-8);
}

TEST(Orthotropic, a_symmetry_plane_oblique_to_the_fibres_is_refused) {
  SolidParameters p = ply_parameters(2);
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["ymin"] = boundary(Type::symmetry);
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  EXPECT_THAT([&] { make_solid(raw, p); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("oblique to the axes")));
  p.material.orthotropic->first_axis = {};
  EXPECT_NO_THROW(make_solid(raw, p));
}

}  // namespace couplet::testing::orthotropic_test
