// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/role_checks.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/coupling/roles.hpp"

namespace couplet::coupler {
namespace {

void check_dimensions(const std::vector<Side>& sides, const std::string& structure) {
  const Side& first = *std::ranges::find(sides, structure, &Side::name);
  for (const Side& other : sides)
    if (other.interface.dim != first.interface.dim)
      throw Error("'{}' has {} dimensions and '{}' has {}: both must have the same.", other.name,
                  other.interface.dim, first.name, first.interface.dim);
}

}  // namespace

void check_roles(const CouplingParameters& p, const std::vector<Side>& sides) {
  if (p.moves_alone()) return;  // neither has an interface
  if (!p.exchange && p.structure) check_dimensions(sides, p.structure->participant);
  const auto check = [&](const char* role, const auto& who) {  // as it is: a Role of it would be a copy
    if (!who) return;
    const auto side = std::ranges::find(sides, who->participant, &Side::name);
    if (side == sides.end()) return;
    const std::string problem =
        coupling::problem_of_role(coupling::contract_of(role), side->interface.takes, side->interface.gives);
    if (!problem.empty())
      throw Error("'{}' cannot be the {} (`coupling.{}`): {}.", side->name, role, role, problem);
  };
  if (p.fluid && !p.fluid->foreign())
    check("fluid", p.fluid);  // another program's data were looked at one by one
  check("structure", p.structure);
  check("mesh", p.mesh);
}

}  // namespace couplet::coupler
