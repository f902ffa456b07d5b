// SPDX-License-Identifier: Apache-2.0
// The bulk modulus on the volume strain of faces, of cells, or shared between them.
#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "tests/support/saved_state.hpp"
#include "tests/verification/solid/linear_field.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing::volume_strain_test {
using namespace mesh;
using Volume = MethodParameters::VolumeStrain;
using Preconditioner = MethodParameters::Preconditioner;

SolidParameters with(Volume volume, int dim) {
  SolidParameters p = box_parameters(dim);
  p.method.face_gradient = FaceGradient::symmetric;
  p.method.volume_strain = volume;
  return p;
}

/// Upper corner of Cook's membrane of n x n quadrilaterals [mm], E = 250 MPa, sheared by 6.25 MPa.
double cook(int n, double nu, Volume volume, MPI_Comm comm = MPI_COMM_WORLD) {
  SolidParameters p = with(volume, 2);
  p.material = {1000, 250e6, nu};
  p.boundaries["xmin"] = clamped(2);
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "6.25e6"});
  return 1e3 * displacement_at(*stepped(cooks_membrane(n), p, comm), Vec3(0.048, 0.06, 0))[1];
}

TEST(VolumeStrain, shared_keeps_linear_fields_exact) {
  for (const BoxCells cells :
       {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::tetrahedra, BoxCells::mixed}) {
    SCOPED_TRACE(int(cells));
    const int dim = dimension_of(cells);
    SolidParameters p = to_round_off(with(Volume::shared, dim), FaceGradient::symmetric);
    const LinearField field = general_field(dim);
    p.boundaries["xmin"] = p.boundaries["ymin"] = boundary(Type::fixed_displacement, field.text(dim));
    p.boundaries["xmax"] = boundary(Type::traction, traction_text(p, field, Vec3(1, 0, 0)));
    p.boundaries["ymax"] = boundary(Type::traction, traction_text(p, field, Vec3(0, 1, 0)));
    if (dim == 3) p.boundaries["zmin"] = p.boundaries["zmax"] = p.boundaries["xmin"];
    const auto solid = stepped(distorted_box(cells), p);
    expect_exact(*solid, field);
  }
}

// What is assembled for factors is what the kernel applies where no face shares its strain with edges.
TEST(VolumeStrain, shared_is_assembled_as_it_is_applied) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra}) {
    SCOPED_TRACE(int(cells));
    const int dim = dimension_of(cells);
    SolidParameters p = with(Volume::shared, dim);
    p.boundaries["xmin"] = clamped(dim);
    const auto solid = make_solid(distorted_box(cells), p);
    const linalg::SparseMatrix matrix =
        elastic::symmetric_matrix(solid->body().mesh(), solid->body().elastic(), {});
    const std::size_t n = solid->body().elastic().n_unknowns();
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> any_value(-1, 1);
    std::vector<double> u(n), applied(n), assembled(n);
    for (double& v : u) v = any_value(generator);
    solid->body().kernel().apply(u, {}, applied);
    matrix.multiply(u, assembled);
    double gap = 0, size = 0;
    for (std::size_t i = 0; i < n; ++i) {
      gap = std::max(gap, std::abs(applied[i] - assembled[i]));
      size = std::max(size, std::abs(applied[i]));
    }
    EXPECT_LT(gap, 1e-12 * size);
  }
}

// 9.044 mm at nu = 1/3 by refined quadratic finite elements; each of the two alone fails beside it.
TEST(VolumeStrain, shared_bends_cook_best_at_nu_one_third) {
  const double exact = 9.044;
  EXPECT_NEAR(cook(16, 1. / 3, Volume::shared), exact, 0.0015 * exact);
  EXPECT_LT(cook(16, 1. / 3, Volume::faces), 0.995 * exact);
  EXPECT_GT(cook(16, 1. / 3, Volume::cells), 1.002 * exact);
}

TEST(VolumeStrain, shared_does_not_lock_near_incompressibility) {
  const double exact = 7.771;  // nu = 0.4999
  EXPECT_NEAR(cook(16, 0.4999, Volume::shared), exact, 0.01 * exact);
  EXPECT_LT(cook(16, 0.4999, Volume::faces), 0.9 * exact);
}

TEST(VolumeStrain, ranks_agree) {
  const double whole = cook(8, 0.4, Volume::shared, MPI_COMM_SELF), parts = cook(8, 0.4, Volume::shared);
  EXPECT_NEAR(parts, whole, 1e-8 * whole);
}

