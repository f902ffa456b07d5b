// SPDX-License-Identifier: Apache-2.0
// Several materials: displacement and traction go on where they meet.
#include <Eigen/Dense>

#include "solid_solver/output/probes.hpp"
#include "tests/verification/solid/linear_field.hpp"

namespace couplet::testing::materials_test {
using namespace elastic;
using namespace mesh;

using ::testing::HasSubstr;

/// A distorted box whose cells beyond the plane through the middle of a mesh line are of the second zone. The
/// points of the plane x = 0.6 (3 of 5 cells) are put onto an oblique plane first; those off it are moved at
/// random.
RawMesh two_zones(BoxCells cells, double slant) {
  RawMesh raw = make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  std::vector<char> keep(raw.points.size(), 0);
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    Vec3 centre = Vec3::Zero();
    for (const Index p : raw.cell_points[c]) centre += raw.points[p] / double(raw.cell_points[c].size());
    raw.cell_zone[c] = centre[0] > 0.6;
  }
  raw.zones = {"soft", "hard"};
  const std::vector<Vec3> before = raw.points;
  perturb_interior(raw, 0.2, 5);
  for (std::size_t p = 0; p < raw.points.size(); ++p)
    if (std::abs(before[p][0] - 0.6) < 1e-9) raw.points[p] = before[p];
  // Shears the mesh so that the interface becomes the plane x - slant (y + z/2) = 0.6.
  for (Vec3& x : raw.points) x[0] += slant * (x[1] + 0.5 * x[2]);
  return raw;
}

SolidParameters box_of_two_materials(int dim) {
  SolidParameters p = box_parameters(dim);
  p.materials["hard"] = {{7800, 200e9, 0.3, {}}, {}};
  p.materials["rubber"] = {{1100, 17e6, 0.45, {}}, {"soft"}};
  return p;
}

/// Linear in each material, continuous in displacement and traction on a plane.
struct BondedField {
  Vec3 normal, on_plane;
  LinearField soft, hard;
  const LinearField& on(const Vec3& x) const { return normal.dot(x - on_plane) > 0 ? hard : soft; }
  Vec3 at(const Vec3& x) const {
    // u = slope^T (x - on_plane): continuous, as the slopes differ along the normal only.
    return on(x).slope.transpose() * (x - on_plane);
  }
};

/// grad u in the hard part is that in the soft part + n a^T, with a from equal tractions.
BondedField bonded_field(const SolidParameters& p, const Vec3& normal, const Vec3& on_plane) {
  BondedField field{normal, on_plane, general_field(p.dimension), {}};
  const LameConstants soft = lame_constants(p, p.materials.at("rubber")),
                      hard = lame_constants(p, p.materials.at("hard"));
  const auto traction = [&](const LameConstants& l, const Tensor3& g) {
    return Vec3((l.mu * (g + g.transpose()) + l.lambda * g.trace() * Tensor3::Identity()) * normal);
  };
  const Vec3 gap = traction(soft, field.soft.slope) - traction(hard, field.soft.slope);
  const Tensor3 acoustic =
      hard.mu * Tensor3::Identity() + (hard.mu + hard.lambda) * normal * normal.transpose();
  field.hard.slope = field.soft.slope + normal * (acoustic.inverse() * gap).transpose();
  if (p.dimension == 2) field.hard.slope.row(2).setZero(), field.hard.slope.col(2).setZero();
  return field;
}

std::vector<std::string> text_of(const BondedField& field, int dim) {
  const auto linear = [&](const Vec3& g) {
    const double constant = -g.dot(field.on_plane);
    return fmt::format("({:.17g} + {:.17g}*x + {:.17g}*y + {:.17g}*z)", constant, g[0], g[1], g[2]);
  };
  std::vector<std::string> result;
  for (int a = 0; a < dim; ++a)
    result.push_back(fmt::format("{} > 0 ? {} : {}", linear(field.normal), linear(field.hard.slope.col(a)),
                                 linear(field.soft.slope.col(a))));
  return result;
}

class Materials : public ::testing::TestWithParam<CellsAndGradient> {
 protected:
  const BoxCells cells = std::get<0>(GetParam());
  const int dim = dimension_of(cells);
  SolidParameters two_materials() const {
    return to_round_off(box_of_two_materials(dim), std::get<1>(GetParam()));
  }
};
INSTANTIATE_TEST_SUITE_P(Solid, Materials, all_cells_and_gradients, name_of);

