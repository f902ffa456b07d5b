// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
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

/// Volume behind the faces of a surface that has two sides, above 0 where the normals point out of it [m^3]: of a closed
/// one by the divergence theorem, of an open one (a plate's clamped rim is not part of its surface) closed by the cone
/// from the middle of its rim. None: a sheet, of which nothing tells the front from the back.
std::optional<double> volume_behind(const ModalModel& model);

/// Where the normals of a structure's surface must point: out of it, or, of the wall of a cavity, into what it encloses.
enum class Facing { outward, inward };

/// Whether the faces of a surface point to the wrong side: neighbours that do not turn alike, and every part that hangs
/// together (vertices of its own or not) by what lies before and behind its faces: an even number of other faces lies
/// before a face of a body, an odd one behind it, so of two sheets each looks away from the other. Where these do not
/// tell, volume_behind() of the part. Empty: all are right, or nothing tells (a sheet alone).
std::string facing_problem_of(const ModalModel& model, Facing wanted = Facing::outward);

}  // namespace couplet::modes
