// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/boundary_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/fv/expression.hpp"
#include "solid_solver/parameters/parameter_checks.hpp"

namespace couplet::solid {

namespace {

using Texts = std::vector<config::ExpressionText>;

/// Checks an expression for a total, which may depend only on time.
std::string problem_of_total(const config::ExpressionText& text) {
  return fv::Expression(text).uses_space()
             ? fmt::format(
                   "'{}' depends on x, y or z, but a total load has no position; it may depend on t only",
                   text.text)
             : "";
}

std::string problem_of_totals(const Texts& texts) {
  for (const auto& text : texts)
    if (std::string problem = problem_of_total(text); !problem.empty()) return problem;
  return "";
}

void declare_force(config::Section& s, const char* key, Texts& force, bool is_required, const char* doc) {
  {
    config::Key k = s.value(key, force);
    k.unit("N", 1e-9, 1e12).doc(doc);
    if (is_required) k.required();
  }
  s.check([&] { return problem_of_totals(force); }, key);
}

void declare_moment(config::Section& s, Texts& moment, const int& dimension) {
  {
    config::Key key = s.value("moment", moment);
    if (dimension == 2) key.size(1);
    key.unit("N m", 1e-9, 1e12)
        .doc(
            "moment about 'point', one expression of t per component; in 2-D a single expression, positive from x to y");
  }
  s.check([&] { return problem_of_totals(moment); }, "moment");
}

std::string problem_of_nothing(const TotalLoad& load) {
  return load.force.empty() && load.moment.empty() ? "give a 'force', a 'moment' or both" : "";
}

}  // namespace

void declare_total_force(config::Section& s, TotalLoad& load) {
  declare_force(
      s, "value", load.force, true,
      "total force on these faces, one expression of t per component, applied as a uniform force per area; in 2-D per meter of "
      "depth");
}

void declare_remote_load(config::Section& s, TotalLoad& load, const int& dimension) {
  s.value("point", load.point)
      .unit("m", 1e-9, 1e4)
      .required()
      .doc("point of application of the force, on the patch or away from it");
  declare_force(s, "force", load.force, false,
                "force at 'point', one expression of t per component; in 2-D per meter of depth");
  declare_moment(s, load.moment, dimension);
  s.choice("coupling", load.is_rigid, {{"distributing", false}, {"rigid", true}})
      .doc(
          "distributing: the load is distributed over the faces by area, and they remain free to deform. rigid: their centers "
          "move as one rigid body (small strain, symmetric face gradient)");
  s.check([&] { return load.is_rigid ? std::string() : problem_of_nothing(load); }, "point");
}

void declare_bearing_load(config::Section& s, TotalLoad& load) {
  declare_force(s, "force", load.force, true,
                "total force of a pin or shaft on the cylinder, one expression of t per component, normal "
                "to its axis; in 2-D per meter of depth");
}

void declare_hydrostatic_pressure(config::Section& s, TotalLoad& load, const int& dimension) {
  s.value("density", load.density)
      .unit("kg/m^3", 0.05, 25000)
      .positive()
      .required()
      .doc("density of the liquid");
  s.value("gravity", load.gravity)
      .unit("m/s^2", 1e-3, 2000)
      .required()
      .doc("acceleration of gravity, one number per component");
  s.check(
      [&]() -> std::string {
        if (std::ssize(load.gravity) != dimension)
          return fmt::format("{} components are given, but the {}-dimensional case needs {}",
                             load.gravity.size(), dimension, dimension);
        return std::ranges::all_of(load.gravity, [](double g) { return g == 0; })
                   ? "a direction is needed, not the zero vector"
                   : "";
      },
      "gravity");
  s.value("level", load.level)
      .unit("m", 1e-9, 1e4)
      .required()
      .doc(
          "height of the free surface, an expression of t, measured from the origin against the direction of gravity: the y of "
          "the surface for gravity [0, -9.81]; there is no pressure above it");
  s.check([&] { return problem_of_total(load.level); }, "level");
}

void declare(config::Section& s, PointLoad& load, const int& dimension) {
  s.value("point", load.point).unit("m", 1e-9, 1e4).required().doc("point on the surface");
  declare_force(s, "force", load.force, false,
                "force at 'point', one expression of t per component; in 2-D per meter of depth");
  declare_moment(s, load.moment, dimension);
  s.value("radius", load.radius)
      .unit("m", 1e-9, 1e4)
      .not_negative()
      .doc(
          "faces whose centers are within this distance of 'point' share the load, as for a remote-load; with 0, only the "
          "nearest face takes the force");
  s.check([&] { return problem_of_nothing(load); }, "point");
  s.check(
      [&] {
        return !load.moment.empty() && load.radius == 0
                   ? "a single face cannot take a moment; give a 'radius' that includes several faces"
                   : "";
      },
      "moment");
}

namespace {

using Type = SolidCondition::Type;

/// Either empty, or one expression per component.
void declare_vector(config::Section& s, const char* key, std::vector<config::ExpressionText>& texts,
                    const char* unit, const char* doc) {
  constexpr std::pair usual_length{1e-9, 1e4}, usual_pressure{1e-9, 1e11};
  const auto [lowest, highest] = std::string_view(unit) == "m" ? usual_length : usual_pressure;
  s.value(key, texts).unit(unit, lowest, highest).doc(doc);
}

std::string problem_of_components(const SolidCondition& c, int dimension) {
  const auto given = [&](int i) { return c.components[i].has_value(); };
  const bool any = given(0) || given(1) || given(2);
  if (any != c.value.empty())
    return "give either 'value' (all components) or 'components' (the prescribed ones of x, y, z)";
  return dimension == 2 && given(2) ? "a 2-dimensional case has no component z" : "";
}

void declare_displacement(config::Section& s, SolidCondition& c, const int& dimension) {
  s.value("value", c.value)
      .unit("m", 1e-9, 1e4)
      .doc("displacement, one expression of x, y, z, t per component");
  s.section(
      "components",
      [&c](config::Section& v) {
        for (int i = 0; i < 3; ++i)
          v.value(base::axis_letters[i], c.components[i])
              .unit("m", 1e-9, 1e4)
              .doc("displacement along this axis, an expression of x, y, z, t");
      },
      "instead of 'value': only the prescribed components; the others are free. On a part of a patch this prescribes the "
      "displacement of its faces, but not of the vertices at its edge");
  s.check([&] { return problem_of_components(c, dimension); }, "value");
  declare_vector(s, "traction", c.traction, "Pa", "force per area on the free components");
}

void declare_plate(config::Section& s, SolidCondition& c) {
  s.value("plate-normal", c.normal).doc("normal of the plate, a vector of any length");
  s.check([&c] { return c.normal.norm() > 0 ? "" : "a direction is needed, not the zero vector"; },
          "plate-normal");
  declare_vector(s, "traction", c.traction, "Pa", "force per area on the remaining free components");
}

void declare_roller(config::Section& s, SolidCondition& c) {
  s.value("direction", c.normal)
      .required()
      .doc("direction in which the displacement is prescribed, a vector of any length");
  s.check([&c] { return c.normal.norm() > 0 ? "" : "a direction is needed, not the zero vector"; },
          "direction");
  s.value("value", c.along)
      .unit("m", 1e-9, 1e4)
      .doc("displacement along this direction, an expression of x, y, z, t");
  declare_vector(s, "traction", c.traction, "Pa", "force per area perpendicular to this direction");
}

void declare_spring(config::Section& s, SolidCondition& c) {
  s.value("stiffness", c.stiffness)
      .unit("N/m^3", 1, 1e16)
      .required()
      .doc(
          "spring stiffness (Winkler foundation): force per area and displacement, an expression of x, y, z");
  s.choice("direction", c.along_normal, {{"all", false}, {"normal", true}})
      .doc("displacement components that the springs resist");
  declare_vector(s, "value", c.value, "m",
                 "displacement of the far ends of the springs, an expression of x, y, z, t");
  declare_vector(s, "traction", c.traction, "Pa", "force per area in addition to the springs");
}

void declare_condition(config::Section& s, SolidCondition& c, const int& dimension, bool whole_patch) {
  const auto displacement = [&](config::Section& v) { declare_displacement(v, c, dimension); };
  const auto traction = [&](config::Section& v) {
    v.value("value", c.value)
        .unit("Pa", 1e-9, 1e11)
        .required()
        .doc("force per area, one expression of x, y, z, t per component");
  };
  const auto pressure = [&](config::Section& v) {
    v.value("value", c.pressure)
        .unit("Pa", 1e-9, 1e11)
        .required()
        .doc("pressure acting into the solid, an expression of x, y, z, t");
  };
  const auto plate = [&](config::Section& v) { declare_plate(v, c); };
  const auto roller = [&](config::Section& v) { declare_roller(v, c); };
  const auto spring = [&](config::Section& v) { declare_spring(v, c); };
  const auto force = [&](config::Section& v) { declare_total_force(v, c.load); };
  const auto remote = [&](config::Section& v) { declare_remote_load(v, c.load, dimension); };
  const auto bearing = [&](config::Section& v) { declare_bearing_load(v, c.load); };
  const auto hydrostatic = [&](config::Section& v) { declare_hydrostatic_pressure(v, c.load, dimension); };
  const auto nothing = [](config::Section&) {};
  std::vector<std::tuple<std::string, Type, config::Section::Declare>> types{
      {"fixed-displacement", Type::fixed_displacement, displacement},
      {"traction", Type::traction, traction},
      {"pressure", Type::pressure, pressure},
      {"force", Type::force, force},
      {"remote-load", Type::remote_load, remote},
      {"bearing-load", Type::bearing_load, bearing},
      {"hydrostatic-pressure", Type::hydrostatic_pressure, hydrostatic},
      {"symmetry", Type::symmetry, nothing},
      {"frictionless", Type::frictionless, nothing},
      {"roller", Type::roller, roller},
      {"soft-support", Type::soft_support, plate},
      {"hard-support", Type::hard_support, plate},
      {"spring", Type::spring, spring},
      {"zero-normal-gradient", Type::zero_normal_gradient, nothing},
      {"free", Type::free, nothing}};
  if (whole_patch) types.emplace_back("interface", Type::interface_, nothing);
  s.variant<Type>(
      "type", c.type, types,
      "boundary condition; force: total force; remote-load: force and moment at a point, distributed by area; bearing-load: "
      "cosine pressure of a pin on half of a cylinder; hydrostatic-pressure: pressure of a liquid below its level; symmetry: a "
      "plane of any orientation; frictionless: no displacement normal to the surface, curved or not; roller: no displacement "
      "along one direction, or a given one; soft-support: no displacement along the plate's normal; hard-support: no "
      "displacement along the plate's normal or along the edge; zero-normal-gradient: the displacement does not change along "
      "the normal; interface (whole patches): the load comes from the coupler",
      true);
}

}  // namespace

bool is_load(const SolidCondition& c) {
  switch (c.type) {
    case Type::traction:
    case Type::pressure:
    case Type::force:
    case Type::remote_load:
    case Type::bearing_load:
    case Type::hydrostatic_pressure:
    case Type::free:
    case Type::interface_:
      return true;
    default:
      return false;
  }
}

bool is_interface(const SolidCondition& c) { return c.type == Type::interface_; }

bool is_rigid(const SolidCondition& c) { return c.type == Type::remote_load && c.load.is_rigid; }

bool is_symmetry_plane(const SolidCondition& c) { return c.type == Type::symmetry; }

bool has_no_energy(const SolidCondition& c) { return c.type == Type::zero_normal_gradient; }

void declare(config::Section& s, SolidBoundary& b, const int& dimension) {
  declare_condition(s, b, dimension, true);
  s.list<SolidPart>(
      "parts", b.parts,
      [&dimension](config::Section& p, SolidPart& part) {
        p.value("where", part.where)
            .required()
            .doc("expression of x, y, z at the face centers, nonzero on the faces of this part");
        p.check(
            [&part] {
              return fv::Expression(part.where).uses_time()
                         ? "the faces of a part stay the same: use an expression of x, y, z, without t"
                         : "";
            },
            "where");
        declare_condition(p, part, dimension, false);
      },
      "parts of the patch, such as a line of faces, with their own condition; the first one that selects a "
      "face applies");
}

bool is_pressure(const SolidCondition& condition) {
  return condition.type == Type::pressure || condition.type == Type::hydrostatic_pressure;
}

bool can_be_revolved(const SolidCondition& condition) {
  constexpr std::array supported{
      Type::fixed_displacement, Type::traction,     Type::pressure, Type::hydrostatic_pressure,
      Type::symmetry,           Type::frictionless, Type::roller,   Type::free};
  return std::ranges::find(supported, condition.type) != supported.end();
}

}  // namespace couplet::solid
