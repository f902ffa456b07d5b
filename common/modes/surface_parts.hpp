// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/modes/modal_model.hpp"

namespace couplet::modes {

/// The faces of a surface with one number for all vertices that stand at the same place (to 1e-6 of the surface's size and
/// a hundredth of its shortest edge): another program may write them once for every face or every part.
struct WeldedSurface {
  mesh::Csr faces;  ///< numbers of places in place of vertices; those left with fewer than 3 are empty
  std::vector<std::vector<Index>> part;  ///< faces of each part that hangs together by its edges
};

WeldedSurface weld(const ModalModel& model);

/// Whether two faces that meet along an edge, be it by vertices of their own, turn alike. Empty: they do. Where more than
/// two faces meet nothing is said: they may be bodies that touch.
std::string neighbour_problem_of(const ModalModel& model, const WeldedSurface& welded);

}  // namespace couplet::modes
