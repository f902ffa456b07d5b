// SPDX-License-Identifier: Apache-2.0
// Large strain as nu goes to 1/2: Cook's membrane in one load step, a ring of rubber under a pressure that follows its
// wall, motion; pressures carried along by Newton's method.
#include "common/elasticity/finite/finite_kernel.hpp"
#include "solid_solver/equilibrium/finite_strain.hpp"
#include "solid_solver/laws/laws.hpp"
#include "tests/verification/solid/finite_support.hpp"

namespace couplet::testing::incompressible_test {
using namespace mesh;

SolidParameters rubber(int dim, const std::string& law, double modulus, double nu) {
  SolidParameters p = box_parameters(dim);
  p.kinematics = SolidParameters::Kinematics::finite_strain;
  p.material = {1000, modulus, nu};
  p.material.law = law;
  return p;
}

/// Cook's membrane at nu 0.4999, mu 0.4225 MPa, sheared by 62.5 kPa in `steps` load steps.
std::unique_ptr<Solid> cook(int n, int steps, MPI_Comm comm = MPI_COMM_WORLD) {
  SolidParameters p = rubber(2, "nearly-incompressible-neo-hookean", 1.267e6, 0.4999);
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "62.5e3*t"});
  auto solid = make_solid(cooks_membrane(n), p, comm);
  for (int i = 0; i < steps; ++i) step(*solid, 1.0 / steps);
  return solid;
}

TEST(Incompressible, cook_takes_one_load_step_and_few_iterations) {
  const Vec3 corner(0.048, 0.06, 0);
  const bool alone = parallel::comm_size(MPI_COMM_WORLD) == 1;
  const int n = alone ? 16 : 8;
  const auto once = cook(n, 1);
  EXPECT_LE(once->stepper().effort().iterations, 8);
  const double u = displacement_at(*once, corner)[1];
  RecordProperty("corner_mm", fmt::format("{:.4f}", 1e3 * u));
  EXPECT_NEAR(displacement_at(*cook(n, 1, MPI_COMM_SELF), corner)[1] / u, 1, 1e-7);
  EXPECT_NEAR(1e3 * u, alone ? 11.557 : 11.583, 0.01);  // 11.52 on 64 x 64
  // Equilibrium does not depend on the way to it.
  if (alone) {
    EXPECT_NEAR(displacement_at(*cook(n, 5), corner)[1] / u, 1, 1e-7);
  }
}

/// Quarter of a ring 1 to 2 of Mooney-Rivlin's law, plane strain, under `load` inside that follows the wall.
std::unique_ptr<Solid> ring(int n, double load, double nu = 0.49999) {
  SolidParameters p = rubber(2, "mooney-rivlin", 3e6, nu);  // mu about 1 MPa
  p.material.law_coefficients = {0.2};
  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
  p.boundaries["xmin"] = pressed(fmt::format("{:.17g}*t", load));
  auto solid = make_solid(quarter_ring(BoxCells::quadrilaterals, n, 2 * n), p);
  step(*solid, 0.5);
  step(*solid, 0.5);
  return solid;
}

/// p / mu = ln(la / lb) + (1 / lb^2 - 1 / la^2) / 2 of an incompressible ring, la, lb the stretches of its walls,
/// R^2 (l^2 - 1) being the same at both.
double pressure_over_mu(double inner) {
  const double outer = std::sqrt(1 + (inner * inner - 1) / 4);
  return std::log(inner / outer) + (1 / (outer * outer) - 1 / (inner * inner)) / 2;
}

