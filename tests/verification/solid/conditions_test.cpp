// SPDX-License-Identifier: Apache-2.0
// Conditions on patches and parts of them: a linear field that fulfils them must be reproduced exactly on any
// mesh.
#include <Eigen/Geometry>

#include "tests/support/apart.hpp"
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::conditions_test {
using namespace mesh;

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::vector<std::pair<std::string, Vec3>> sides{{"xmin", Vec3(-1, 0, 0)}, {"xmax", Vec3(1, 0, 0)},
                                                      {"ymin", Vec3(0, -1, 0)}, {"ymax", Vec3(0, 1, 0)},
                                                      {"zmin", Vec3(0, 0, -1)}, {"zmax", Vec3(0, 0, 1)}};

SolidBoundary some_components(const LinearField& field, int dim, const std::string& axes,
                              const std::vector<std::string>& traction) {
  SolidBoundary b;
  b.type = Type::fixed_displacement;
  for (const char axis : axes)
    if (axis - 'x' < dim) b.components[axis - 'x'] = {field.text(dim)[axis - 'x']};
  for (const std::string& text : traction) b.traction.push_back({text});
  return b;
}

/// All sides pulled as the field wants it.
SolidParameters pulled_box(const LinearField& field, int dim) {
  SolidParameters p = box_parameters(dim);
  for (const auto& [name, n] : sides)
    if (p.boundaries.contains(name))
      p.boundaries[name] = boundary(Type::traction, traction_text(p, field, n));
  return p;
}

class Conditions : public ::testing::TestWithParam<CellsAndGradient> {
 protected:
  const BoxCells cells = std::get<0>(GetParam());
  const int dim = dimension_of(cells);
  const LinearField field = general_field(dim);
  std::unique_ptr<Solid> make(const RawMesh& raw, const SolidParameters& p) const {
    return make_solid(raw, to_round_off(p, std::get<1>(GetParam())));
  }
  void expect_exact_after_a_step(const SolidParameters& p, const LinearField& wanted) const {
    const auto solid = make(distorted_box(cells), p);
    EXPECT_THAT(solid->body().elastic().vertices().inexact_points(), ::testing::IsEmpty());
    step(*solid, 1);
    expect_exact(*solid, wanted);
  }
};
INSTANTIATE_TEST_SUITE_P(Solid, Conditions, all_cells_and_gradients, name_of);

TEST_P(Conditions, displacement_by_component_with_traction_on_the_rest_is_exact) {
  SolidParameters p = pulled_box(field, dim);
  const auto traction = [&](const char* side) {
    const auto found = std::ranges::find(sides, side, &std::pair<std::string, Vec3>::first);
    return traction_text(p, field, found->second);
  };
  p.boundaries["xmin"] = some_components(field, dim, "xy", traction("xmin"));
  p.boundaries["ymin"] = some_components(field, dim, "y", traction("ymin"));
  if (dim == 3) {
    p.boundaries["xmin"] = some_components(field, dim, "xz", traction("xmin"));
    p.boundaries["zmin"] = some_components(field, dim, "z", traction("zmin"));
    p.boundaries["zmax"] = some_components(field, dim, "yz", traction("zmax"));
  }
  expect_exact_after_a_step(p, field);
}

TEST_P(Conditions, springs_with_displaced_far_ends_are_exact) {
  SolidParameters p = pulled_box(field, dim);
  const double stiffness = 7e10;
  const auto displacement = field.text(dim);
  // sigma . n + k (u - g) = T with T = (1, 2, 3) MPa.
  for (const char* side : {"xmin", "ymax"}) {
    const auto n = std::ranges::find(sides, side, &std::pair<std::string, Vec3>::first)->second;
    const auto force = traction_text(p, field, n);
    SolidBoundary spring;
    spring.type = Type::spring;
    spring.stiffness = {fmt::format("{}", stiffness)};
    for (int a = 0; a < dim; ++a) {
      spring.traction.push_back({fmt::format("{}e6", a + 1)});
      spring.value.push_back(
          {fmt::format("{} + (({}) - {}e6)/{}", displacement[a], force[a], a + 1, stiffness)});
    }
    p.boundaries[side] = spring;
  }
  expect_exact_after_a_step(p, field);
}

TEST_P(Conditions, normal_springs_hold_along_the_normal_only) {
  // Pressed against springs on xmax between frictionless planes: shortens by E-modulus, moves by p / k.
  SolidParameters p = box_parameters(dim);
  for (auto& [name, b] : p.boundaries) b = boundary(Type::frictionless);
  p.boundaries["xmin"] = pressed("3e6");
  p.boundaries["xmax"] = sprung("6e9");
  p.boundaries["xmax"].along_normal = true;
  const auto solid = make(distorted_box(cells), p);
  step(*solid, 1);
  const elastic::LameConstants lame = lame_constants(p);
  const double strain = -3e6 / (lame.lambda + 2 * lame.mu);
  const std::vector<Vec3>& places = solid->body().geometry().points;
  double error = 0;
  const std::vector<double> points = solid->fields().point_displacement();
  for (std::size_t v = 0; v < places.size(); ++v) {
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < dim; ++a) u[a] = points[v * dim + a];
    error = std::max(error, (u - Vec3(5e-4 + strain * (places[v][0] - 1), 0, 0)).norm());
  }
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, error), 1e-10 * 5e-4);
  for (const PatchForce& r : solid->fields().reactions(points))
    if (r.patch == "xmax") {
      EXPECT_NEAR(r.force[0], -3e6 * 0.8 * (dim == 3 ? 0.6 : 1), 1e-3);
    }
}

