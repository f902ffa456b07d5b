// SPDX-License-Identifier: Apache-2.0
// A linear displacement field has constant stress: the discrete equations must reproduce it exactly on any
// mesh.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "tests/verification/solid/support.hpp"

namespace couplet::testing {
namespace {

/// u = slope^T x: entry (i, j) is d u_j / d x_i.
struct LinearField {
  Tensor3 slope;
  Vec3 at(const Vec3& x) const { return slope.transpose() * x; }
  std::vector<std::string> text(int dim) const {
    std::vector<std::string> result;
    for (int j = 0; j < dim; ++j)
      result.push_back(
          fmt::format("{:.17g}*x + {:.17g}*y + {:.17g}*z", slope(0, j), slope(1, j), slope(2, j)));
    return result;
  }
};

LinearField general_field(int dim) {
  LinearField field;
  field.slope << 1.1e-3, -0.4e-3, 0.7e-3, 0.9e-3, 0.6e-3, -0.3e-3, -0.5e-3, 0.8e-3, 1.3e-3;
  if (dim == 2) field.slope.row(2).setZero(), field.slope.col(2).setZero();
  return field;
}

std::vector<std::string> traction_text(const SolidParameters& p, const LinearField& field, const Vec3& n) {
  const LameConstants lame = lame_constants(p);
  const Tensor3 stress = lame.mu * (field.slope + field.slope.transpose()) +
                         lame.lambda * field.slope.trace() * Tensor3::Identity();
  const Vec3 traction = stress * n;
  std::vector<std::string> result;
  for (int c = 0; c < p.dimension; ++c) result.push_back(fmt::format("{:.17g}", traction[c]));
  return result;
}

RawMesh distorted_box(BoxCells cells) {
  RawMesh raw = make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  perturb_interior(raw, 0.25, 11);
  return raw;
}

/// Largest error of cells, points and traction faces over the largest displacement.
double relative_error(const Solid& solid, const LinearField& field) {
  const Mesh& mesh = solid.mesh();
  const int dim = mesh.dim;
  double error = 0, size = 0;
  const auto compare = [&](std::span<const double> values, Index i, const Vec3& x) {
    for (int a = 0; a < dim; ++a) {
      error = std::max(error, std::abs(values[std::size_t(i) * dim + a] - field.at(x)[a]));
      size = std::max(size, std::abs(field.at(x)[a]));
    }
  };
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    compare(solid.state().cell_u, c, mesh.reference.cell_centre[c]);
  const std::vector<double> points = solid.point_displacement();
  for (Index v = 0; v < mesh.points.n_local(); ++v) compare(points, v, mesh.reference_points[v]);
  for (const Index f : solid.elastic().traction_faces())
    compare(solid.state().face_u, f - mesh.n_interior, mesh.reference.face_centre[f]);
  return max(mesh.comm, error) / max(mesh.comm, size);
}

/// Largest error of the stress over the largest stress.
double relative_stress_error(const Solid& solid, const LinearField& field) {
  const Tensor3 exact = solid.elastic().stress(field.slope);
  double error = 0;
  const int dim = solid.mesh().dim;
  for (const Tensor3& s : solid.cell_stress(solid.point_displacement()))
    error = std::max(error, (s - exact).topLeftCorner(dim, dim).norm());
  return max(solid.mesh().comm, error) / exact.norm();
}

void expect_exact(const Solid& solid, const LinearField& field) {
  const double error = relative_error(solid, field), stress_error = relative_stress_error(solid, field);
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  ::testing::Test::RecordProperty("relative_stress_error", fmt::format("{:.3e}", stress_error));
  EXPECT_LT(error, 1e-10);
  EXPECT_LT(stress_error, 1e-10);
}

class Patch : public ::testing::TestWithParam<BoxCells> {};
INSTANTIATE_TEST_SUITE_P(Solid, Patch,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::tetrahedra, BoxCells::prisms, BoxCells::mixed));

TEST_P(Patch, linear_field_is_exact_with_prescribed_displacement_all_around) {
  const int dim = dimension_of(GetParam());
  const LinearField field = general_field(dim);
  SolidParameters p = box_parameters(dim);
  for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, field.text(dim));
  const auto solid = make_solid(distorted_box(GetParam()), p);
  step(*solid, 1);
  expect_exact(*solid, field);
}