TEST_P(Materials, piecewise_linear_fields_are_exact_across_an_oblique_interface) {
  for (const double slant : {0.0, 0.3}) {
    SolidParameters p = two_materials();
    const Vec3 normal = Vec3(1, -slant, dim == 3 ? -0.5 * slant : 0).normalized();
    const BondedField field = bonded_field(p, normal, Vec3(0.6, 0, 0));
    for (auto& [name, b] : p.boundaries) b = boundary(Type::fixed_displacement, text_of(field, dim));
    // Where the interface comes out, a traction face takes its load from one side: free of this question are
    // xmin and xmax.
    const auto pull = [&](const char* side, const LinearField& of, const Vec3& n, const char* material) {
      const LameConstants l = lame_constants(p, p.materials.at(material));
      const Vec3 t =
          (l.mu * (of.slope + of.slope.transpose()) + l.lambda * of.slope.trace() * Tensor3::Identity()) * n;
      std::vector<std::string> value;
      for (int a = 0; a < dim; ++a) value.push_back(fmt::format("{:.17g}", t[a]));
      p.boundaries[side] = boundary(Type::traction, value);
    };
    pull("xmax", field.hard, normal, "hard");
    pull("xmin", field.soft, -normal, "rubber");
    const auto solid = make_solid(two_zones(cells, slant), p);
    const Mesh& mesh = solid->body().mesh();
    const Geometry& geometry = solid->body().geometry();
    ASSERT_FALSE(mesh.cell_material.empty());
    step(*solid, 1);
    double error = 0, size = 0, stress_error = 0, jump = 0, point_error = 0, strain_error = 0;
    const std::vector<double> points = solid->fields().point_displacement();
    for (Index v = 0; v < mesh.points.n_local(); ++v) {
      Vec3 u = Vec3::Zero();
      for (int a = 0; a < dim; ++a) u[a] = points[std::size_t(v) * dim + a];
      error = std::max(error, (u - field.at(geometry.points[v])).norm());
      size = std::max(size, u.norm());
    }
    const std::vector<Tensor3> stress = solid->fields().cell_stress(points);
    double stress_size = 0;
    for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
      const Tensor3 exact = solid->body().elastic().stress(c, field.on(geometry.cell_centre[c]).slope);
      stress_error = std::max(stress_error, (stress[c] - exact).topLeftCorner(dim, dim).norm());
      stress_size = std::max(stress_size, exact.norm());
    }
    // At points each side of the interface has its own stress and strain.
    const SidedTensors stresses = solid->fields().stress_sides(points),
                       strains = solid->fields().strain_sides(points);
    for (Index c = 0; c < mesh.cells.n_owned(); ++c)
      for (const Index v : mesh.cell_points[c]) {
        const Tensor3 slope = field.on(geometry.cell_centre[c]).slope;
        const auto gap = [&](const SidedTensors& sides, const Tensor3& exact) {
          const auto& side = sides[std::size_t(mesh.material_of(c))];
          return (unpack(std::span(side).subspan(std::size_t(v) * tensor_size, tensor_size)) - exact)
              .topLeftCorner(dim, dim)
              .norm();
        };
        point_error = std::max(point_error, gap(stresses, solid->body().elastic().stress(c, slope)));
        strain_error = std::max(strain_error, gap(strains, 0.5 * (slope + slope.transpose())));
      }
    // Tractions of the two sides of each bonded face.
    std::vector<Tensor3> faces =
        solid->fields().face_stress(mesh.n_interior, mesh.boundary.n_owned(), points);
    faces.resize(mesh.boundary.n_local());
    mesh.boundary.update_ghosts(std::span(faces.data()->data(), 9 * faces.size()), 9);
    double n_bonded = 0;
    for (const Index f : solid->body().elastic().unknown_faces()) {
      const Index b = f - mesh.n_interior;
      if (!solid->body().elastic().at(f).shared) continue;
      const Vec3 n = geometry.face_area[f].normalized();
      jump = std::max(jump, ((faces[b] - faces[mesh.twin[b]]) * n).norm());
      ++n_bonded;
    }
    EXPECT_GT(parallel::sum(mesh.comm, n_bonded), 3);
    const auto ratio = [&](double a, double b) {
      return parallel::max(mesh.comm, a) / parallel::max(mesh.comm, b);
    };
    RecordProperty("relative_error", fmt::format("{:.3e}", ratio(error, size)));
    RecordProperty("relative_stress_error", fmt::format("{:.3e}", ratio(stress_error, stress_size)));
    RecordProperty("relative_traction_jump", fmt::format("{:.3e}", ratio(jump, stress_size)));
    EXPECT_LT(ratio(error, size), 1e-10);
    EXPECT_LT(ratio(stress_error, stress_size), 1e-10);
    EXPECT_LT(ratio(point_error, stress_size), 1e-9);
    EXPECT_LT(parallel::max(mesh.comm, strain_error), 1e-9 * field.soft.slope.norm());
    EXPECT_LT(ratio(jump, stress_size), 1e-10);
  }
}