TEST_P(Conditions, zero_normal_gradient_is_exact_for_fields_that_do_not_change_along_the_normal) {
  LinearField constant_along_x = field;
  constant_along_x.slope.row(0).setZero();
  SolidParameters p = pulled_box(constant_along_x, dim);
  p.boundaries["xmax"] = boundary(Type::zero_normal_gradient);
  p.boundaries["ymin"] = boundary(Type::fixed_displacement, constant_along_x.text(dim));
  if (!symmetric_refuses(GetParam(), p)) expect_exact_after_a_step(p, constant_along_x);
}

TEST_P(Conditions, soft_and_hard_supports_hold_along_the_plate_normal_and_the_edge) {
  if (dim == 2) GTEST_SKIP() << "a plate is three-dimensional";
  LinearField soft = field, hard{Tensor3::Zero()};
  soft.slope.col(2).setZero();  // u_z = 0
  SolidParameters p = pulled_box(soft, dim);
  p.boundaries["xmax"] = boundary(Type::soft_support);
  p.boundaries["ymin"] = boundary(Type::fixed_displacement, soft.text(dim));
  // The rest of what the soft support leaves free is pulled.
  p.boundaries["xmax"].traction = {{"0"}, {"0"}, {"0"}};
  const auto pull = traction_text(p, soft, Vec3(1, 0, 0));
  for (int a = 0; a < 3; ++a) p.boundaries["xmax"].traction[a] = {pull[a]};
  expect_exact_after_a_step(p, soft);
  // u_y = u_z = 0 at x = 0, no shear there: only stretch and u_x.
  hard.slope(0, 0) = 1e-3;
  hard.slope(0, 1) = 0;
  p = pulled_box(hard, dim);
  p.boundaries["xmin"] = boundary(Type::hard_support);
  p.boundaries["ymin"] = boundary(Type::fixed_displacement, hard.text(dim));
  p.boundaries["xmin"].traction = {{traction_text(p, hard, Vec3(-1, 0, 0))[0]}, {"0"}, {"0"}};
  expect_exact_after_a_step(p, hard);
}

