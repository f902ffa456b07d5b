// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/parameters.hpp"

#include "common/config/load.hpp"
#include "common/fv/expression.hpp"
#include "tests/support/test.hpp"

namespace couplet::parameters_test {
using namespace solid;

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

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

TEST(SolidParameters, mistakes_are_reported_with_their_place) {
  SolidParameters p;
  const auto errors = read("mesh: a.msh\ndimension: 2\n" + material +
                               "boundaries:\n"
                               "  root: {type: fixed-displacement, value: [0, 0, 0]}\n"
                               "  tip: {type: traction, value: [0, 5*q]}\n"
                               "  side: {type: symetry}\n",
                           p);
  EXPECT_THAT(errors,
              Contains(AllOf(HasSubstr("case.yaml:5:"), HasSubstr("boundaries.root.value"),
                             HasSubstr("3 components are given, but the 2-dimensional scene needs 2"))));
  EXPECT_THAT(errors, Contains(AllOf(HasSubstr("case.yaml:6:"), HasSubstr("unknown name 'q'"))));
  EXPECT_THAT(errors, Contains(AllOf(HasSubstr("case.yaml:7:"), HasSubstr("Did you mean 'symmetry'?"))));
}

TEST(SolidParameters, a_seat_that_cannot_be_is_told_with_its_line) {
  const auto read_with = [](const std::string& seat, const std::string& more, const std::string& first) {
    SolidParameters p;
    return read(
        "mesh: a.msh\ndimension: 2\n" + first + "\n" + material +
            "boundaries: {root: {type: fixed-displacement, value: [0, 0]}, foot: {type: free}}\ncontact: " +
            seat + "\n" + more,
        p);
  };
  const std::string good = "{height: -1 mm, direction: [0, 1, 0]}";
  EXPECT_THAT(read_with(good, "", "analysis: dynamic"), ::testing::IsEmpty());
  const auto told = [&](const std::string& seat, const std::string& more, const std::string& line,
                        const std::string& wanted, const std::string& first = "analysis: dynamic") {
    EXPECT_THAT(read_with(seat, more, first),
                Contains(AllOf(HasSubstr("case.yaml:" + line + ":"), HasSubstr(wanted))))
        << seat << more;
  };
  told("{direction: [0, 1, 1]}", "", "6", "must lie in the plane");
  told("{direction: [0, 0, 0]}", "", "6", "contact.direction");
  told("{height: sin(t)}", "", "6", "the seat is at rest");
  told(good, "time-scheme: {type: bathe}\n", "6",
       "keeps the energy with 'time-scheme: {type: trapezoidal}' only");
  told(good, "solution-method: {face-gradient: thesis}\n", "7", "requires 'face-gradient: symmetric'");
  told(good, "solution-method: {type: segregated}\n", "7", "requires 'face-gradient: symmetric'");
  told(good, "output: {buckling: 2}\n", "7", "knows nothing of a seat", "analysis: static");
  told(good, "plane: axisymmetric\n", "7", "a body of revolution cannot meet a seat");
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

TEST(SolidParameters, loads_that_cannot_be_are_told_with_their_line) {
  const auto told = [&](const std::string& text, const std::string& wanted, const std::string& line = "7") {
    SolidParameters p;
    EXPECT_THAT(read("mesh: a.msh\ndimension: 3\nanalysis: static\n" + material +
                         "boundaries:\n  root: {type: symmetry}\n" + text + "\n",
                     p),
                Contains(AllOf(HasSubstr("case.yaml:" + line + ":"), HasSubstr(wanted))))
        << text;
  };
  told("  lug: {type: force}", "lug.value: this required key is missing");
  told("  lug: {type: force, value: [1 Pa, 0, 0]}", "Pa");
  told("  lug: {type: force, value: [x, 0, 0]}", "a total load has no position");
  told("  lug: {type: force, value: [1, 0]}", "2 components are given");
  told("  lug: {type: remote-load, force: [1, 0, 0]}", "lug.point: this required key is missing");
  told("  lug: {type: remote-load, point: [1, 0, 0]}", "give a 'force', a 'moment' or both");
  told("  lug: {type: remote-load, point: [1, 0, 0], moment: [1]}", "1 components are given");
  told("  lug: {type: remote-load, point: [1, 0, 0], moment: [1 N, 0, 0]}", "N m");
  told("  lug: {type: bearing-load}", "lug.force: this required key is missing");
  told("  dam: {type: hydrostatic-pressure, density: 1000, gravity: [0, 0, 0], level: 1}", "the zero vector");
  told("  dam: {type: hydrostatic-pressure, density: 1000, gravity: [0, -9.81], level: 1}", "2 components");
  told("  dam: {type: hydrostatic-pressure, density: 1000, gravity: [0, 0, 1], level: z}",
       "a total load has no position");
  told("  dam: {type: hydrostatic-pressure, density: -1, gravity: [0, 0, 1], level: 1}", "density");
  told("point-loads:\n  pin: {point: [1, 2, 3], moment: [1, 0, 0]}", "a single face cannot take a moment",
       "8");
}

TEST(SolidParameters, rules_between_keys_are_checked) {
  const std::string start =
      "mesh: a.msh\nanalysis: static\n" + material + "boundaries:\n  all: {type: free}\n";
  SolidParameters flat, damped;
  EXPECT_THAT(read(start + "gravity: [0, -9.81]\n", flat),
              Contains(AllOf(HasSubstr("case.yaml:6:"),
                             HasSubstr("2 components are given, but the 3-dimensional scene needs 3"))));
  EXPECT_THAT(read(start + "damping: {stiffness: 1e-5 s}\n", damped),
              Contains(AllOf(HasSubstr("case.yaml:6:"), HasSubstr("no effect in a static analysis"))));
}

TEST(SolidParameters, finite_strain_says_what_it_cannot_have) {
  const std::string start = "mesh: a.msh\nboundaries: {root: {type: fixed-displacement, value: [0, 0, 0]}}\n",
                    body = "density: 1, youngs-modulus: 1, poissons-ratio: 0.3",
                    large = "kinematics: finite-strain\n";
  const auto told = [&](const std::string& text, const std::string& wanted) {
    SolidParameters p;
    EXPECT_THAT(read(start + text, p), Contains(HasSubstr(wanted))) << text;
  };
  SolidParameters good;
  EXPECT_THAT(read(start + large + "energy-momentum: true\nmaterial: {" + body +
                       ", law: yeoh, law-coefficients: [0.1, 0.01]}\n",
                   good),
              ::testing::IsEmpty());
  told(large + "material: {" + body + ", law: yeo}\n", "Did you mean 'yeoh'");
  told(large + "material: {" + body + ", law: neo-hookean, law-coefficients: [1]}\n",
       "the law 'neo-hookean' has no parameters");
  told(large + "material: {" + body + ", law: mooney-rivlin, law-coefficients: [1, 2]}\n",
       "c01 / (c10 + c01)");
  told("material: {" + body + ", law: yeoh}\n", "requires 'kinematics: finite-strain'");
  told("energy-momentum: true\nmaterial: {" + body + "}\n", "it requires 'kinematics: finite-strain'");
  told(large + "damping: {stiffness: 1}\nmaterial: {" + body + "}\n", "damps rigid rotations");
  told(large + "solution-method: {type: block-coupled}\nmaterial: {" + body + "}\n", "Newton's method");
  told(large + "solution-method: {face-gradient: thesis}\nmaterial: {" + body + "}\n", "Newton's method");
  const std::string thesis = large + "solution-method: {type: segregated}\n",
                    of = "material: {" + body + "}\n";
  SolidParameters segregated;
  EXPECT_THAT(read(start + thesis + of, segregated), ::testing::IsEmpty());
  told(large + "solution-method: {type: segregated, face-gradient: symmetric}\n" + of, "updated-Lagrangian");
  told(large + "solution-method: {type: segregated, volume-strain: cells}\n" + of,
       "it requires 'face-gradient: symmetric'");
  told(thesis + "energy-momentum: true\n" + of, "has no energy-momentum stress");
  told(thesis + "output: {energies: true}\n" + of, "writes no energies");
  told(thesis + "materials: {a: {zones: [a], " + body + "}, b: {zones: [b], " + body + "}}\n",
       "supports one material only");
  told(large + "output: {spectrum: true}\nmaterial: {" + body + "}\n", "use small-strain");
  told(large + "solution-method: {volume-strain: shared}\nmaterial: {" + body + "}\n", "but not 'shared'");
  const std::string quantity = "quantities: {tip: {point: [1, 0, 0], component: y}}\n";
  told(large + quantity + "material: {" + body + "}\n", "estimated in a linear static analysis");
  told(quantity + "material: {" + body + "}\n", "estimated in a linear static analysis");
  told("quantities: {tip: {point: [1, 0, 0]}}\nmaterial: {" + body + "}\n",
       "a displacement has the components x, y, z; give one");
  told("quantities: {tip: {field: stress, component: xx}}\nmaterial: {" + body + "}\n",
       "a stress needs a 'point'");
  const std::string warm = "thermal-expansion: {}\ntemperature: 300 K\n",
                    expanding = "material: {" + body + ", expansion: 1e-5}\n";
  SolidParameters heated;
  EXPECT_THAT(read(start + large + warm + expanding, heated), ::testing::IsEmpty());
  told(thesis + warm + expanding, "at finite strain has no thermal strain");
  told(large + "energy-momentum: true\n" + warm + expanding, "conserves energy at constant temperature only");
  told(large + "output: {energies: true}\n" + warm + expanding, "does not count the work of thermal strain");
  told(large +
           "thermoelastic-coupling: true\nthermal-expansion: {}\nheat: {analysis: transient}\nmaterial: {" +
           body + ", expansion: 1e-5, conductivity: 50, specific-heat: 500}\n",
       "not the heat of deformation");
  const std::string facing =
      "mesh: a.msh\nboundaries: {root: {type: fixed-displacement, value: [0, 0, 0]}, wet: {type: interface}}\n" +
      large + "interface: {load: pressure}\nmaterial: {" + body + "}\n";
  EXPECT_THAT(read(facing, good), Contains(HasSubstr("would not follow the surface")));
}

TEST(SolidParameters, a_large_sheet_says_what_it_cannot_have) {
  const std::string start =
      "mesh: a.msh\ndimension: 2\nplane: stress\nkinematics: finite-strain\n"
      "material: {density: 1, youngs-modulus: 1, poissons-ratio: 0.499}\n";
  const std::string held = "boundaries: {root: {type: fixed-displacement, value: [0, 0]}";
  SolidParameters good, p;
  EXPECT_THAT(read(start + held + "}\n", good), ::testing::IsEmpty());
  const auto told = [&](const std::string& text, const std::string& wanted) {
    SolidParameters q;
    EXPECT_THAT(read(start + text, q), Contains(HasSubstr(wanted))) << text;
  };
  told(held + ", side: {type: pressure, value: 1}}\n", "would act on its present thickness");
  told(held + "}\nsolution-method: {volume-strain: cells}\n", "which does not lock there");
  told(held + "}\nsolution-method: {type: segregated}\n", "supports plane strain only");
  told(held + "}\nenergy-momentum: true\n", "its stress supports plane strain only");
}

TEST(SolidParameters, a_body_of_revolution_says_what_it_cannot_have) {
  const std::string start = "mesh: a.msh\ndimension: 2\nplane: axisymmetric\nanalysis: static\n" + material;
  const std::string held = "boundaries: {root: {type: fixed-displacement, value: [0, 0]}";
  SolidParameters good;
  EXPECT_THAT(read(start + held + "}\n", good), ::testing::IsEmpty());
  const auto told = [&](const std::string& text, const std::string& wanted) {
    SolidParameters q;
    EXPECT_THAT(read(start + text, q), Contains(HasSubstr(wanted))) << text;
  };
  told(held + "}\nkinematics: finite-strain\n", "supports small strain only");
  told(held + ", side: {type: spring, stiffness: 1}}\n", "'frictionless', 'roller' and 'free'");
  told(held + "}\nsolution-method: {face-gradient: thesis}\n", "is solved with 'face-gradient: symmetric'");
  told(held + "}\nsolution-method: {volume-strain: cells}\n", "is solved with 'face-gradient: symmetric'");
  told(held + "}\noutput: {modes: 3}\n", "supports none of 'spectrum', 'modes'");
  told(held + ", wet: {type: interface}}\n", "'frictionless', 'roller' and 'free'");
  SolidParameters heated;
  EXPECT_THAT(
      read("mesh: a.msh\ndimension: 2\nplane: axisymmetric\nanalysis: static\n" + held +
               "}\nheat: {analysis: steady}\nmaterial: {density: 1, youngs-modulus: 1, poissons-ratio: "
               "0.3, conductivity: 50}\n",
           heated),
      Contains(HasSubstr("does not conduct heat")));
}

TEST(SolidParameters, arc_length_says_what_it_cannot_scale) {
  const std::string start =
      "mesh: a.msh\nanalysis: static\nmaterial: {density: 1, youngs-modulus: 1, poissons-ratio: 0.3}\n"
      "load-stepping: {type: arc-length}\n";
  const std::string held = "boundaries:\n  root: {type: fixed-displacement, value: [0, 0, 0]}\n";
  const auto read_all = [&](const std::string& text) {
    SolidParameters p;
    return read(start + text, p);
  };
  const std::string large = "kinematics: finite-strain\n";
  EXPECT_THAT(read_all(large + held + "  tip: {type: traction, value: [1, 0, 0]}\n"), ::testing::IsEmpty());
  EXPECT_THAT(read_all(held),
              Contains(HasSubstr("requires 'analysis: static', 'kinematics: finite-strain'")));
  EXPECT_THAT(read_all(large + held + "  tip: {type: traction, value: [2*t, 0, 0]}\n"),
              Contains(HasSubstr("'2*t' of patch 'tip' depends on t")));
  EXPECT_THAT(read_all(large + held + "  tip: {type: pressure, value: sin(t)}\n"),
              Contains(HasSubstr("'sin(t)'")));
  EXPECT_THAT(read_all(large + held + "  tip: {type: interface}\n"),
              Contains(HasSubstr("takes its load from the coupler")));
  EXPECT_THAT(read_all(large + held + "body-force: [0, t, 0]\n"), Contains(HasSubstr("'t' depends on t")));
  EXPECT_THAT(read_all(large + held + "output: {energies: true}\n"),
              Contains(HasSubstr("'energies' is not available")));
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

// A place in space without its z is none at z = 0.
TEST(SolidParameters, places_have_a_number_for_each_dimension) {
  const std::string start =
      "mesh: a.msh\nboundaries: {root: {type: fixed-displacement, value: [0, 0, 0]}}\n"
      "material: {density: 1, youngs-modulus: 1, poissons-ratio: 0.3}\n";
  const auto told = [&](const std::string& text, const std::string& wanted) {
    SolidParameters p;
    EXPECT_THAT(read(start + text, p), Contains(HasSubstr(wanted))) << text;
  };
  told("quantities: {tip: {point: [1, 0], component: y}}\n", "'point' has 3 numbers");
  told("probes: {tip: {point: [1, 0]}}\n", "expected a list of 3 entries, found 2");
  told("analysis: static\nquantities: {hot: {point: [1, 0, 0], field: temperature}}\n",
       "quantities of 'analysis: thermal'");
  SolidParameters space;
  EXPECT_THAT(read(start + "analysis: static\nprobes: {tip: {point: [1, 0, 0]}}\n", space),
              ::testing::IsEmpty());
}

}  // namespace couplet::parameters_test