// A bar of two materials in series, free to contract: not linear near the interface, but its ends must
// balance.
TEST_P(Materials, both_ends_of_a_bar_in_series_carry_the_same_force) {
  SolidParameters p = two_materials();
  p.boundaries["xmin"] = clamped(dim);
  p.boundaries["xmax"] =
      boundary(Type::fixed_displacement,
               dim == 3 ? std::vector<std::string>{"1e-3", "0", "0"} : std::vector<std::string>{"1e-3", "0"});
  const auto solid = stepped(two_zones(cells, 0), p);
  const auto forces = solid->fields().reactions(solid->fields().point_displacement());
  ASSERT_EQ(forces.size(), 2U);
  EXPECT_GT(forces[1].force[0], 1e3);
  EXPECT_LT((forces[0].force + forces[1].force).norm(), 1e-9 * forces[1].force.norm());
}

// Uniformly heated between walls that let it slide: one pushes the other, u_x linear in each.
TEST_P(Materials, unequal_thermal_expansion_of_bonded_materials_is_exact) {
  SolidParameters p = two_materials();
  p.materials["rubber"].heat.expansion = {"2e-4"};
  p.materials["hard"].heat.expansion = {"1.2e-5"};
  p.temperature = {"60"};
  p.expansion.emplace().reference_temperature = 10;
  for (auto& [name, b] : p.boundaries) b = boundary(Type::frictionless);
  const LameConstants soft = lame_constants(p, p.materials.at("rubber")),
                      hard = lame_constants(p, p.materials.at("hard"));
  // sigma_x = (lambda + 2 mu) e - (3 lambda + 2 mu) alpha dT in both, 0.6 e_soft + 0.4 e_hard = 0.
  const auto axial = [](const LameConstants& l) { return l.lambda + 2 * l.mu; };
  const auto thermal = [](const LameConstants& l, double alpha) {
    return (3 * l.lambda + 2 * l.mu) * alpha * 50;
  };
  const double e_soft = (thermal(soft, 2e-4) - thermal(hard, 1.2e-5)) / (axial(soft) + 1.5 * axial(hard));
  const double stress = axial(soft) * e_soft - thermal(soft, 2e-4);
  const auto solid = stepped(two_zones(cells, 0), p);
  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  double error = 0, stress_error = 0;
  const std::vector<Tensor3> stresses = solid->fields().cell_stress(solid->fields().point_displacement());
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double x = geometry.cell_centre[c][0];
    const double wanted = x < 0.6 ? e_soft * x : 1.5 * e_soft * (1 - x);
    Vec3 u = Vec3::Zero();
    for (int a = 0; a < dim; ++a) u[a] = solid->stepper().state().cell_u[std::size_t(c) * dim + a];
    error = std::max(error, (u - Vec3(wanted, 0, 0)).norm());
    stress_error = std::max(stress_error, std::abs(stresses[c](0, 0) - stress));
  }
  EXPECT_LT(parallel::max(mesh.comm, error), 1e-10 * std::abs(0.6 * e_soft));
  EXPECT_LT(parallel::max(mesh.comm, stress_error), 1e-9 * std::abs(stress));
}

TEST_P(Materials, zones_of_equal_material_give_the_answer_of_one_material) {
  SolidParameters p = box_parameters(dim);
  p.boundaries["xmin"] = boundary(Type::fixed_displacement, general_field(dim).text(dim));
  const auto solid = make_solid(two_zones(cells, 0.3), p);
  EXPECT_TRUE(solid->body().mesh().cell_material.empty());
  EXPECT_TRUE(solid->body().mesh().twin.empty());
}

