// SPDX-License-Identifier: Apache-2.0
// A linear displacement field has constant stress: the discrete equations must reproduce it exactly on any
// mesh.
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::patch_test {

class Patch : public ::testing::TestWithParam<CellsAndGradient> {
 protected:
  const mesh::BoxCells cells = std::get<0>(GetParam());
  const int dim = dimension_of(cells);
  SolidParameters parameters() const { return to_round_off(box_parameters(dim), std::get<1>(GetParam())); }
};
INSTANTIATE_TEST_SUITE_P(Solid, Patch, all_cells_and_gradients, name_of);

TEST_P(Patch, linear_field_is_exact_with_prescribed_displacement_all_around) {
  const LinearField field = general_field(dim);
  SolidParameters p = parameters();
  for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, field.text(dim));
  const auto solid = stepped(distorted_box(cells), p);
  expect_exact(*solid, field);
}

TEST_P(Patch, linear_field_is_exact_with_tractions) {
  const LinearField field = general_field(dim);
  SolidParameters p = parameters();
  const std::vector<std::pair<std::string, Vec3>> loaded{{"xmax", Vec3(1, 0, 0)},
                                                         {"ymin", Vec3(0, -1, 0)},
                                                         {"ymax", Vec3(0, 1, 0)},
                                                         {"zmin", Vec3(0, 0, -1)},
                                                         {"zmax", Vec3(0, 0, 1)}};
  for (const auto& [name, normal] : loaded)
    if (p.boundaries.contains(name))
      p.boundaries[name] = boundary(Type::traction, traction_text(p, field, normal));
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, field.text(dim));
  const auto solid = stepped(distorted_box(cells), p);
  expect_exact(*solid, field);
}

// Uniaxial stretch: xmin, ymin, zmin are symmetry planes, xmax is pulled, the others are free.
TEST_P(Patch, uniaxial_tension_on_symmetry_planes_is_exact) {
  SolidParameters p = parameters();
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
  const auto solid = stepped(distorted_box(cells), p);
  expect_exact(*solid, field);
}

TEST_P(Patch, small_rigid_rotation_and_translation_give_no_stress) {
  SolidParameters p = parameters();
  LinearField field{Tensor3::Zero()};
  field.slope(0, 1) = 1e-3;
  field.slope(1, 0) = -1e-3;
  if (dim == 3) field.slope(0, 2) = -2e-3, field.slope(2, 0) = 2e-3;
  std::vector<std::string> value = field.text(dim);
  for (std::string& text : value) text += " + 0.25";
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, value);
  const auto solid = stepped(distorted_box(cells), p);
  double largest = 0;
  for (const Tensor3& s : solid->fields().cell_stress(solid->fields().point_displacement()))
    largest = std::max(largest, s.norm());
  // Against the stress that a stretch of the same size would give.
  const double relative = parallel::max(MPI_COMM_WORLD, largest) / (p.material.youngs_modulus * 1e-3);
  RecordProperty("relative_stress", fmt::format("{:.3e}", relative));
  EXPECT_LT(relative, 1e-8);
}

TEST_P(Patch, reactions_balance_tractions_pressure_and_body_forces) {
  SolidParameters p = parameters();
  p.boundaries["xmin"] = clamped(dim);
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["xmax"] = boundary(Type::traction, {"1e6*y", "-3e5", "2e5*z"});
  if (dim == 2) p.boundaries["xmax"].value.pop_back();
  p.boundaries["ymax"] = pressed("4e5*(1 + x^2)");
  p.body_force = {{"1e5*sin(x)"}, {"-2e5*y"}, {"3e4"}};
  p.body_force.resize(dim);
  p.gravity = std::vector<double>(dim, -9.81);
  const auto solid = stepped(distorted_box(cells), p);
  Vec3 total = solid->fields().total_load();
  const double size = total.norm();
  for (const PatchForce& r : solid->fields().reactions(solid->fields().point_displacement()))
    total += r.force;
  EXPECT_GT(size, 1e4);
  EXPECT_LT(total.norm(), 1e-8 * size);
}

TEST(SolidBoundaries, wrong_patch_names_are_reported_with_those_that_exist) {
  SolidParameters p = box_parameters(2);
  p.boundaries.erase("ymax");
  const mesh::RawMesh raw =
      mesh::make_box(mesh::BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  EXPECT_THAT([&] { make_solid(raw, p); },
              ::testing::ThrowsMessage<Error>(
                  ::testing::AllOf(::testing::HasSubstr("patch 'ymax' of mesh 'box' has no entry"),
                                   ::testing::HasSubstr("The patches are xmin, xmax, ymin, ymax."))));
  p.boundaries["y-max"] = boundary(Type::free);
  EXPECT_THAT([&] { make_solid(raw, p); },
              ::testing::ThrowsMessage<Error>(::testing::AllOf(
                  ::testing::HasSubstr("boundaries.y-max: mesh 'box' has no patch with this name"),
                  ::testing::HasSubstr("Did you mean 'ymax'?"))));
}

}  // namespace couplet::testing::patch_test
