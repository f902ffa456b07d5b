// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/parameters/load_stepping.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "solid_solver/parameters/parameters.hpp"

namespace couplet::solid {
namespace {

using Texts = std::vector<config::ExpressionText>;

/// The first text that depends on t; empty: none does, or it cannot be read, which is reported elsewhere.
std::string first_in_time(const Texts& texts) {
  for (const config::ExpressionText& e : texts)
    if (fv::problem_of(e).empty() && fv::Expression(e).uses_time()) return e.text;
  return {};
}

Texts texts_of(const TotalLoad& load) {
  Texts all = load.force;
  all.insert(all.end(), load.moment.begin(), load.moment.end());
  all.push_back(load.level);
  return all;
}

Texts texts_of(const SolidCondition& c) {
  Texts all = texts_of(c.load);
  for (const Texts* more : {&c.value, &c.traction}) all.insert(all.end(), more->begin(), more->end());
  for (const auto& component : c.components)
    if (component) all.push_back(*component);
  all.push_back(c.pressure);
  all.push_back(c.along);
  return all;
}

constexpr const char* why =
    "depends on t; 'load-stepping: {type: arc-length}' multiplies all loads and prescribed displacements by one load "
    "factor, so they must be constant in time: give those of load factor 1";

std::string wrong_boundary(const SolidParameters& p) {
  for (const auto& [name, b] : p.boundaries) {
    std::vector<SolidCondition> all(b.parts.begin(), b.parts.end());
    all.push_back(b);
    for (const SolidCondition& c : all) {
      if (is_interface(c))
        return fmt::format(
            "patch '{}' takes its load from the coupler, and 'load-stepping: {{type: arc-length}}' cannot scale it; "
            "use 'type: load'",
            name);
      if (const std::string text = first_in_time(texts_of(c)); !text.empty())
        return fmt::format("'{}' of patch '{}' {}", text, name, why);
    }
  }
  return {};
}

}  // namespace

void declare(config::Section& s, LoadStepping& l) {
  using Type = LoadStepping::Type;
  s.choice("type", l.type, {{"load", Type::load}, {"arc-length", Type::arc_length}})
      .doc(
          "load: the steps follow the loads as functions of t; arc-length: a step is a length along the load path, "
          "which passes limit points of load (snap-through) and of displacement; loads are those at load factor 1, "
          "constant in time");
  s.value("first-load-factor", l.first_load_factor)
      .range(1e-6, 1)
      .doc("for arc-length: load factor of the first step; sets the length of the later ones");
  s.value("iterations", l.iterations)
      .range(2, 15)
      .doc("for arc-length: iterations of Newton's method per step towards which the length is adapted");
  s.value("longest", l.longest)
      .range(1, 1e4)
      .doc("for arc-length: largest length of a step over that of the first one");
}

void check_load_stepping(config::Section& s, SolidParameters& p) {
  const auto check = [&](const char* key, auto problem) {
    s.check(
        [&p, problem]() -> std::string {
          return p.load_stepping.type == LoadStepping::Type::arc_length ? problem() : std::string();
        },
        key);
  };
  check("load-stepping", [&p]() -> std::string {
    return p.analysis == SolidParameters::Analysis::static_ && has_finite_strain(p) &&
                   !is_updated_lagrangian(p)
               ? ""
               : "'type: arc-length' requires 'analysis: static', 'kinematics: finite-strain' and Newton's method "
                 "('solution-method: {type: auto}')";
  });
  check("boundaries", [&p] { return wrong_boundary(p); });
  check("point-loads", [&p]() -> std::string {
    for (const auto& [name, load] : p.point_loads)
      if (const std::string text = first_in_time(texts_of(load)); !text.empty())
        return fmt::format("'{}' of '{}' {}", text, name, why);
    return {};
  });
  check("body-force", [&p]() -> std::string {
    const std::string text = first_in_time(p.body_force);
    return text.empty() ? text : fmt::format("'{}' {}", text, why);
  });
  check("thermal-expansion", [&p]() -> std::string {
    return p.expansion
               ? "thermal strain cannot be multiplied by the load factor of 'load-stepping: {type: arc-length}'; "
                 "use 'type: load'"
               : "";
  });
  check("output", [&p]() -> std::string {
    return p.output.energies ? "'energies' is not available with 'load-stepping: {type: arc-length}'" : "";
  });
}

}  // namespace couplet::solid