TEST_P(Conditions, a_roller_moves_along_one_oblique_direction_and_is_pulled_across_it) {
  const Vec3 along(2, 1, dim == 3 ? -1 : 0);
  SolidParameters p = pulled_box(field, dim);
  SolidBoundary& roller = p.boundaries["xmax"] = boundary(Type::roller);
  roller.normal = along;
  roller.along.text.clear();
  for (int a = 0; a < dim; ++a)
    roller.along.text +=
        fmt::format("{}({})*({})", a > 0 ? "+" : "", along.normalized()[a], field.text(dim)[std::size_t(a)]);
  for (const std::string& text : traction_text(p, field, Vec3(1, 0, 0))) roller.traction.push_back({text});
  p.boundaries["ymin"] = boundary(Type::fixed_displacement, field.text(dim));
  expect_exact_after_a_step(p, field);
}

TEST_P(Conditions, parts_of_a_patch_have_conditions_of_their_own) {
  SolidParameters p = pulled_box(field, dim);
  const auto displacement = field.text(dim);
  const auto traction = traction_text(p, field, Vec3(-1, 0, 0));
  SolidBoundary& b = p.boundaries["xmin"];
  SolidPart low, middle;
  low.where = {"y < 0.3"};
  low.type = Type::fixed_displacement;
  for (const std::string& text : displacement) low.value.push_back({text});
  middle.where = {"y < 0.5"};
  static_cast<SolidCondition&>(middle) = some_components(field, dim, "y", traction);
  b.parts = {low, middle};
  if (!symmetric_refuses(GetParam(), p)) expect_exact_after_a_step(p, field);
}

// Symmetry planes beside prescribed, partly known and sprung sides: edges and corners of all pairs.
SolidParameters box_of_many_supports(const LinearField& stretch, int dim) {
  SolidParameters p = pulled_box(stretch, dim);
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, stretch.text(dim));
  p.boundaries["ymin"] = boundary(Type::symmetry);
  p.boundaries["ymax"] = some_components(stretch, dim, "y", {});
  if (dim == 2) return p;
  p.boundaries["zmin"] = boundary(Type::symmetry);
  p.boundaries["zmax"] = boundary(Type::frictionless);
  return p;
}

/// No shear, no displacement across y = 0, z = 0 and z = 0.6.
LinearField stretch_of(int dim) {
  LinearField field{Tensor3::Zero()};
  field.slope.diagonal() = Vec3(1.1e-3, -0.7e-3, 0);
  if (dim == 2) field.slope(2, 2) = 0;
  return field;
}

TEST_P(Conditions, edges_and_corners_of_different_supports_are_exact) {
  const LinearField stretch = stretch_of(dim);
  expect_exact_after_a_step(box_of_many_supports(stretch, dim), stretch);
}

TEST_P(Conditions, bodies_one_cell_thick_are_exact) {
  const LinearField stretch = stretch_of(dim);
  for (const std::array<int, 3>& n : {std::array{4, 3, 1}, std::array{4, 1, 1}, std::array{1, 1, 1}}) {
    const RawMesh raw = make_box(cells, n, Vec3::Zero(), Vec3(1, 0.8, 0.6));
    for (const bool supported : {false, true}) {
      SolidParameters p = supported ? box_of_many_supports(stretch, dim) : pulled_box(field, dim);
      if (!supported) p.boundaries["xmin"] = boundary(Type::fixed_displacement, field.text(dim));
      int ranks = 1;
      MPI_Comm_size(MPI_COMM_WORLD, &ranks);
      if (raw.cell_points.size() < ranks) continue;
      const auto solid = make(raw, p);
      EXPECT_THAT(solid->body().elastic().vertices().inexact_points(), ::testing::IsEmpty());
      step(*solid, 1);
      expect_exact(*solid, supported ? stretch : field);
    }
  }
}

