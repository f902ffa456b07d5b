// SPDX-License-Identifier: Apache-2.0
// The bulk modulus on the volume strain of faces, of cells, or shared between them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/elasticity/symmetric/symmetric_matrix.hpp"
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::volume_strain_test {
using namespace mesh;
namespace {

using Volume = MethodParameters::VolumeStrain;

SolidParameters with(Volume volume, int dim) {
  SolidParameters p = box_parameters(dim);
  p.method.face_gradient = FaceGradient::symmetric;
  p.method.volume_strain = volume;
  return p;
}

/// Upper corner of Cook's membrane of n x n quadrilaterals [mm], E = 250 MPa, sheared by 6.25 MPa.
double cook(int n, double nu, Volume volume, MPI_Comm comm = MPI_COMM_WORLD) {
  RawMesh raw = make_box(BoxCells::quadrilaterals, {n, n, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  for (Vec3& x : raw.points) x = Vec3(0.048 * x[0], 0.044 * x[0] + (0.044 - 0.028 * x[0]) * x[1], 0);
  SolidParameters p = with(volume, 2);
  p.material = {1000, 250e6, nu};
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
  p.boundaries["xmax"] = boundary(Type::traction, {"0", "6.25e6"});
  Solid solid(distribute(comm, raw), p, SolidContext{});
  step(solid, 1);
  double corner = 0;
  const std::vector<double> u = solid.fields().point_displacement();
  for (std::size_t v = 0; v < u.size() / 2; ++v)
    if ((solid.body().geometry().points[v] - Vec3(0.048, 0.06, 0)).norm() < 1e-9) corner = u[2 * v + 1];
  return 1e3 * parallel::max(comm, corner);
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
    const auto solid = make_solid(distorted_box(cells), p);
    step(*solid, 1);
    expect_exact(*solid, field);
  }
}

// What is assembled for factors is what the kernel applies where no face shares its strain with edges.
TEST(VolumeStrain, shared_is_assembled_as_it_is_applied) {
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra}) {
    SCOPED_TRACE(int(cells));
    const int dim = dimension_of(cells);
    SolidParameters p = with(Volume::shared, dim);
    p.boundaries["xmin"] = boundary(Type::fixed_displacement, std::vector<std::string>(dim, "0"));
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
  const auto solid = make_solid(raw, p);
  step(*solid, 1);
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
    p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "0"});
    const auto solid =
        make_solid(make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3(1, 1, 0)), p);
    for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
      EXPECT_NEAR(s(0, 0), -1e9 / (1 - 2 * 0.45) * 1e-4 * 10, 1) << int(volume);  // 3 K alpha dT
  }
}

}  // namespace
}  // namespace couplet::testing::volume_strain_test