/// Largest stress of a body that is free to expand under T = 40 x, over E alpha dT, which is 0 but along z in plane
/// strain; its face at x = 0 is held where it goes.
double stress_of_free_expansion(BoxCells cells, double nu, Volume volume) {
  const int dim = dimension_of(cells);
  const double modulus = 1e9, alpha = 1e-4, gradient = 40,
               stretch = (dim == 2 ? 1 + nu : 1) * alpha * gradient;
  SolidParameters p = with(volume, dim);
  p.material = {1000, modulus, nu};
  p.material.heat.expansion = {fmt::format("{}", alpha)};
  p.temperature = {fmt::format("{}*x", gradient)};
  p.expansion.emplace().reference_temperature = 0;
  p.boundaries["xmin"] =
      dim == 2
          ? boundary(Type::fixed_displacement, {fmt::format("{:.17g}*(x^2-y^2)/2", stretch), "0"})
          : boundary(Type::fixed_displacement, {fmt::format("{:.17g}*(x^2-y^2-z^2)/2", stretch), "0", "0"});
  const RawMesh raw = make_box(cells, {8, 4, dim == 3 ? 3 : 1}, Vec3::Zero(), Vec3(2, 1, dim == 3 ? 1 : 0));
  const auto solid = stepped(raw, p);
  double most = 0;
  for (Tensor3 s : solid->fields().cell_stress(solid->fields().point_displacement())) {
    if (dim == 2) s(2, 2) = 0;
    most = std::max(most, s.cwiseAbs().maxCoeff());
  }
  return parallel::max(MPI_COMM_WORLD, most) / (modulus * alpha * 2 * gradient);
}

// Where each face's own temperature pulled on one volume strain a cell: 27 on quadrilaterals at nu 0.4999. What is left is the
// error of the mesh; prisms lock a little.
TEST(VolumeStrain, a_varying_temperature_leaves_a_free_body_without_stress) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                               BoxCells::tetrahedra, BoxCells::prisms})
    for (const double nu : {0.45, 0.4999}) {
      if (nu < 0.49 && dimension_of(cells) == 3) continue;  // time
      for (const Volume volume : {Volume::cells, Volume::shared}) {
        const double stress = stress_of_free_expansion(cells, nu, volume);
        fmt::print("{} nu {} {}: {:.2e}\n", int(cells), nu, volume == Volume::cells ? "cells" : "shared",
                   stress);
        EXPECT_LT(stress, cells == BoxCells::prisms ? 0.15 : 0.03) << int(cells) << " nu " << nu;
      }
    }
}

// The constants of a table come after the effects are made: the stress of what heat strains at the start had those without it.
TEST(VolumeStrain, heat_strains_at_the_start_by_the_constants_of_tables) {
  for (const Volume volume : {Volume::cells, Volume::faces}) {
    SolidParameters p = with(volume, 2);
    p.material = {1000, 2e9, 0.45};
    p.material.heat.expansion = {"1e-4"};
    p.material.heat.youngs_modulus = config::ExpressionText{"1e9"};
    p.temperature = {"10"};
    p.expansion.emplace().reference_temperature = 0;
    p.boundaries["xmin"] = clamped(2);
    const auto solid =
        make_solid(make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3(1, 1, 0)), p);
    for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
      EXPECT_NEAR(s(0, 0), -1e9 / (1 - 2 * 0.45) * 1e-4 * 10, 1) << int(volume);  // 3 K alpha dT
  }
}

// Mean stresses of cells as unknowns beside the displacements: the answer of factors, in iterations that nu hardly changes.

SolidParameters nearly_incompressible(int dim, double nu, Preconditioner by) {
  SolidParameters p = box_parameters(dim);
  p.material = {1000, 1e6, nu};
  p.method.face_gradient = FaceGradient::symmetric;
  p.method.volume_strain = MethodParameters::VolumeStrain::cells;
  p.method.preconditioner = by;
  p.method.relative_tolerance = 1e-10;
  p.boundaries["xmin"] = clamped(dim);
  p.boundaries["xmax"] = boundary(Type::traction, dim == 2 ? std::vector<std::string>{"0", "1e3"}
                                                           : std::vector<std::string>{"0", "1e3", "500"});
  return p;
}

RawMesh body(BoxCells cells, int n) {
  const bool is_flat = dimension_of(cells) == 2;
  RawMesh raw = make_box(cells, {2 * n, n, is_flat ? 1 : n}, Vec3::Zero(), Vec3(1, 1, is_flat ? 0 : 1));
  for (Vec3& x : raw.points) x = Vec3(2 * x[0], x[1] * (1 - 0.2 * x[0]) + 0.3 * x[0], x[2]);
  return raw;
}

struct Answer {
  std::vector<double> u;
  int iterations = 0;
};

