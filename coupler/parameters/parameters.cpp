// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/text.hpp"

namespace couplet {
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
          "serial: one after the other, each with what those before it gave in this step; parallel: all at "
          "the "
          "same time with what was given in the last step");
}

/// Either fluid and structure, or an exchange.
std::string problem_of_roles(const CouplingParameters& p) {
  if (p.exchange) {
    const auto& list = p.exchange->participants;
    if (p.structure)
      return "an exchange has no structure beside it: it is one of its participants; take one or the other";
    if (bool(p.fluid) != bool(p.mesh))
      return "beside an exchange stand either both `fluid` and `mesh` (whose mesh is moved, and by whom) or "
             "neither";
    if (p.fluid && std::ranges::find(list, p.fluid->participant) == list.end())
      return "`fluid` beside an exchange must be one of its participants";
    if (p.mesh && std::ranges::find(list, p.mesh->participant) != list.end())
      return "`mesh` serves the fluid alone and is not one of the exchange's participants";
    return list.size() < 2 ? "an exchange needs two participants or more" : "";
  }
  if (!p.fluid || !p.structure)
    return fmt::format(
        "'{}' is missing; a coupling has 'fluid' and 'structure' (each with its participant), or "
        "'exchange'",
        p.fluid ? "structure" : "fluid");
  return p.fluid->participant != p.structure->participant
             ? ""
             : "fluid and structure must be two different participants";
}

/// Those with an interface that the coupler knows.
std::vector<std::string> partners_of(const CouplingParameters& p) {
  std::vector<std::string> names;
  if (p.exchange) names = p.exchange->participants;
  if (p.fluid) names.push_back(p.fluid->participant);
  if (p.structure) names.push_back(p.structure->participant);
  return names;
}

void declare(config::Section& section, WatchParameters& p, const std::vector<std::string>& partners) {
  section.value("participant", p.participant)
      .required()
      .doc("whose interface: its name under `participants`");
  section.value("data", p.data)
      .required()
      .doc("name of what it gives or takes, as pressure-force, velocity or heat");
  section.value("part", p.part).doc("patch of the interface; absent: all of it");
  section.check(
      [partners, &p] {
        return std::ranges::find(partners, p.participant) != partners.end()
                   ? ""
                   : fmt::format("'{}' takes no part in the coupling; those that do: {}", p.participant,
                                 join(partners));
      },
      "participant");
}

/// Whole numbers, of participants that there are; the mesh mover's follow the fluid's.
std::string problem_of_sub_steps(const CouplingParameters& p) {
  const std::vector<std::string> names = partners_of(p);
  for (const auto& [name, n] : p.sub_steps) {
    if (std::ranges::find(names, name) == names.end())
      return fmt::format("there is no participant '{}' that could take sub-steps", name);
    if (n != std::round(n) || n < 1 || n > 10000)
      return fmt::format("'{}' takes a whole number of sub-steps from 1 to 10000", name);
    if (n == 1 || !p.fluid || name != p.fluid->participant) continue;
    if (p.scheme == Scheme::semi_implicit)
      return "the fluid takes no sub-steps in the semi-implicit scheme, which splits its step in two; take "
             "`scheme: implicit` or `explicit`";
    if (p.mesh)
      return "a fluid whose mesh is moved takes no sub-steps: a motion that fails half-way would leave the "
             "mover "
             "waiting; give the sub-steps to the structure";
  }
  return "";
}

void declare(config::Section& section, AccelerationParameters& p) {
  using Type = AccelerationParameters::Type;
  section
      .choice("type", p.type,
              {{"constant", Type::constant},
               {"aitken", Type::aitken},
               {"iqn-ils", Type::iqn_ils},
               {"iqn-mvj", Type::iqn_mvj}})
      .doc(
          "constant: always the initial relaxation; aitken: adapted in each iteration from the last two "
          "residuals; iqn-ils: quasi-Newton from the differences of this and earlier steps by least squares; "
          "iqn-mvj: the same, each step's differences correcting the Jacobian of those before it");
  section.value("initial-relaxation", p.initial_relaxation)
      .range(1e-6, 2)
      .doc(
          "relaxation of the very first iteration, or of all if constant; good is 1 / (1 + r) for added mass "
          "over structural mass r");
  section.value("maximum-relaxation", p.maximum_relaxation)
      .range(1e-6, 2)
      .doc("aitken: upper bound of the relaxation that a step begins with");
  section.value("reused-steps", p.reused_steps)
      .range(0, 1000)
      .doc("iqn: earlier steps whose differences are used, too");
  section.value("maximum-columns", p.maximum_columns)
      .range(1, 10000)
      .doc("iqn: most differences kept; each takes as much memory as three interface vectors");
  section.value("filter", p.filter)
      .range(0, 1)
      .doc(
          "iqn: a difference of which less than this share is independent of newer ones is given up; noise "
          "of "
          "the participants over the convergence tolerance is a lower bound of what makes sense");
}

void declare(config::Section& section, ConvergenceParameters& p) {
  section.value("relative", p.relative)
      .range(1e-14, 1)
      .doc(
          "a step has converged when |r| / |H(x)| is below this; r = H(x) - x, the change of the interface "
          "displacement by one pass");
  section.value("absolute", p.absolute)
      .unit("m")
      .plausible(1e-18, 0.1)
      .not_negative()
      .doc("or when the root mean square of r over the interface vertices is below this; 0: not used");
  section.value("max-iterations", p.max_iterations)
      .range(1, 10000)
      .doc("a step that needs more has failed and is halved");
}

