// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/text.hpp"

namespace couplet::coupler {

namespace {

void declare_role(config::Section& section, const char* role, std::optional<CouplingParameters::Role>& target,
                  const char* doc) {
  section.optional_section<CouplingParameters::Role>(
      role, target,
      [](config::Section& s, CouplingParameters::Role& r) {
        s.value("participant", r.participant).required().doc("its name under `participants`");
      },
      doc);
}

void declare(config::Section& section, CouplingParameters::Exchange& p) {
  using Order = CouplingParameters::Exchange::Order;
  section.value("participants", p.participants)
      .required()
      .doc("their names under `participants`, in the order of a step");
  section.choice("order", p.order, {{"serial", Order::serial}, {"parallel", Order::parallel}})
      .doc(
          "serial: one after another, each with the data that the preceding ones gave in this step. parallel: all at the same "
          "time, with the data of the last step");
  section.value("digest", p.digest)
      .doc(
          "digest of the precice-config.xml from which `couplet import` wrote the case. A program that reads a different "
          "configuration is refused, and so is a scheme or order that differs from that file; default: not checked");
}

/// Either fluid and structure, or an exchange.
std::string problem_of_roles(const CouplingParameters& p) {
  if (p.exchange) {
    const auto& list = p.exchange->participants;
    if (p.structure)
      return "an exchange has no separate structure, because the structure is one of its participants; use either `exchange` "
             "or `structure`";
    if (bool(p.fluid) != bool(p.mesh))
      return "with an exchange give either both `fluid` and `mesh` (whose mesh is moved, and by which participant) or neither";
    if (p.fluid && std::ranges::find(list, p.fluid->participant) == list.end())
      return "`fluid` with an exchange must be one of its participants";
    if (p.mesh && std::ranges::find(list, p.mesh->participant) != list.end())
      return "`mesh` serves only the fluid and is not one of the exchange's participants";
    return list.size() < 2 ? "an exchange needs two participants or more" : "";
  }
  if (p.moves_alone())
    return p.fluid->participant != p.mesh->participant ? ""
                                                       : "fluid and mesh must be two different participants";
  if (!p.fluid || !p.structure)
    return fmt::format(
        "'{}' is missing; a coupling has 'fluid' and 'structure' (each with its participant), 'fluid' and "
        "'mesh' (whose bodies move as the case prescribes), or 'exchange'",
        p.fluid ? "structure" : "fluid");
  return p.fluid->participant != p.structure->participant
             ? ""
             : "fluid and structure must be two different participants";
}

/// Participants with an interface known to the coupler.
std::vector<std::string> partners_of(const CouplingParameters& p) {
  std::vector<std::string> names;
  if (p.exchange) names = p.exchange->participants;
  if (p.fluid) names.push_back(p.fluid->participant);
  if (p.structure) names.push_back(p.structure->participant);
  return names;
}

void declare(config::Section& section, IntegralParameters& p, const std::vector<std::string>& partners) {
  section.value("participant", p.participant)
      .required()
      .doc("name, under `participants`, of the participant whose interface is watched");
  section.value("data", p.data)
      .required()
      .doc("name of data that it gives or takes, such as pressure-force, velocity or heat");
  section.check(
      [partners, &p] {
        return std::ranges::find(partners, p.participant) != partners.end()
                   ? ""
                   : fmt::format("'{}' takes no part in the coupling; the participants are: {}",
                                 p.participant, base::join(partners));
      },
      "participant");
}

/// Checks for whole numbers and existing participants; the mesh mover's follow the fluid's.
std::string problem_of_sub_steps(const CouplingParameters& p) {
  const std::vector<std::string> names = partners_of(p);
  for (const auto& [name, n] : p.sub_steps) {
    if (std::ranges::find(names, name) == names.end())
      return fmt::format("there is no participant '{}' that supports sub-steps", name);
    if (n != std::round(n) || n < 1 || n > 10000)
      return fmt::format("'{}' needs a whole number of sub-steps from 1 to 10000", name);
    if (n == 1 || !p.fluid) continue;
    if (name != p.fluid->participant) continue;
    if (p.scheme.is_semi_implicit())
      return "the fluid supports no sub-steps in the semi-implicit scheme, which splits its step in two; "
             "use `scheme: implicit` or `explicit`";
    if (p.mesh)
      return "a fluid with a moving mesh supports no sub-steps: a motion that fails half-way would leave "
             "the mesh mover waiting; use a smaller `simulation.time-step`";
  }
  return "";
}

/// Declares the participants.
void declare_participants(config::Section& section, CouplingParameters& p) {
  section.optional_section<CouplingParameters::FluidRole>(
      "fluid", p.fluid,
      [](config::Section& s, CouplingParameters::FluidRole& r) {
        s.value("participant", r.participant).required().doc("its name under `participants`");
        s.value("displacement", r.displacement)
            .doc("name of the displacement (m, or without a unit) that another program takes at vertices");
        s.value("load", r.load).doc("name of the force (N) that another program gives, with `displacement`");
        s.check(
            [&] {
              return r.displacement.empty() == r.load.empty()
                         ? std::string()
                         : "'displacement' and 'load' are given together: the names of another program's data";
            },
            "load");
      },
      "participant that receives the interface motion and gives the load");
  section.optional_section<CouplingParameters::StructureRole>(
      "structure", p.structure,
      [](config::Section& s, CouplingParameters::StructureRole& r) {
        s.value("participant", r.participant).required().doc("its name under `participants`");
        s.value("displacement", r.displacement)
            .doc(
                "name of its displacement (m, or without a unit) at vertices in its program; a missing velocity is computed by second-order differences");
        s.value("load", r.load)
            .doc(
                "name in its program of its load (N), which is the sum of all forces; default: each force has its own name");
      },
      "participant that receives the load and gives the interface motion. Without it, but with `mesh`, bodies move as the mesh "
      "mover's boundaries prescribe (type: moving), and nothing is iterated");
  declare_role(section, "mesh", p.mesh,
               "participant that moves the mesh of the fluid; default: the mesh is at rest");
  section.optional_section<CouplingParameters::Exchange>(
      "exchange", p.exchange, [](config::Section& s, CouplingParameters::Exchange& e) { declare(s, e); },
      "instead of fluid, structure and mesh: participants of any kind that exchange data once per step; data that one "
      "participant takes come from the participant that gives them");
}

void declare_predictor(config::Section& section, CouplingParameters& p) {
  section.section(
      "predictor",
      [&](config::Section& s) {
        s.value("order", p.predictor_order)
            .range(0, 2)
            .doc(
                "order of the extrapolation that gives the initial guess of a step. 0: last displacement. 1: also the last "
                "velocity. 2: also the last two velocities, which keeps the semi-implicit scheme second order. Data without a "
                "velocity are extrapolated by a polynomial of this order. Default: 2, but 1 in explicit coupling and 0 in an "
                "explicit exchange");
        s.check(
            [&p] {
              const double order = p.predictor_order.value_or(0);
              return order == std::round(order) ? "" : "it must be 0, 1 or 2";
            },
            "order");
      },
      "initial guess of a step");
}

void declare_sub_steps(config::Section& section, CouplingParameters& p) {
  section.value("sub-steps", p.sub_steps)
      .doc(
          "number of steps that a participant takes within each coupling step, by its name: {fluid: 4}; default: 1. Its input "
          "is interpolated linearly in time between the last and the new values, so that the coupling stays second order");
  section.check([&p] { return problem_of_sub_steps(p); }, "sub-steps");
}

void declare_scheme(config::Section& section, CouplingParameters& p) {
  section
      .choice("scheme", p.scheme,
              {{"auto", {}},
               {"explicit", coupling::Scheme::explicit_},
               {"semi-implicit", coupling::Scheme::semi_implicit},
               {"implicit", coupling::Scheme::implicit}})
      .doc(
          "explicit: one iteration per step. semi-implicit: mesh motion and momentum predictor once per step, pressure and "
          "structure iterated. implicit: everything iterated. auto: starts semi-implicit and switches to implicit when the "
          "fluid dragged along by friction becomes too important for the motion of the interface");
}

}  // namespace

void declare(config::Section& section, CouplingParameters& p) {
  declare_scheme(section, p);
  declare_participants(section, p);
  section.section(
      "acceleration", [&](config::Section& s) { declare(s, p.acceleration); },
      "method that computes the next iterate from the residual");
  section.section(
      "convergence", [&](config::Section& s) { declare(s, p.convergence); }, "criteria for accepting a step");
  declare_predictor(section, p);
  declare_sub_steps(section, p);
  using Order = CouplingParameters::Exchange::Order;
  section
      .choice("order", p.order,
              {{"serial", Order::serial},
               {"parallel", Order::parallel},
               {"structure-first", Order::structure_first}})
      .doc(
          "order of fluid and structure. serial: the structure uses the load of the same iteration (Gauss-Seidel). parallel: "
          "both are solved at the same time (Jacobi). structure-first: the fluid uses the motion of the same iteration, and "
          "the load is iterated, as required by a fluid with `surface-density` at its interface (Robin)");
  section.value("mesh-on-guess", p.mesh_on_guess)
      .doc(
          "for `scheme: implicit`: the mesh stays where the initial guess of the step put it, as in the semi-implicit scheme "
          "and in the implicit steps of auto; the iteration is then stable for lighter structures");
  section.check(
      [&] {
        return p.mesh_on_guess && (p.scheme != coupling::Scheme::implicit || !p.mesh)
                   ? "it requires `scheme: implicit` with a `mesh` mover; the semi-implicit scheme and `auto` "
                     "always do so"
                   : "";
      },
      "mesh-on-guess");
  section.section(
      "mapping", [&](config::Section& s) { declare(s, p.mapping); },
      "data transfer between the two sides of the interface");
  section.map<IntegralParameters>(
      "watch", p.watch, [&p](config::Section& s, IntegralParameters& w) { declare(s, w, partners_of(p)); },
      "integral",
      "integrals over interfaces, one row per step in coupler/watch.csv: sums of amounts (N, W), fluxes of "
      "vectors, integral and mean of scalars");
  section.check([&] { return problem_of_roles(p); }, p.exchange ? "exchange" : "structure");
}

void declare(config::Section& section, AccelerationParameters& p) {
  using Type = AccelerationParameters::Type;
  section
      .choice("type", p.type,
              {{"constant", Type::constant}, {"aitken", Type::aitken}, {"iqn-ils", Type::iqn_ils}})
      .doc(
          "constant: always the initial relaxation. aitken: adapted in each iteration from the last two residuals. iqn-ils: "
          "quasi-Newton by least squares over the differences of this and earlier steps");
  section.value("initial-relaxation", p.initial_relaxation)
      .range(1e-6, 2)
      .doc(
          "relaxation factor of the very first iteration, or of all if constant; recommended: 1 / (1 + r), where r is the "
          "ratio of the added mass to the structural mass");
  section.value("reused-steps", p.reused_steps)
      .range(0, 1000)
      .doc("iqn-ils: number of earlier steps whose differences are reused");
  section.value("filter", p.filter)
      .range(0, 1)
      .doc(
          "iqn-ils: a difference is dropped if less than this fraction of it is linearly independent of newer ones; sensible "
          "values exceed the ratio of the participants' noise to the convergence tolerance");
}

void declare(config::Section& section, ConvergenceParameters& p) {
  section.value("relative", p.relative)
      .range(1e-14, 1)
      .doc(
          "a step has converged when |r| is below this fraction of |H(x) - x^n|, the motion of the interface in the "
          "step, or below 1e-7 |H(x)|; r = H(x) - x, the change in one iteration");
  section.value("absolute", p.absolute)
      .unit("m", 1e-18, 0.1)
      .not_negative()
      .doc(
          "a step has also converged when the root mean square of r over the interface vertices is below this limit; 0 "
          "disables it");
  section.value("max-iterations", p.max_iterations)
      .range(1, 10000)
      .doc("maximum number of iterations; a step that needs more fails and is halved");
  section.choice("at-max-iterations", p.accepts_at_maximum, {{"fail", false}, {"accept", true}})
      .doc(
          "what happens after `max-iterations` without convergence. fail: the step fails and is halved. accept: the step is "
          "accepted, with the finding `unconverged-step`");
}

void declare(config::Section& section, MappingParameters& p) {
  using Type = MappingParameters::Type;
  section
      .choice("type", p.type,
              {{"matched", Type::matched}, {"nearest", Type::nearest}, {"projection", Type::projection}})
      .doc(
          "matched: every vertex and face must match one on the other side. nearest: displacements are taken from the nearest "
          "vertex and forces are given to the nearest face, which conserves their sum; for faces that match or nest. "
          "projection: for any faces; loads use the transpose of the map of the motion, so work, force and moment are "
          "conserved. Local interpolants are used where the corners of faces are not known");
  section.value("tolerance", p.tolerance)
      .unit("m", 1e-15, 1)
      .positive()
      .doc("maximum distance of matching vertices; default: a millionth of the interface's extent");
}

}  // namespace couplet::coupler