// Two layers under inner pressure, plane strain: u_r = A_i r + B_i / r (Lame), a quarter of the ring.
double layered_ring_error(int n, double& stress_error) {
  constexpr double r0 = 1, r1 = 1.5, r2 = 2, pressure = 1e6;
  SolidParameters p = box_of_two_materials(2);
  p.method.face_gradient = FaceGradient::thesis;
  p.materials["rubber"] = {{1000, 20e9, 0.2, {}}, {"soft"}};
  RawMesh raw = quarter_ring(BoxCells::quadrilaterals, 2 * n, 2 * n, r0, r2);
  raw.zones = {"soft", "hard"};
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double r = 0;
    for (const Index v : raw.cell_points[c]) r += raw.points[v].norm() / 4;
    raw.cell_zone[c] = r > r1;
  }

  p.boundaries["ymin"] = p.boundaries["ymax"] = boundary(Type::symmetry);
  p.boundaries["xmin"] = pressed(fmt::format("{}", pressure));
  // sigma_r = 2 (mu + lambda) A - 2 mu B / r^2: inner pressure, free outside, continuous u_r and sigma_r at
  // r1.
  const LameConstants in = lame_constants(p, p.materials.at("rubber")),
                      out = lame_constants(p, p.materials.at("hard"));
  const auto radial = [](const LameConstants& l, double r) {
    return Eigen::RowVector2d(2 * (l.mu + l.lambda), -2 * l.mu / (r * r));
  };
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m.block<1, 2>(0, 0) = radial(in, r0);
  m.block<1, 2>(1, 2) = radial(out, r2);
  m.row(2) << r1, 1 / r1, -r1, -1 / r1;
  m.block<1, 2>(3, 0) = radial(in, r1);
  m.block<1, 2>(3, 2) = -radial(out, r1);
  const Eigen::Vector4d ab = m.fullPivLu().solve(Eigen::Vector4d(-pressure, 0, 0, 0));
  const auto solid = stepped(raw, p);
  const Mesh& mesh = solid->body().mesh();
  const Geometry& geometry = solid->body().geometry();
  const auto stress = solid->fields().cell_stress(solid->fields().point_displacement());
  double error = 0, size = 0, stress_size = 0;
  stress_error = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const Vec3& x = geometry.cell_centre[c];
    const double r = x.norm(), volume = geometry.volume[c];
    const Eigen::Vector2d k = r < r1 ? ab.head<2>() : ab.tail<2>();
    const LameConstants& l = r < r1 ? in : out;
    const Vec3 exact = (k[0] + k[1] / (r * r)) * x;
    const Vec3 u(solid->stepper().state().cell_u[2 * c], solid->stepper().state().cell_u[2 * c + 1], 0);
    error += volume * (u - exact).squaredNorm();
    size += volume * exact.squaredNorm();
    const Vec3 er = x / r;
    const double sr = er.dot(stress[c] * er),
                 wanted = 2 * (l.mu + l.lambda) * k[0] - 2 * l.mu * k[1] / (r * r);
    stress_error += volume * (sr - wanted) * (sr - wanted);
    stress_size += volume * wanted * wanted;
  }
  stress_error = std::sqrt(stress_error / stress_size);
  return std::sqrt(error / size);
}

TEST(SolidMaterials, a_layered_cylinder_converges_to_lame_with_second_order) {
  double stress_coarse = 0, stress_fine = 0;
  const double coarse = layered_ring_error(8, stress_coarse), fine = layered_ring_error(16, stress_fine);
  const double slope = std::log2(coarse / fine), stress_slope = std::log2(stress_coarse / stress_fine);
  RecordProperty("displacement_slope", fmt::format("{:.4f}", slope));
  RecordProperty("stress_slope", fmt::format("{:.4f}", stress_slope));
  RecordProperty("finest_error", fmt::format("{:.3e}", fine));
  fmt::print("layered cylinder: displacement {:.3e}, slope {:.2f}; radial stress {:.3e}, slope {:.2f}\n",
             fine, slope, stress_fine, stress_slope);
  EXPECT_GE(slope, 1.9);
  EXPECT_GE(stress_slope, 1.4);
}

// Layers of 70 and 210 GPa under the same strain of 1e-3, or heated between walls without strain (E alpha 50 K = 70 and 210 MPa): probes
// beside the joint, at it, the tractions of what is held and the largest stress have the value of one side, and nothing is told to be in
// error.
class Layers : public ::testing::TestWithParam<std::tuple<BoxCells, bool>> {};