// u = t times a linear field: no acceleration, so that every condition must be exact in time, too.
TEST_P(Conditions, fields_linear_in_space_and_time_are_exact_in_dynamic_runs) {
  const LinearField stretch = stretch_of(dim);
  SolidParameters p = box_of_many_supports(stretch, dim);
  p.analysis = SolidParameters::Analysis::dynamic;
  for (auto& [name, b] : p.boundaries) {
    for (auto& text : b.value) text.text = "t*(" + text.text + ")";
    for (auto& text : b.components)
      if (text) text->text = "t*(" + text->text + ")";
  }
  SolidBoundary spring;
  spring.type = Type::spring;
  spring.stiffness = {"5e10"};
  const auto force = traction_text(p, stretch, Vec3(1, 0, 0)), place = stretch.text(dim);
  for (int a = 0; a < dim; ++a)
    spring.value.push_back({fmt::format("t*({} + ({})/5e10)", place[a], force[a])});
  p.boundaries["xmax"] = spring;
  for (const std::string& text : stretch.text(dim)) p.initial_velocity.push_back({text});
  const auto solid = make(distorted_box(cells), p);
  for (int i = 0; i < 4; ++i) step(*solid, 0.25);
  EXPECT_DOUBLE_EQ(solid->stepper().state().time, 1);
  EXPECT_LT(relative_error(*solid, stretch), 1e-8);
  EXPECT_LT(relative_stress_error(*solid, stretch), 1e-8);
}

// Everything turned about an oblique axis: mesh, loads and symmetry planes.
TEST_P(Conditions, symmetry_planes_of_any_orientation_give_the_turned_solution) {
  const Tensor3 turn = dim == 3
                           ? Tensor3(Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix())
                           : Tensor3(Eigen::AngleAxisd(0.7, Vec3::UnitZ()).toRotationMatrix());
  const auto solve = [&](const Tensor3& r, Type plane) {
    RawMesh raw = distorted_box(cells);
    for (Vec3& x : raw.points) x = r * x;
    SolidParameters p = box_parameters(dim);
    for (const char* side : {"xmin", "ymin", "zmin"})
      if (p.boundaries.contains(side)) p.boundaries[side] = boundary(plane);
    // Traction (1 + y^2, x, x y) MPa and a body force in the box's own axes.
    const auto own = [&](int a) {
      return fmt::format("({:.17g}*x + {:.17g}*y + {:.17g}*z)", r(0, a), r(1, a), r(2, a));
    };
    const std::vector<std::string> load{"1e6*(1 + " + own(1) + "^2)", "1e6*" + own(0),
                                        "1e6*" + own(0) + "*" + own(1)};
    SolidBoundary& loaded = p.boundaries["xmax"];
    loaded.type = Type::traction;
    for (int i = 0; i < dim; ++i) {
      std::string text = "0";
      for (int a = 0; a < dim; ++a) text += fmt::format(" + {:.17g}*{}", r(i, a), load[a]);
      loaded.value.push_back({text});
      p.body_force.push_back({fmt::format("{:.17g}", 1e5 * (r(i, 0) - 2 * r(i, 1)))});
    }
    auto solid = make(raw, p);
    step(*solid, 1);
    return solid;
  };
  for (const Type plane : {Type::symmetry, Type::frictionless}) {
    const auto straight = solve(Tensor3::Identity(), plane), turned = solve(turn, plane);
    // Two meshes of one process are not shared out alike: compare by the number in the mesh file.
    const auto a = displacement_by_cell(*straight), b = displacement_by_cell(*turned);
    double error = 0, size = 0;
    for (std::size_t c = 0; c < a.size(); ++c) {
      error = std::max(error, (turn * a[c] - b[c]).norm());
      size = std::max(size, a[c].norm());
    }
    error /= size;
    RecordProperty(plane == Type::symmetry ? "symmetry" : "frictionless", fmt::format("{:.3e}", error));
    EXPECT_LT(error, 1e-10);
  }
}

