// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/mesh/mesh.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Where an equation that cannot be solved asks for most: "Its right-hand side is largest, 3e+200, in cell 7 at
/// (0.1, 0.5, 0) m." Such an entry that is not a number counts as larger than all. `size`: of an owned cell's entry.
/// Collective; the same on all ranks.
template <int D>
std::string largest_entry(const mesh::Mesh& mesh, const Placement<D>& at,
                          const std::function<double(Index)>& size);

}  // namespace couplet::fluid
