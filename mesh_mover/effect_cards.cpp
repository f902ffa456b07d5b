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

const std::array cards{
    Card{"volume stiffening",
         "`stiffening` above 0",
         [](const P& p) { return when(p.stiffening > 0, "stiffening"); },
         {"a stiffness a face, computed once", 0, 0}},
    Card{"sliding patches",
         "a boundary of `type: slip`",
         [](const P& p) { return when(slips(p), "a boundary of type slip"); },
         {"a matrix of its own for each direction that is held differently", 0, 0}},
    Card{"least volume of a cell", "`smallest-volume-ratio` above 0",
         [](const P& p) { return when(p.smallest_volume_ratio > 0, "smallest-volume-ratio"); }},
    Card{"third dimension", "`dimension: 3`",
         [](const P& p) { return when(p.dimension == 3, "dimension: 3"); }},
};

}  // namespace

std::span<const Card> effect_cards() { return cards; }

}  // namespace couplet::mesh_mover