TEST_P(Layers, have_the_stress_of_each_side_beside_their_joint) {
  const auto [cells, heated] = GetParam();
  const int dim = dimension_of(cells);
  SolidParameters p = box_parameters(dim);
  p.plane = SolidParameters::Plane::stress;
  p.materials["brass"] = {{8000, 70e9, 0, {}}, {"low"}};
  p.materials["steel"] = {{7800, 210e9, 0, {}}, {"high"}};
  p.method.preconditioner = MethodParameters::Preconditioner::factors;
  for (const char* side : {"xmin", "ymin"}) p.boundaries[side] = boundary(Type::symmetry);
  if (heated) {
    p.materials["brass"].heat.expansion = p.materials["steel"].heat.expansion = {"2e-5"};
    p.temperature = {"350"};
    p.expansion.emplace().reference_temperature = 300;
    for (const char* side : {"xmax", "zmin", "zmax"})
      if (p.boundaries.contains(side)) p.boundaries[side] = boundary(Type::symmetry);
  } else {
    p.boundaries["xmax"] = boundary(Type::fixed_displacement, {"6e-4", "0"});
    if (dim == 3) p.boundaries["xmax"].value.push_back({"0"});
  }
  const std::map<double, double> wanted{{0.03, 70e6},  {0.055, 70e6},   {0.0599, 70e6},
                                        {0.06, 210e6}, {0.0601, 210e6}, {0.09, 210e6}};
  for (const auto& [y, stress] : wanted)
    for (const double x : {0.3, 0.325})
      p.probes[fmt::format("{} {}", x, y)] = {Vec3(x, y, dim == 3 ? 0.013 : 0), {"stress", "strain"}};
  RawMesh raw = make_box(cells, {12, 12, 3}, Vec3::Zero(), Vec3(0.6, 0.12, dim == 3 ? 0.03 : 0));
  raw.zones = {"low", "high"};
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double y = 0;
    for (const Index v : raw.cell_points[c]) y += raw.points[v][1] / double(raw.cell_points[c].size());
    raw.cell_zone[c] = y > 0.06;
  }
  const auto solid = stepped(raw, p);
  const Mesh& mesh = solid->body().mesh();
  const SolidFields& fields = solid->fields();
  const std::vector<double> points = fields.point_displacement();
  for (const ReportedStress& s : reported_stresses(solid->body(), fields, solid->view().output.probes())) {
    EXPECT_NEAR(s.value, s.where == "largest" ? 210e6 : wanted.lower_bound(s.place[1] - 1e-9)->second, 10)
        << s.where;
    EXPECT_LT(s.error, 1e-6) << s.where;
  }
  const std::vector<double> traction =
      fields.traction(solid->body().geometry().points, fields.stress_sides(points));
  const Patch& held = *mesh.find_patch("xmin");
  for (Index f = held.first; f < held.first + held.count; ++f) {
    const double stress = solid->body().geometry().cell_centre[mesh.owner[f]][1] < 0.06 ? 70e6 : 210e6;
    EXPECT_NEAR(traction[std::size_t((f - mesh.n_interior) * dim)], heated ? stress : -stress, 10);
  }
}

INSTANTIATE_TEST_SUITE_P(SolidMaterials, Layers,
                         ::testing::Combine(::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles,
                                                              BoxCells::hexahedra),
                                            ::testing::Bool()),
                         [](const auto& i) {
                           return fmt::format("{}_{}", name(std::get<0>(i.param)),
                                              std::get<1>(i.param) ? "heated" : "pulled");
                         });

TEST(SolidMaterials, each_zone_needs_one_material) {
  const RawMesh raw = two_zones(BoxCells::quadrilaterals, 0);
  const auto message = [&](const SolidParameters& p) {
    return support::error_of([&] { make_solid(raw, p); });
  };
  SolidParameters p = box_of_two_materials(2);
  p.materials["rubber"].zones = {"sof"};
  EXPECT_THAT(message(p), HasSubstr("no zone 'sof' for a material. Did you mean 'soft'?"));
  p.materials["rubber"].zones = {"hard"};
  EXPECT_THAT(message(p), HasSubstr("zone 'hard' is assigned to two materials"));
  p.materials.erase("rubber");
  EXPECT_THAT(message(p), HasSubstr("zone 'soft' has no material"));
}

}  // namespace couplet::testing::materials_test
