// SPDX-License-Identifier: Apache-2.0
#include "coupler/parameters/parameters.hpp"

namespace couplet::coupler {

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
          "residuals; iqn-ils: quasi-Newton from the differences of this and earlier steps by least "
          "squares; iqn-mvj: the same, each step's differences correcting the previous Jacobian");
  section.value("initial-relaxation", p.initial_relaxation)
      .range(1e-6, 2)
      .doc(
          "relaxation of the very first iteration, or of all if constant; recommended: 1 / (1 + r) for the "
          "added mass over the structural mass r");
  section.value("maximum-relaxation", p.maximum_relaxation)
      .range(1e-6, 2)
      .doc("aitken: upper bound of the initial relaxation of a step");
  section.value("reused-steps", p.reused_steps)
      .range(0, 1000)
      .doc("iqn: number of earlier steps whose differences are reused");
  section.value("maximum-columns", p.maximum_columns)
      .range(1, 10000)
      .doc("iqn: maximum number of differences; each takes as much memory as three interface vectors");
  section.value("filter", p.filter)
      .range(0, 1)
      .doc(
          "iqn: a difference is dropped if less than this share is independent of newer ones; sensible "
          "values are above the participants' noise over the convergence tolerance");
}

void declare(config::Section& section, ConvergenceParameters& p) {
  section.value("relative", p.relative)
      .range(1e-14, 1)
      .doc(
          "a step has converged when |r| / |H(x)| is below this; r = H(x) - x, the change of the interface "
          "displacement in one pass");
  section.value("absolute", p.absolute)
      .unit("m")
      .plausible(1e-18, 0.1)
      .not_negative()
      .doc("or when the root mean square of r over the interface vertices is below this; 0: not used");
  section.value("both", p.both)
      .doc("true: not one of both limits is enough, `relative` and `absolute` have to be met");
  section.check([&p] { return !p.both || p.absolute > 0 ? "" : "it needs `absolute`"; }, "both");
  section.value("max-iterations", p.max_iterations)
      .range(1, 10000)
      .doc("maximum number of iterations; a step that needs more fails and is halved");
  section.value("min-iterations", p.min_iterations)
      .range(1, 10000)
      .doc("minimum number of iterations, converged or not");
  section.check(
      [&p] { return p.min_iterations <= p.max_iterations ? "" : "it is more than `max-iterations`"; },
      "min-iterations");
  using AtMaximum = ConvergenceParameters::AtMaximum;
  section
      .choice("at-max-iterations", p.at_maximum, {{"fail", AtMaximum::fail}, {"accept", AtMaximum::accept}})
      .doc(
          "after `max-iterations` without convergence: fail: the step is halved; accept: the step is accepted, with "
          "the finding `unconverged-step`");
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
          "matched: every vertex and face must match one on the other side; nearest: displacements from the "
          "nearest vertex, forces to the nearest face with their sum conserved, for faces that match or "
          "nest; projection, rbf: for any faces: loads use the transpose of the motion's map, so work, "
          "force and moment are conserved; surface slopes from neighbouring faces (projection) or from a "
          "local interpolant by compact radial functions through more faces (rbf)");
  section.value("tolerance", p.tolerance)
      .unit("m")
      .plausible(1e-15, 1)
      .positive()
      .doc("maximum distance of matching vertices; default: a millionth of the interface's extent");
}

}  // namespace couplet::coupler
