// SPDX-License-Identifier: Apache-2.0
// The section `gaps`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/fv/expression.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {
namespace {

void declare_gap(config::Section& s, GapParameters& gap) {
  s.value("between", gap.between).required().doc("the two walls (patches), a valve and its seat");
  s.value("opening", gap.opening)
      .unit("m")
      .plausible(1e-8, 10)
      .positive()
      .required()
      .doc("cells where the walls are closer than this are blocked");
  s.value("height", gap.height)
      .unit("m")
      .plausible(1e-9, 1e4)
      .doc(
          "height of the seat, the second wall, along 'direction', of x, y, z at rest: the mesh is refused if its wall is "
          "elsewhere, and the 'contact' of a structure may name the gap; absent: where the mesh has it");
  s.value("direction", gap.direction).doc("direction from the seat to the valve; absent: z, in 2-D y");
  s.check([&gap] { return gap.height ? fv::problem_of(*gap.height) : std::string(); }, "height");
  s.check(
      [&gap] {
        const auto& d = gap.direction;
        const bool fits = d.empty() || ((d.size() == 2 || d.size() == 3) &&
                                        std::hypot(d[0], d[1], d.size() > 2 ? d[2] : 0) > 0);
        return fits ? std::string() : "two or three numbers are needed, not all 0";
      },
      "direction");
  s.check(
      [&gap] {
        const bool two = gap.between.size() == 2 && gap.between[0] != gap.between[1];
        return two ? std::string() : "requires two different patches";
      },
      "between");
}

/// A gap that nothing can open or close: what it blocks at the start remains blocked; empty if there is none.
std::string gap_at_rest(const FluidParameters& p) {
  const auto rests = [&p](const std::string& patch) {
    const auto wall = p.boundaries.find(patch);
    if (wall == p.boundaries.end()) return false;
    const GivenBy by = condition_of(wall->second).velocity;
    return by != GivenBy::structure && by != GivenBy::motion && by != GivenBy::mesh;
  };
  for (const auto& [name, gap] : p.gaps)
    if (std::ranges::all_of(gap.between, rests))
      return fmt::format(
          "both walls of '{}' are at rest, so that it neither closes nor opens: one of them must be of `type: interface` or "
          "`body`",
          name);
  return "";
}

}  // namespace

void declare_gaps(config::Section& s, FluidParameters& p) {
  s.map<GapParameters>(
      "gaps", p.gaps, declare_gap, "gap",
      "gaps that nearly close as the mesh moves: their cells block the flow, do not limit the step size, "
      "and open again");
  s.doubt([&p] { return gap_at_rest(p); }, "gaps");
}

}  // namespace couplet::fluid