TEST(Incompressible, a_ring_under_a_pressure_that_follows_is_that_of_the_closed_form) {
  const double mu = 3e6 / (2 * 1.49999), inner = 1.5, load = mu * pressure_over_mu(inner);
  std::vector<double> errors;
  for (const int n : {8, 16, 32}) {
    if (n == 32 && parallel::comm_size(MPI_COMM_WORLD) > 1) break;
    const auto solid = ring(n, load);
    errors.push_back(displacement_at(*solid, Vec3(1, 0, 0))[0] / (inner - 1) - 1);
    RecordProperty(fmt::format("error_{}", n), fmt::format("{:.3e}", errors.back()));
    if (n == 16) {
      std::string tail;
      for (const NewtonIterate& i : solid->body().finite_strain()->iterates())
        tail += fmt::format(" {:.1e}", i.residual);
      RecordProperty("newton", tail);
      // Quadratic: one more correction squares what the last has left, until only rounding is.
      const auto& it = solid->body().finite_strain()->iterates();
      double order = 0;
      for (std::size_t i = 2; i < it.size(); ++i)
        if (it[i - 1].residual < 0.1 && it[i].residual > 0)
          order = std::log(it[i].residual) / std::log(it[i - 1].residual);
      RecordProperty("newton_order", fmt::format("{:.2f}", order));
      EXPECT_GT(order, 1.7);
    }
  }
  const double order = std::log2(errors[0] / errors[1]);
  RecordProperty("order", fmt::format("{:.2f}", order));
  if (errors.size() > 2)
    RecordProperty("order_fine", fmt::format("{:.2f}", std::log2(errors[1] / errors[2])));
  EXPECT_GT(order, 1.8);
  EXPECT_LT(std::abs(errors[1]), 0.003);
}

/// |w . K v - v . K w| over the larger of them for two rough fields, K the tangent of a pressed and deformed ring; all of
/// its inner wall pressed, or the half above the diagonal.
double asymmetry(bool whole_wall) {
  const auto solid = ring(8, 3e5, 0.49);
  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  const auto law =
      laws::find("mooney-rivlin")->make(lame_constants(solid->body().parameters()), std::vector{0.2});
  const auto kernel =
      std::make_unique<elastic::FiniteKernel>(mesh, solid->body().elastic(), std::vector{law});
  std::vector<double> pressure(std::size_t(mesh.boundary.n_owned()), 0);
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    const Vec3& x = geometry.face_centre[f];
    if (mesh.owner[f] < mesh.cells.n_owned() && x.norm() < 1.01 && (whole_wall || x[1] > x[0]))
      pressure[std::size_t(f - mesh.n_interior)] = 3e5;
  }
  kernel->set_pressure(pressure);
  const std::size_t n = solid->body().elastic().n_unknowns();
  std::vector<double> u(n), v(n), w(n), kv(n), kw(n);
  for (std::size_t i = 0; i < n; ++i) {
    u[i] = 0.02 * std::sin(0.1 * double(i));
    v[i] = std::sin(double(i * i));
    w[i] = std::cos(3.0 * double(i * i));
  }
  kernel->linearise(u, {}, 0, kv);
  kernel->apply_tangent(v, {}, 0, kv);
  kernel->apply_tangent(w, {}, 0, kw);
  return std::abs(dot(w, kv) - dot(v, kw)) / std::sqrt(dot(kv, kv) * dot(w, w));
}

// A pressure on a wall that ends on planes of symmetry has an energy; one that stops amid a free wall has none.
TEST(Incompressible, tangent_of_the_pressure_is_symmetric_where_the_wall_is_closed) {
  const double closed = asymmetry(true), open = asymmetry(false);
  RecordProperty("closed", fmt::format("{:.1e}", closed));
  RecordProperty("open", fmt::format("{:.1e}", open));
  EXPECT_LT(closed, 1e-13);
  EXPECT_GT(open, 1e3 * closed);
}

// The body bends over itself in a second, nu 0.4999: no pressure runs away.
TEST(Incompressible, a_swinging_column_keeps_its_energy) {
  SolidParameters p = rubber(3, "nearly-incompressible-neo-hookean", 17e6, 0.4999);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.time_scheme.type = time::TimeScheme::trapezoidal;
  p.boundaries["ymin"] = clamped(3);
  p.initial_velocity = {{"10*y/6"}, {"0"}, {"0"}};
  auto solid = make_solid(make_box(BoxCells::hexahedra, {2, 8, 2}, Vec3::Zero(), Vec3(1, 6, 1)), p);
  for (int i = 0; i < 10; ++i) {
    step(*solid, 0.004);
    EXPECT_LE(solid->stepper().effort().iterations, 8);
  }
  RecordProperty("created", fmt::format("{:.1e}", created_energy(*solid)));
  EXPECT_LT(std::abs(created_energy(*solid)), 0.02);
}

}  // namespace couplet::testing::incompressible_test
