// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters.hpp"

#include <fmt/format.h>

#include "common/fv/expression.hpp"

namespace couplet {
namespace {

// `p.dimension` was read before the boundaries.
void declare_boundary(config::Section& s, SolidBoundary& b, const SolidParameters& p) {
  using Type = SolidBoundary::Type;
  const auto displacement = [&b, &p](config::Section& v) {
    v.value("value", b.value).required().doc("displacement, one expression of x, y, z, t a component [m]");
    v.check([&] { return problem_of(b.value, p.dimension); }, "value");
  };
  const auto traction = [&b, &p](config::Section& v) {
    v.value("value", b.value).required().doc("force per area, one expression of x, y, z, t a component [Pa]");
    v.check([&] { return problem_of(b.value, p.dimension); }, "value");
  };
  const auto pressure = [&b](config::Section& v) {
    v.value("value", b.pressure).required().doc("pressure that pushes into the solid, of x, y, z, t [Pa]");
    v.check([&] { return problem_of(b.pressure); }, "value");
  };
  const auto nothing = [](config::Section&) {};
  s.variant<Type>("type", b.type,
                  {{"fixed-displacement", Type::fixed_displacement, displacement},
                   {"traction", Type::traction, traction},
                   {"pressure", Type::pressure, pressure},
                   {"symmetry", Type::symmetry, nothing},
                   {"free", Type::free, nothing},
                   {"interface", Type::interface_, nothing}},
                  "what is known on the patch; 'interface' takes its load from the coupler", true);
}

void declare_material(config::Section& s, SolidMaterial& m) {
  s.value("density", m.density).unit("kg/m^3").positive().required().doc("density");
  s.value("youngs-modulus", m.youngs_modulus).unit("Pa").positive().required().doc("Young's modulus");
  s.value("poissons-ratio", m.poissons_ratio)
      .range(-0.99, 0.499)
      .required()
      .doc("Poisson's ratio; accuracy fades above 0.45");
}

void declare_linear_solver(config::Section& s, SolidLinearSolver& l) {
  using Method = SolidLinearSolver::Method;
  s.choice("method", l.method,
           {{"auto", Method::automatic},
            {"direct", Method::direct},
            {"bicgstab-ilu", Method::bicgstab_ilu},
            {"gmres-multigrid", Method::gmres_multigrid}})
      .doc("auto: direct up to 60 000 unknowns (static: 200 000), above that bicgstab-ilu");
  s.value("relative-tolerance", l.relative_tolerance)
      .range(1e-15, 1e-2)
      .doc("residual over right-hand side at which the iteration stops");
  s.value("max-iterations", l.max_iterations).range(1, 1e6).doc("iterations after which a step has failed");
}

void check_together(config::Section& s, SolidParameters& p) {
  const auto check_components = [&](const char* key, const std::vector<config::ExpressionText>& texts) {
    s.check([&] { return texts.empty() ? std::string() : problem_of(texts, p.dimension); }, key);
  };
  check_components("body-force", p.body_force);
  check_components("initial-velocity", p.initial_velocity);
  s.check(
      [&] {
        return p.gravity.empty() || std::ssize(p.gravity) == p.dimension
                   ? std::string()
                   : fmt::format("{} components are given where the {}-dimensional scene needs {}",
                                 p.gravity.size(), p.dimension, p.dimension);
      },
      "gravity");
  s.check(
      [&] {
        return p.damping && p.analysis == SolidParameters::Analysis::static_
                   ? "damping has no effect in a static analysis; remove it"
                   : "";
      },
      "damping");
  s.check([&] { return p.boundaries.empty() ? "each patch of the mesh needs an entry" : ""; }, "boundaries");
}

}  // namespace

void declare(config::Section& s, SolidParameters& p) {
  using Analysis = SolidParameters::Analysis;
  using Plane = SolidParameters::Plane;
  s.value("mesh", p.mesh).required().doc("mesh file, .msh or .geo, relative to the YAML");
  s.value("dimension", p.dimension).range(2, 3).doc("2: cells in the plane z = 0, unit depth; 3");
  s.choice("plane", p.plane, {{"strain", Plane::strain}, {"stress", Plane::stress}})
      .doc("what a 2-D scene is a cut of");
  s.choice("analysis", p.analysis, {{"dynamic", Analysis::dynamic}, {"static", Analysis::static_}})
      .doc("static leaves out inertia");
  s.section(
      "material", [&](config::Section& m) { declare_material(m, p.material); }, "linear elastic material");
  s.map<SolidBoundary>(
      "boundaries", p.boundaries, [&p](config::Section& b, SolidBoundary& v) { declare_boundary(b, v, p); },
      "patch", "one entry for each patch of the mesh");
  s.value("body-force", p.body_force)
      .doc("force per volume, one expression of x, y, z, t a component [N/m^3]");
  s.value("gravity", p.gravity).unit("m/s^2").doc("acceleration of gravity, one number a component");
  s.value("initial-velocity", p.initial_velocity)
      .doc("velocity at the start, one expression of x, y, z a component [m/s]");
  s.optional_section<SolidDamping>(
      "damping", p.damping,
      [](config::Section& d, SolidDamping& v) {
        d.value("mass", v.mass).unit("1/s").not_negative().doc("Rayleigh coefficient of the mass matrix");
        d.value("stiffness", v.stiffness)
            .unit("s")
            .not_negative()
            .doc("Rayleigh coefficient of the stiffness matrix");
      },
      "structural damping; dynamic analysis only");
  s.section(
      "linear-solver", [&](config::Section& l) { declare_linear_solver(l, p.linear_solver); },
      "how the linear system of a step is solved");
  s.map<SolidProbe>(
      "probes", p.probes,
      [](config::Section& q, SolidProbe& v) {
        q.value("point", v.point).required().doc("place in the undeformed solid [m]");
      },
      "probe", "places whose displacement is written to probes.csv at each step");
  s.section(
      "output",
      [&](config::Section& o) {
        o.value("deformed", p.output_deformed).doc("write the mesh points where they have moved to");
        o.value("stress", p.output_stress).doc("write stress components and the equivalent stress");
      },
      "fields written at the output interval");
  check_together(s, p);
}

LameConstants lame_constants(const SolidParameters& p) {
  const double e = p.material.youngs_modulus, nu = p.material.poissons_ratio;
  LameConstants lame{e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu))};
  // sigma_zz = 0 eliminates the strain across the plane.
  if (p.dimension == 2 && p.plane == SolidParameters::Plane::stress)
    lame.lambda = 2 * lame.lambda * lame.mu / (lame.lambda + 2 * lame.mu);
  return lame;
}

}  // namespace couplet
