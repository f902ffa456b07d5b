// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// Three cells in a row. The one in the middle is owned; its two faces are parallel, across the line of the cells.
struct Link {
  Index before, cell, after;
  Index face;                        ///< one of the two, whose S points from `before` to `after`
  int axis = -1;                     ///< that S lies along; -1: none
  double g_before = 0, g_after = 0;  ///< conductances of the two [m]
};

/// The links of a mesh at rest, in the order of their cells.
template <int D>
struct Lines {
  std::vector<Link> links;
  double share = 0;  ///< of the cells and directions of the whole mesh that are links

  /// Collective.
  Lines(const mesh::Mesh& mesh, const Placement<D>& at);
  /// As the operators of fourth order see the placement: in the middle between the cells where both have a link across the
  /// face. Collective.
  std::shared_ptr<const Placement<D>> seen(const mesh::Mesh& mesh, const Placement<D>& at) const;
};

}  // namespace couplet::fluid