TEST_P(Patch, linear_field_is_exact_with_tractions) {
  const int dim = dimension_of(GetParam());
  const LinearField field = general_field(dim);
  SolidParameters p = box_parameters(dim);
  const std::vector<std::pair<std::string, Vec3>> loaded{{"xmax", Vec3(1, 0, 0)},
                                                         {"ymin", Vec3(0, -1, 0)},
                                                         {"ymax", Vec3(0, 1, 0)},
                                                         {"zmin", Vec3(0, 0, -1)},
                                                         {"zmax", Vec3(0, 0, 1)}};
  for (const auto& [name, normal] : loaded)
    if (p.boundaries.contains(name))
      p.boundaries[name] = boundary(Type::traction, traction_text(p, field, normal));
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, field.text(dim));
  const auto solid = make_solid(distorted_box(GetParam()), p);
  step(*solid, 1);
  expect_exact(*solid, field);
}

// Uniaxial stretch: xmin, ymin, zmin are symmetry planes, xmax is pulled, the others are free.
TEST_P(Patch, uniaxial_tension_on_symmetry_planes_is_exact) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = box_parameters(dim);
  if (dim == 2) p.plane = SolidParameters::Plane::stress;
  for (const char* name : {"xmin", "ymin", "zmin"})
    if (p.boundaries.contains(name)) p.boundaries[name] = boundary(Type::symmetry);
  SolidBoundary suction;
  suction.type = Type::pressure;
  suction.pressure = {"-1e8"};
  p.boundaries["xmax"] = suction;
  LinearField field{Tensor3::Zero()};
  const double strain = 1e8 / p.material.youngs_modulus;
  field.slope.diagonal() = Vec3(strain, -0.3 * strain, dim == 3 ? -0.3 * strain : 0);
  const auto solid = make_solid(distorted_box(GetParam()), p);
  step(*solid, 1);
  expect_exact(*solid, field);
}

TEST_P(Patch, small_rigid_rotation_and_translation_give_no_stress) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = box_parameters(dim);
  LinearField field{Tensor3::Zero()};
  field.slope(0, 1) = 1e-3;
  field.slope(1, 0) = -1e-3;
  if (dim == 3) field.slope(0, 2) = -2e-3, field.slope(2, 0) = 2e-3;
  std::vector<std::string> value = field.text(dim);
  for (std::string& text : value) text += " + 0.25";
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, value);
  const auto solid = make_solid(distorted_box(GetParam()), p);
  step(*solid, 1);
  double largest = 0;
  for (const Tensor3& s : solid->cell_stress(solid->point_displacement()))
    largest = std::max(largest, s.norm());
  // Against the stress that a stretch of the same size would give.
  EXPECT_LT(max(MPI_COMM_WORLD, largest) / (p.material.youngs_modulus * 1e-3), 1e-8);
}

TEST_P(Patch, reactions_balance_tractions_pressure_and_body_forces) {
  const int dim = dimension_of(GetParam());
  SolidParameters p = box_parameters(dim);
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, std::vector<std::string>(dim, "0"));
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"1e6*y", "-3e5", "2e5*z"});
  if (dim == 2) p.boundaries["xmax"].value.pop_back();
  p.boundaries["ymax"].type = Type::pressure;
  p.boundaries["ymax"].pressure = {"4e5*(1 + x^2)"};
  p.body_force = {{"1e5*sin(x)"}, {"-2e5*y"}, {"3e4"}};
  p.body_force.resize(dim);
  p.gravity = std::vector<double>(dim, -9.81);
  const auto solid = make_solid(distorted_box(GetParam()), p);
  step(*solid, 1);
  Vec3 total = solid->total_load();
  const double size = total.norm();
  for (const PatchForce& r : solid->reactions(solid->point_displacement())) total += r.force;
  EXPECT_GT(size, 1e4);
  EXPECT_LT(total.norm(), 1e-8 * size);
}

TEST(SolidBoundaries, wrong_patch_names_are_reported_with_those_that_exist) {
  SolidParameters p = box_parameters(2);
  p.boundaries.erase("ymax");
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  EXPECT_THAT([&] { make_solid(raw, p); },
              ::testing::ThrowsMessage<Error>(
                  ::testing::AllOf(::testing::HasSubstr("patch 'ymax' of mesh 'box' has no entry"),
                                   ::testing::HasSubstr("The patches are xmin, xmax, ymin, ymax."))));
  p.boundaries["y-max"] = boundary(Type::free);
  EXPECT_THAT([&] { make_solid(raw, p); },
              ::testing::ThrowsMessage<Error>(::testing::AllOf(
                  ::testing::HasSubstr("boundaries.y-max: mesh 'box' has no patch of this name"),
                  ::testing::HasSubstr("Did you mean 'ymax'?"))));
}

TEST(SolidBoundaries, a_static_solid_without_support_is_refused) {
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  EXPECT_THAT([&] { make_solid(raw, box_parameters(2)); },
              ::testing::ThrowsMessage<Error>(::testing::HasSubstr("a static analysis needs a support")));
}

}  // namespace
}  // namespace couplet::testing
