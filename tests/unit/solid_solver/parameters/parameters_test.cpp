// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/parameters.hpp"

#include "common/config/load.hpp"
#include "common/fv/expression.hpp"
#include "tests/support/test.hpp"

namespace couplet::parameters_test {
using namespace solid;

std::vector<std::string> read(const std::string& text, SolidParameters& p) {
  return config::load(
      config::Document::parse(text, "case.yaml"), "", [&](config::Section& s) { declare(s, p); },
      [](const config::ExpressionText& text) { return fv::problem_of(text); });
}

const std::string material = "material: {density: 7800, youngs-modulus: 200 GPa, poissons-ratio: 0.3}\n";

TEST(SolidParameters, are_read_with_units_and_expressions) {
  SolidParameters p;
  const auto errors = read("mesh: a.msh\ndimension: 2\nplane: stress\nanalysis: static\n" + material +
                               "boundaries:\n"
                               "  root: {type: fixed-displacement, value: [0, 0.1*sin(t)]}\n"
                               "  top: {type: pressure, value: 3e5}\n"
                               "  side: {type: symmetry}\n"
                               "probes:\n  tip: {point: [1, 2]}\n",
                           p);
  EXPECT_THAT(errors, ::testing::IsEmpty());
  EXPECT_EQ(p.analysis, SolidParameters::Analysis::static_);
  EXPECT_EQ(p.material.youngs_modulus, 200e9);
  EXPECT_EQ(p.boundaries.at("root").value.at(1).text, "0.1*sin(t)");
  EXPECT_EQ(p.boundaries.at("top").type, SolidBoundary::Type::pressure);
  EXPECT_EQ(p.boundaries.at("top").pressure.text, "300000");
  EXPECT_EQ(p.probes.at("tip").point, Vec3(1, 2, 0));
  EXPECT_FALSE(p.damping.has_value());
}

TEST(SolidParameters, supports_parts_and_materials_are_read) {
  SolidParameters p;
  const auto errors = read(
      "mesh: a.msh\n"
      "materials:\n"
      "  steel: {density: 7800, youngs-modulus: 200 GPa, poissons-ratio: 0.3}\n"
      "  rubber: {zones: [core, lid], density: 1100, youngs-modulus: 17 MPa, poissons-ratio: 0.45}\n"
      "boundaries:\n"
      "  edge:\n"
      "    type: fixed-displacement\n"
      "    components: {x: 0, z: 0.1*t}\n"
      "    traction: [0, 5, 0]\n"
      "    parts: [{where: abs(z) < 0.1, type: hard-support, plate-normal: [0, 0, 2]}]\n"
      "  bed: {type: spring, stiffness: 1e8*(1 + x), direction: normal}\n",
      p);
  EXPECT_THAT(errors, ::testing::IsEmpty());
  const SolidBoundary& edge = p.boundaries.at("edge");
  EXPECT_TRUE(edge.components[0] && !edge.components[1] && edge.components[2]);
  EXPECT_EQ(edge.components[2]->text, "0.1*t");
  EXPECT_EQ(edge.traction.at(1).text, "5");
  ASSERT_EQ(edge.parts.size(), 1U);
  EXPECT_EQ(edge.parts[0].type, SolidCondition::Type::hard_support);
  EXPECT_EQ(edge.parts[0].normal, Vec3(0, 0, 2));
  EXPECT_TRUE(p.boundaries.at("bed").along_normal);
  EXPECT_THAT(zones_of(p.materials),
              ::testing::ElementsAre(::testing::ElementsAre("core", "lid"), ::testing::ElementsAre("steel")));
  EXPECT_EQ(materials_of(p).at(1).youngs_modulus, 200e9);
}

TEST(SolidParameters, loads_by_their_total_are_read) {
  SolidParameters p;
  EXPECT_THAT(
      read("mesh: a.msh\nanalysis: static\n" + material +
               "boundaries:\n"
               "  root: {type: fixed-displacement, value: [0, 0, 0]}\n"
               "  lug: {type: force, value: [1 kN, 0 N, 2*t]}\n"
               "  head: {type: remote-load, point: [0 m, 0 m, 1.2 m], moment: [0, 3 kN m, 0]}\n"
               "  hole: {type: free, parts: [{where: x > 0, type: bearing-load, force: [0, 0, 5 kN]}]}\n"
               "  dam: {type: hydrostatic-pressure, density: 1 t/m^3, gravity: [0, 0, -9.81], level: 3 + t}\n"
               "point-loads:\n  pin: {point: [1, 2, 3], force: [1, 0, 0], radius: 2 cm}\n",
           p),
      ::testing::IsEmpty());
  EXPECT_EQ(p.boundaries.at("lug").load.force.at(0).text, "1000");
  EXPECT_EQ(p.boundaries.at("head").load.moment.at(1).text, "3000");
  EXPECT_EQ(p.boundaries.at("hole").parts.at(0).load.force.at(2).text, "5000");
  EXPECT_EQ(p.boundaries.at("dam").load.density, 1000);
  EXPECT_EQ(p.point_loads.at("pin").radius, 0.02);
  SolidParameters plane;
  EXPECT_THAT(
      read(
          "mesh: a.msh\ndimension: 2\nanalysis: static\n" + material +
              "boundaries: {root: {type: fixed-displacement, value: [0, 0]}, lug: {type: remote-load, point: [1, 0], moment: [5]}}\n",
          plane),
      ::testing::IsEmpty());
  EXPECT_EQ(plane.boundaries.at("lug").load.moment.at(0).text, "5");
}

TEST(SolidParameters, plane_stress_has_the_stiffness_of_a_thin_sheet) {
  SolidParameters p;
  p.material = {1, 1, 0.3};
  p.dimension = 2;
  p.plane = SolidParameters::Plane::stress;
  const elastic::LameConstants sheet = lame_constants(p);
  // Uniaxial stress in the plane: E' = 4 mu (mu + lambda) / (2 mu + lambda) must be E.
  EXPECT_NEAR(4 * sheet.mu * (sheet.mu + sheet.lambda) / (2 * sheet.mu + sheet.lambda), 1, 1e-14);
  p.plane = SolidParameters::Plane::strain;
  const elastic::LameConstants cut = lame_constants(p);
  EXPECT_NEAR(4 * cut.mu * (cut.mu + cut.lambda) / (2 * cut.mu + cut.lambda), 1 / (1 - 0.09), 1e-14);
}

}  // namespace couplet::parameters_test