TEST_P(Conditions, reactions_of_all_supports_balance_the_loads) {
  SolidParameters p = box_parameters(dim);
  SolidBoundary spring;
  spring.type = Type::spring;
  spring.stiffness = {"1e11*(1 + x)"};
  for (int a = 0; a < dim; ++a) {
    spring.value.push_back({"1e-5*y"});
    spring.traction.push_back({"2e5*x"});
  }
  p.boundaries["ymin"] = spring;
  p.boundaries["xmin"] = some_components({Tensor3::Zero()}, dim, "x", std::vector<std::string>(dim, "3e5"));
  p.boundaries["ymax"] = pressed("4e5*(1 + x^2)");
  SolidPart part;
  part.where = {std::get<1>(GetParam()) == FaceGradient::symmetric ? "y > -1" : "y > 0.4"};
  part.type = Type::frictionless;
  p.boundaries["xmax"].parts = {part};
  p.body_force = {{"1e5*sin(x)"}, {"-2e5*y"}, {"3e4"}};
  p.body_force.resize(dim);
  const auto solid = make(distorted_box(cells), p);
  step(*solid, 1);
  Vec3 total = solid->fields().total_load();
  const double size = total.norm();
  const auto reactions = solid->fields().reactions(solid->fields().point_displacement());
  for (const PatchForce& r : reactions) total += r.force;
  EXPECT_EQ(reactions.size(), 3);
  EXPECT_GT(size, 1e4);
  EXPECT_LT(total.norm(), 1e-8 * size);
}

// A nearly rigid block on springs: translation F / (k A), rotation M / (k I).
TEST(SolidSprings, a_stiff_block_sinks_and_tilts_as_statics_says) {
  SolidParameters p = box_parameters(2);
  p.material.youngs_modulus = 1e15;
  p.boundaries["ymin"] = sprung("1e9");
  p.boundaries["ymax"] = boundary(Type::traction, {"0", "-1e6*(1 + 2*(x - 1))"});
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {16, 4, 1}, Vec3::Zero(), Vec3(2, 0.5, 0));
  const auto solid = stepped(raw, p);
  // Mean pressure 1 MPa; moment about the middle 2e6 * 2^3/12 against k 2^3/12 (1 - 1/16^2), since the springs of the 16 faces act
  // at their centres.
  const double tilt = 2e-3 / (1 - 1.0 / 256);
  const std::vector<double> points = solid->fields().point_displacement();
  for (Index v = 0; v < solid->body().mesh().points.n_local(); ++v) {
    const Vec3& x = solid->body().geometry().points[v];
    EXPECT_NEAR(points[std::size_t(v) * 2 + 1], -1e-3 - tilt * (x[0] - 1), 5e-8);
    EXPECT_NEAR(points[std::size_t(v) * 2], tilt * x[1], 5e-8);
  }
}

// The same block thrown upwards: a mass on a spring by the trapezoidal rule, tan(w' dt/2) = w dt/2.
TEST(SolidSprings, a_stiff_block_swings_on_springs_with_the_frequency_of_the_time_scheme) {
  SolidParameters p = box_parameters(2);
  p.analysis = SolidParameters::Analysis::dynamic;
  p.material = {1000, 1e16, 0.3};
  p.boundaries["ymin"] = sprung("1e9");
  p.initial_velocity = {{"0"}, {"1"}};
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3(0.5, 0.5, 0));
  const auto solid = make_solid(raw, p);
  const double w = std::sqrt(1e9 / (1000 * 0.5)), dt = 0.2 / w, discrete = 2 / dt * std::atan(w * dt / 2);
  for (int i = 0; i < 40; ++i) step(*solid, dt);
  const double wanted = std::sin(discrete * 40 * dt) / w;
  for (Index c = 0; c < solid->body().mesh().cells.n_owned(); ++c)
    EXPECT_NEAR(solid->stepper().state().cell_u[std::size_t(c) * 2 + 1], wanted, 1e-5 / w);
}

