// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/effect_cards.hpp"

#include <algorithm>
#include <array>

namespace couplet::mesh_mover {
namespace {

using P = Parameters;
std::string when(bool on, const char* reason) { return on ? reason : ""; }

bool slips(const P& p) {
  return std::ranges::any_of(p.boundaries,
                             [](const auto& b) { return b.second.motion == BoundaryMotion::slip; });
}

bool joins(const P& p) {
  return std::ranges::any_of(p.boundaries,
                             [](const auto& b) { return b.second.motion == BoundaryMotion::periodic; });
}

bool moves(const P& p) {
  return std::ranges::any_of(p.boundaries,
                             [](const auto& b) { return b.second.motion == BoundaryMotion::moving; });
}

const std::array cards{
    Card{"volume stiffening", "`stiffening` above 0",
         [](const P& p) { return when(p.stiffening > 0, "stiffening"); },
         "a stiffness per face, computed once"},
    Card{"sliding patches", "a boundary of `type: slip`",
         [](const P& p) { return when(slips(p), "a boundary of type slip"); },
         "a separate matrix for each direction that is held differently; on curved patches the nearest "
         "point of the patch for each mesh point"},
    Card{"periodic patches", "a boundary of `type: periodic`",
         [](const P& p) { return when(joins(p), "a boundary of type periodic"); },
         "a sum over the points of these patches per component and motion"},
    Card{"elastic mesh motion", "`method: pseudo-solid`",
         [](const P& p) { return when(p.method == Method::pseudo_solid, "method: pseudo-solid"); },
         "an elastic body of all cells, one coupled solve per motion"},
    Card{"rotations carried into the mesh", "`method: rotations`",
         [](const P& p) { return when(p.method == Method::rotations, "method: rotations"); },
         "a second Laplacian solve; none where everything moves as one rigid body"},
    Card{"mesh motion by a barrier", "`method: barrier`, or `auto` where laplacian would invert a cell",
         [](const P& p) { return when(p.method == Method::barrier, "method: barrier"); },
         "Newton's method on the distortion of the cells: a matrix and its factors where they have aged"},
    Card{"incremental mesh motion", "`form: incremental`",
         [](const P& p) { return when(p.form == Form::incremental, "form: incremental"); },
         "a second mesh; a new matrix and factors in each step"},
    Card{"prescribed motion of patches", "a boundary of `type: moving`",
         [](const P& p) { return when(moves(p), "a boundary of type moving"); },
         "its expressions at the patch's points"},
    Card{"limits on cell quality", "a limit in `guard`",
         [](const P& p) { return when(p.guard.judges_shape(), "guard"); },
         "quality measures of all cells in each solve"},
    Card{"minimum cell volume", "`smallest-volume-ratio` above 0",
         [](const P& p) { return when(p.smallest_volume_ratio > 0, "smallest-volume-ratio"); }},
    Card{"third dimension", "`dimension: 3`",
         [](const P& p) { return when(p.dimension == 3, "dimension: 3"); }},
};

}  // namespace

std::span<const Card> effect_cards() { return cards; }

}  // namespace couplet::mesh_mover