Answer solved(const RawMesh& raw, const SolidParameters& p, MPI_Comm comm = MPI_COMM_WORLD) {
  Solid solid(distribute(comm, raw), p, SolidContext{});
  step(solid, 0.02);
  if (p.analysis == SolidParameters::Analysis::dynamic) step(solid, 0.02);
  const Mesh& mesh = solid.body().mesh();
  const Geometry& geometry = solid.body().geometry();
  // The same numbers on any count of ranks: moments of the displacements.
  Answer answer;
  const std::vector<double>& u = solid.stepper().state().cell_u;
  for (int a = 0; a < mesh.dim; ++a)
    for (int k = 0; k < 4; ++k) {
      double moment = 0;
      for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
        const Vec3& x = geometry.cell_centre[c];
        const std::array<double, 4> weights{1, x[0], x[1], std::sin(7 * x[0]) * std::cos(5 * x[1])};
        moment += weights[std::size_t(k)] * u[std::size_t(c) * std::size_t(mesh.dim) + std::size_t(a)];
      }
      answer.u.push_back(parallel::sum(mesh.comm, moment));
    }
  answer.iterations = solid.stepper().effort().iterations;
  return answer;
}

double gap(const Answer& a, const Answer& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.u.size(); ++i) {
    difference = std::max(difference, std::abs(a.u[i] - b.u[i]));
    size = std::max(size, std::abs(b.u[i]));
  }
  return difference / size;
}

constexpr std::array kinds{BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                           BoxCells::mixed};

TEST(MixedForm, gives_what_factors_give) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  for (const BoxCells cells : kinds) {
    SCOPED_TRACE(int(cells));
    const int dim = dimension_of(cells);
    const RawMesh raw = body(cells, dim == 2 ? 6 : 3);
    EXPECT_LT(gap(solved(raw, nearly_incompressible(dim, 0.4999, Preconditioner::mixed)),
                  solved(raw, nearly_incompressible(dim, 0.4999, Preconditioner::factors))),
              1e-7);
  }
}

// Also where some of the bulk modulus stays with the faces, and in steps in which inertia rules.
TEST(MixedForm, of_shared_volume_strain_and_of_motion) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  for (const bool moves : {false, true}) {
    std::array<SolidParameters, 2> p{nearly_incompressible(2, 0.4999, Preconditioner::mixed),
                                     nearly_incompressible(2, 0.4999, Preconditioner::factors)};
    for (SolidParameters& q : p) {
      if (moves)
        q.analysis = SolidParameters::Analysis::dynamic;
      else
        q.method.volume_strain = MethodParameters::VolumeStrain::shared;
    }
    const RawMesh raw = body(moves ? BoxCells::triangles : BoxCells::quadrilaterals, 6);
    EXPECT_LT(gap(solved(raw, p[0]), solved(raw, p[1])), 1e-7);
  }
}

// Conjugate gradients without pressures have no end there.
TEST(MixedForm, iterations_hardly_grow_as_nu_goes_to_one_half) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  const RawMesh raw = body(BoxCells::quadrilaterals, 16);
  const auto iterations = [&](double nu) {
    return solved(raw, nearly_incompressible(2, nu, Preconditioner::mixed)).iterations;
  };
  const int far = iterations(1. / 3), near = iterations(0.4999);
  RecordProperty("far", far);
  RecordProperty("near", near);
  EXPECT_LT(near, 2 * far);
  SolidParameters without = nearly_incompressible(2, 0.4999, Preconditioner::multigrid);
  without.method.max_iterations = 10 * near;
  EXPECT_THROW(solved(raw, without), Error);
}

TEST(MixedForm, ranks_agree) {
  for (const BoxCells cells : {BoxCells::triangles, BoxCells::hexahedra}) {
    SCOPED_TRACE(int(cells));
    const SolidParameters p = nearly_incompressible(dimension_of(cells), 0.4999, Preconditioner::mixed);
    const RawMesh raw = body(cells, cells == BoxCells::triangles ? 4 : 2);
    EXPECT_LT(gap(solved(raw, p), solved(raw, p, MPI_COMM_SELF)), 1e-8);
  }
}

// Two steps, the second from what was saved after the first.
TEST(MixedForm, goes_on_bit_for_bit) {
  SolidParameters p = nearly_incompressible(2, 0.4999, Preconditioner::mixed);
  p.analysis = SolidParameters::Analysis::dynamic;
  expect_same_after_restart(body(BoxCells::quadrilaterals, 4), p, 0.02, 0.02);
}

TEST(MixedForm, is_refused_without_mean_stresses_of_cells) {
  if (parallel::comm_size(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "on one rank";
  SolidParameters p = nearly_incompressible(2, 0.3, Preconditioner::mixed);
  p.method.volume_strain = MethodParameters::VolumeStrain::faces;
  EXPECT_THROW(solved(body(BoxCells::quadrilaterals, 2), p), Error);
  p = nearly_incompressible(2, 0.3, Preconditioner::mixed);
  p.method.face_gradient = FaceGradient::thesis;
  EXPECT_THROW(solved(body(BoxCells::quadrilaterals, 2), p), Error);
}

}  // namespace couplet::testing::volume_strain_test