TEST(SolidSupports, a_moving_support_carries_a_free_body_along) {
  SolidParameters p = box_parameters(3);
  p.analysis = SolidParameters::Analysis::dynamic;
  SolidBoundary& b = p.boundaries["xmin"];
  b.type = Type::fixed_displacement;
  b.components[1] = {"2*t"};
  p.initial_velocity = {{"3"}, {"2"}, {"-1"}};
  const auto solid = make_solid(distorted_box(BoxCells::prisms), p);
  for (int i = 0; i < 5; ++i) step(*solid, 1e-3);
  const std::vector<double> points = solid->fields().point_displacement();
  const Vec3 wanted(15e-3, 10e-3, -5e-3);
  double error = 0;
  for (Index v = 0; v < solid->body().mesh().points.n_local(); ++v)
    error = std::max(error, (Eigen::Map<const Vec3>(points.data() + 3 * v) - wanted).norm());
  EXPECT_LT(parallel::max(MPI_COMM_WORLD, error), 1e-10);
}

TEST(SolidBoundaries, that_contradict_each_other_at_common_points_are_refused) {
  const RawMesh square = make_box(BoxCells::quadrilaterals, {3, 3, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  const auto refusal = [&](const std::function<void(SolidParameters&)>& change) {
    SolidParameters p = box_parameters(2);
    p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"1e-3*y", "0"});
    change(p);
    return support::error_of([&] { stepped(square, p); });
  };
  const auto with = [](const char* patch, const SolidBoundary& b) {
    return [patch, b](SolidParameters& p) { p.boundaries[patch] = b; };
  };
  SolidBoundary along_y, roller;
  along_y.type = Type::fixed_displacement, along_y.components[1] = {"2e-3"};
  roller.type = Type::roller, roller.normal = Vec3::UnitX(), roller.along = {"1e-3"};
  EXPECT_THAT(refusal(with("ymax", boundary(Type::fixed_displacement, {"1e-3*t", "1e-4*x"}))), "");
  EXPECT_THAT(refusal(with("ymax", roller)), "");
  EXPECT_THAT(refusal(with("ymin", boundary(Type::symmetry))), "");
  EXPECT_THAT(refusal(with("ymax", boundary(Type::frictionless))), "");
  EXPECT_EQ(
      refusal(with("ymax", boundary(Type::fixed_displacement, {"0", "0"}))),
      "boundaries: 'xmin' and 'ymax' prescribe different displacements at (0, 1), a common point: (0.001, 0) m "
      "and (0, 0) m at t = 1 s. Prescribe the same there, or leave the component free on one of the patches.");
  EXPECT_THAT(refusal(with("ymax", along_y)), HasSubstr("(0, 0) m and (0, 0.002) m"));
  EXPECT_THAT(refusal(with("ymin", roller)), HasSubstr("'xmin' and 'ymin'"));
  EXPECT_THAT(refusal([&](SolidParameters& p) {
                p.boundaries["xmin"] = boundary(Type::fixed_displacement, {"0", "1e-3"});
                p.boundaries["ymin"] = boundary(Type::symmetry);
              }),
              HasSubstr("(0, 0.001) m and (0, 0) m"));
}

TEST(SolidBoundaries, a_part_without_faces_is_refused) {
  SolidParameters p = box_parameters(2);
  p.boundaries["xmin"] = clamped(2);
  SolidPart part;
  part.where = {"abs(y - 0.5) < 1e-3"};
  p.boundaries["xmax"].parts = {part};
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {2, 2, 1}, Vec3::Zero(), Vec3(1, 1, 0));
  EXPECT_THAT([&] { make_solid(raw, p); },
              ::testing::ThrowsMessage<Error>(HasSubstr("selects no face of patch 'xmax'")));
}

