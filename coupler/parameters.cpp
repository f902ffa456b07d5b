// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters.hpp"

namespace couplet {
namespace {

void declare_partner(config::Section& section, const char* role, std::string& name, const char* doc) {
  section.section(
      role,
      [&](config::Section& s) {
        s.value("participant", name).required().doc("its name under `participants`");
      },
      doc);
}

void declare(config::Section& section, AccelerationParameters& p) {
  using Type = AccelerationParameters::Type;
  section.choice("type", p.type, {{"constant", Type::constant}, {"aitken", Type::aitken}})
      .doc(
          "constant: always the initial relaxation; aitken: adapted in each iteration from the last two "
          "residuals");
  section.value("initial-relaxation", p.initial_relaxation)
      .range(1e-6, 2)
      .doc("relaxation of the very first iteration, or of all if constant");
  section.value("maximum-relaxation", p.maximum_relaxation)
      .range(1e-6, 2)
      .doc("upper bound of the relaxation that a step inherits from the step before");
}

void declare(config::Section& section, ConvergenceParameters& p) {
  section.value("relative", p.relative)
      .range(1e-14, 1)
      .doc(
          "a step has converged when |r| / |H(x)| is below this; r = H(x) - x, the change of the interface "
          "displacement by one pass");
  section.value("absolute", p.absolute)
      .unit("m")
      .not_negative()
      .doc("or when the root mean square of r over the interface vertices is below this; 0: not used");
  section.value("max-iterations", p.max_iterations)
      .range(1, 10000)
      .doc("a step that needs more has failed and is halved");
}

void declare(config::Section& section, MappingParameters& p) {
  using Type = MappingParameters::Type;
  section.choice("type", p.type, {{"matched", Type::matched}, {"nearest", Type::nearest}})
      .doc(
          "matched: every vertex and face of one side has its twin on the other, all else is an error; "
          "nearest: "
          "displacements from the nearest vertex (consistent), forces to the nearest face (conservative)");
  section.value("tolerance", p.tolerance)
      .unit("m")
      .positive()
      .doc("twins are no further apart than this; by default a millionth of the interface's extent");
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
  declare_partner(section, "fluid", p.fluid, "who receives the interface motion and gives the load");
  declare_partner(section, "structure", p.structure, "who receives the load and gives the interface motion");
  section.optional_section<CouplingParameters::Mesh>(
      "mesh", p.mesh,
      [](config::Section& s, CouplingParameters::Mesh& m) {
        s.value("participant", m.participant).required().doc("its name under `participants`");
      },
      "who moves the mesh of the fluid; without it the mesh is fixed");
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
                "keeps the semi-implicit scheme second order");
      },
      "the first guess of a step");
  section.section(
      "mapping", [&](config::Section& s) { declare(s, p.mapping); },
      "between the two sides of the interface");
  section.check(
      [&]() -> std::string {
        return p.fluid != p.structure ? "" : "fluid and structure must be two different participants";
      },
      "structure");
}

}  // namespace couplet
