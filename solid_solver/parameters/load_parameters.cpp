// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/load_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/fv/expression.hpp"

namespace couplet::solid {
namespace {

using Texts = std::vector<config::ExpressionText>;

/// Of a total, which has no place: a function of time alone.
std::string problem_of_total(const config::ExpressionText& text) {
  if (std::string problem = fv::problem_of(text); !problem.empty()) return problem;
  return fv::Expression(text).uses_space()
             ? fmt::format(
                   "'{}' depends on x, y or z, but a total load has no position; it may depend on t "
                   "only",
                   text.text)
             : "";
}

std::string problem_of_totals(const Texts& texts, int n) {
  if (std::string problem = fv::problem_of(texts, n); !problem.empty()) return problem;
  for (const auto& text : texts)
    if (std::string problem = problem_of_total(text); !problem.empty()) return problem;
  return "";
}

void declare_force(config::Section& s, const char* key, Texts& force, const int& dimension, bool is_required,
                   const char* doc) {
  {
    config::Key k = s.value(key, force);
    k.unit("N").plausible(1e-9, 1e12).doc(doc);
    if (is_required) k.required();
  }
  s.check([&] { return force.empty() ? std::string() : problem_of_totals(force, dimension); }, key);
}

void declare_moment(config::Section& s, Texts& moment, const int& dimension) {
  s.value("moment", moment)
      .unit("N m")
      .plausible(1e-9, 1e12)
      .doc("moment about 'point', one expression of t per component; in 2-D one, positive from x to y");
  s.check([&] { return moment.empty() ? std::string() : problem_of_totals(moment, dimension == 3 ? 3 : 1); },
          "moment");
}

std::string problem_of_nothing(const TotalLoad& load) {
  return load.force.empty() && load.moment.empty() ? "give a 'force', a 'moment' or both" : "";
}

}  // namespace

void declare_total_force(config::Section& s, TotalLoad& load, const int& dimension) {
  declare_force(s, "value", load.force, dimension, true,
                "total force on these faces, one expression of t per component; uniform force per area, in "
                "2-D per metre of depth");
}

void declare_remote_load(config::Section& s, TotalLoad& load, const int& dimension) {
  s.value("point", load.point)
      .unit("m")
      .plausible(1e-9, 1e4)
      .required()
      .doc("point of application of the force, on the patch or away from it");
  declare_force(s, "force", load.force, dimension, false,
                "force at 'point', one expression of t per component; in 2-D per metre of depth");
  declare_moment(s, load.moment, dimension);
  s.choice("coupling", load.is_rigid, {{"distributing", false}, {"rigid", true}})
      .doc(
          "distributing: the faces share the load by area and remain free to deform; rigid: their centres "
          "move as one rigid body (small strain, symmetric face gradient)");
  s.check([&] { return load.is_rigid ? std::string() : problem_of_nothing(load); }, "point");
}

void declare_bearing_load(config::Section& s, TotalLoad& load, const int& dimension) {
  declare_force(s, "force", load.force, dimension, true,
                "total force of a pin or shaft on the cylinder, one expression of t per component, normal "
                "to its axis; in 2-D per metre of depth");
}

void declare_hydrostatic_pressure(config::Section& s, TotalLoad& load, const int& dimension) {
  s.value("density", load.density)
      .unit("kg/m^3")
      .plausible(0.05, 25000)
      .positive()
      .required()
      .doc("density of the liquid");
  s.value("gravity", load.gravity)
      .unit("m/s^2")
      .plausible(1e-3, 2000)
      .required()
      .doc("acceleration of gravity, one number per component");
  s.check(
      [&]() -> std::string {
        if (std::ssize(load.gravity) != dimension)
          return fmt::format("{} components are given, but the {}-dimensional scene needs {}",
                             load.gravity.size(), dimension, dimension);
        return std::ranges::all_of(load.gravity, [](double g) { return g == 0; })
                   ? "a direction is needed, not the zero vector"
                   : "";
      },
      "gravity");
  s.value("level", load.level)
      .unit("m")
      .plausible(1e-9, 1e4)
      .required()
      .doc(
          "height of the free surface against gravity, measured from the origin, of t: y of the surface for "
          "gravity [0, -9.81]; no pressure above it");
  s.check([&] { return problem_of_total(load.level); }, "level");
}

void declare(config::Section& s, PointLoad& load, const int& dimension) {
  s.value("point", load.point).unit("m").plausible(1e-9, 1e4).required().doc("point on the surface");
  declare_force(s, "force", load.force, dimension, false,
                "force at 'point', one expression of t per component; in 2-D per metre of depth");
  declare_moment(s, load.moment, dimension);
  s.value("radius", load.radius)
      .unit("m")
      .plausible(1e-9, 1e4)
      .not_negative()
      .doc(
          "faces with their centre within this distance of 'point' share the load, as for a remote-load; 0: "
          "the nearest face alone takes the force");
  s.check([&] { return problem_of_nothing(load); }, "point");
  s.check(
      [&] {
        return !load.moment.empty() && load.radius == 0
                   ? "a single face cannot take a moment; give a 'radius' that includes several faces"
                   : "";
      },
      "moment");
}

}  // namespace couplet::solid