class FreeMotions : public ::testing::Test {
 protected:
  static std::string message(const SolidParameters& p, const RawMesh& raw) {
    const std::string text = support::error_of([&] { make_solid(raw, p); });
    return text.empty() ? "held" : text;
  }
  static RawMesh box(int dim) {
    return dim == 2 ? make_box(BoxCells::quadrilaterals, {4, 4, 1}, Vec3::Zero(), Vec3(1, 1, 0))
                    : make_box(BoxCells::hexahedra, {4, 4, 4}, Vec3::Zero(), Vec3(1, 1, 1));
  }
  static SolidParameters with(int dim, const std::vector<std::pair<const char*, SolidBoundary>>& held) {
    SolidParameters p = box_parameters(dim);
    for (const auto& [name, b] : held) p.boundaries[name] = b;
    return p;
  }
  static SolidBoundary row(const char* where, const std::string& axes) {
    SolidBoundary b;
    SolidPart part;
    part.where = {where};
    static_cast<SolidCondition&>(part) = some_components({Tensor3::Zero()}, 3, axes, {});
    b.parts = {part};
    return b;
  }
};

TEST_F(FreeMotions, of_a_body_without_supports_are_all) {
  EXPECT_THAT(message(box_parameters(3), box(3)),
              HasSubstr("motions free: translation along x, translation along y, translation along z, "
                        "rotation about x through (0.5, 0.5, 0.5), rotation about y through (0.5, 0.5, 0.5), "
                        "rotation about z through (0.5, 0.5, 0.5). Prevent them"));
  EXPECT_THAT(message(box_parameters(2), box(2)),
              HasSubstr("motions free: translation along x, translation along y, rotation about (0.5, "
                        "0.5). Prevent them"));
}

TEST_F(FreeMotions, on_symmetry_planes_are_those_within_them) {
  EXPECT_THAT(
      message(with(3, {{"xmin", boundary(Type::symmetry)}}), box(3)),
      HasSubstr(
          "free: translation along y, translation along z, rotation about x through (0.5, 0.5, 0.5). "));
  EXPECT_THAT(
      message(with(3, {{"xmin", boundary(Type::symmetry)}, {"ymin", boundary(Type::frictionless)}}), box(3)),
      HasSubstr("free: translation along z. "));
  EXPECT_EQ(message(with(3, {{"xmin", boundary(Type::symmetry)},
                             {"ymin", boundary(Type::frictionless)},
                             {"zmax", boundary(Type::symmetry)}}),
                    box(3)),
            "held");
}

TEST_F(FreeMotions, about_a_line_of_held_faces_is_the_rotation_about_it) {
  EXPECT_THAT(message(with(3, {{"xmin", row("abs(z - 0.625) < 0.1", "xyz")}}), box(3)), "held");
  EXPECT_THAT(message(with(3, {{"xmin", row("abs(z - 0.625) < 0.1", "xz")}}), box(3)),
              HasSubstr("free: translation along y, rotation about y through (0, 0.5, 0.625). "));
}

TEST_F(FreeMotions, springs_hold_however_soft) {
  SolidBoundary spring;
  spring.type = Type::spring;
  spring.stiffness = {"1e-3"};
  EXPECT_EQ(message(with(2, {{"xmin", spring}}), box(2)), "held");
  spring.along_normal = true;
  EXPECT_THAT(message(with(2, {{"xmin", spring}}), box(2)), HasSubstr("free: translation along y. "));
}

TEST_F(FreeMotions, of_bodies_that_do_not_hang_together_are_told_apart) {
  const RawMesh raw =
      support::beside(box(2), make_box(BoxCells::quadrilaterals, {3, 3, 1}, Vec3(5, 0, 0), Vec3(6, 1, 0)));
  SolidParameters p = with(2, {{"xmin", clamped(2)}});
  EXPECT_EQ(message(p, raw), "held");
  SolidBoundary left;
  SolidPart part;
  part.where = {"x < 1"};
  part.type = Type::fixed_displacement;
  part.value = {{"0"}, {"0"}};
  left.parts = {part};
  p.boundaries["xmin"] = left;
  EXPECT_THAT(
      message(p, raw),
      HasSubstr("the body around (5.5, 0.5, 0), one of 2 unconnected ones, is free in translation along x, "
                "translation along y, rotation about (5.5, 0.5). "));
  p.analysis = SolidParameters::Analysis::dynamic;
  EXPECT_EQ(message(p, raw), "held");
}

}  // namespace couplet::testing::conditions_test