void declare(config::Section& section, MappingParameters& p) {
  using Type = MappingParameters::Type;
  section
      .choice("type", p.type,
              {{"matched", Type::matched},
               {"nearest", Type::nearest},
               {"projection", Type::projection},
               {"rbf", Type::rbf}})
      .doc(
          "matched: every vertex and face of one side has its match on the other, all else is an error; nearest: "
          "displacements from the nearest vertex, forces to the nearest face with their sum kept, for faces that match or "
          "nest; projection, rbf: for any faces: loads go by the transpose of the motion's map, so that work, force and "
          "moment are kept; slopes along the surface from neighbouring faces (projection) or from a local interpolant by "
          "compact radial functions through more faces (rbf)");
  section.value("tolerance", p.tolerance)
      .unit("m")
      .plausible(1e-15, 1)
      .positive()
      .doc(
          "matching vertices are no further apart than this; by default a millionth of the interface's extent");
}

}  // namespace

void declare(config::Section& section, CouplingParameters& p) {
  section
      .choice("scheme", p.scheme,
              {{"explicit", Scheme::explicit_},
               {"semi-implicit", Scheme::semi_implicit},
               {"implicit", Scheme::implicit}})
      .doc(
          "explicit: one pass a step; semi-implicit: mesh motion and momentum predictor once a step, "
          "pressure and "
          "structure iterated; implicit: everything iterated");
  declare_role(section, "fluid", p.fluid, "who receives the interface motion and gives the load");
  declare_role(section, "structure", p.structure, "who receives the load and gives the interface motion");
  declare_role(section, "mesh", p.mesh, "who moves the mesh of the fluid; without it the mesh is fixed");
  section.optional_section<CouplingParameters::Exchange>(
      "exchange", p.exchange, [](config::Section& s, CouplingParameters::Exchange& e) { declare(s, e); },
      "in place of fluid, structure and mesh: participants of any kind that exchange data once a step; each "
      "datum that one takes comes from the one that gives it");
  section.section(
      "acceleration", [&](config::Section& s) { declare(s, p.acceleration); },
      "how the next guess follows from the residual");
  section.section(
      "convergence", [&](config::Section& s) { declare(s, p.convergence); }, "when a step is accepted");
  section.section(
      "predictor",
      [&](config::Section& s) {
        s.value("order", p.predictor_order)
            .range(0, 2)
            .doc(
                "first guess of a step: 0 the last displacement; 1 with the last velocity; 2 with the last "
                "two, which "
                "keeps the semi-implicit scheme second order; data without a velocity by a polynomial of "
                "this order. "
                "By default 2, and 0 in an explicit exchange");
        s.check(
            [&p] {
              const double order = p.predictor_order.value_or(0);
              return order == std::round(order) ? "" : "it is a whole number: 0, 1 or 2";
            },
            "order");
      },
      "the first guess of a step");
  section.value("sub-steps", p.sub_steps)
      .doc("steps that a participant takes within each coupling step, by its name: {fluid: 4}; by default 1");
  using Waveform = CouplingParameters::Waveform;
  section.choice("waveform", p.waveform, {{"linear", Waveform::linear}, {"constant", Waveform::constant}})
      .doc(
          "what sub-steps see: linear: the line in time through the last values and the new ones (second "
          "order); "
          "constant: the new ones");
  section.check([&] { return problem_of_sub_steps(p); }, "sub-steps");
  section.check(
      [&] {
        return p.mesh_on_guess && (p.scheme != Scheme::implicit || !p.mesh)
                   ? "it is for `scheme: implicit` with a `mesh` mover; the semi-implicit scheme does so by itself"
                   : "";
      },
      "mesh-on-guess");
  using Order = CouplingParameters::Exchange::Order;
  section
      .choice("order", p.order,
              {{"serial", Order::serial},
               {"parallel", Order::parallel},
               {"structure-first", Order::structure_first}})
      .doc(
          "of fluid and structure: serial: the structure with the load of the same pass (Gauss-Seidel); parallel: both "
          "at the same time (Jacobi); structure-first: the fluid with the motion of the same pass, the load is "
          "iterated: what a fluid with `surface-density` at its interface (Robin) needs");
  section.value("mesh-on-guess", p.mesh_on_guess)
      .doc(
          "implicit: the mesh stays where the first guess of the step puts it, as in the semi-implicit scheme: the "
          "loop holds for lighter structures");
  section.section(
      "mapping", [&](config::Section& s) { declare(s, p.mapping); },
      "between the two sides of the interface");
  section.value("interface-output", p.interface_output)
      .doc(
          "with each output the data of all interfaces are written for ParaView, too: "
          "coupler/interface/<name>.pvd");
  section.map<WatchParameters>(
      "watch", p.watch, [&p](config::Section& s, WatchParameters& w) { declare(s, w, partners_of(p)); },
      "integral",
      "integrals over interfaces, a row a step in coupler/watch.csv: sums of amounts (N, W), fluxes of vectors, "
      "integral and mean of scalars");
  using OnDivergence = CouplingParameters::OnDivergence;
  section
      .choice("on-divergence", p.on_divergence, {{"stop", OnDivergence::stop}, {"warn", OnDivergence::warn}})
      .doc(
          "when the motion swings from step to step and grows, or the work on the two sides parts: stop: the "
          "run "
          "ends with the reason; warn: it is said once");
  section.check([&] { return problem_of_roles(p); }, p.exchange ? "exchange" : "structure");
}

}  // namespace couplet
