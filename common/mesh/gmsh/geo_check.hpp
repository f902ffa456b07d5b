// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "common/mesh/gmsh/geo_lexer.hpp"

namespace couplet::mesh {

/// What in a .geo is not let through to gmsh: "'SystemCall'", and its line. Every rule looks at a piece and its nearest
/// neighbours, so that it holds wherever gmsh goes on reading after a mistake, a jump or a branch that is not taken.
struct GeoOffence {
  std::string what;  ///< empty: all of it is allowed
  std::size_t line = 0;
};
GeoOffence find_offence(const GeoTokens& script);

/// Where the quoted name of a file stands, if an Include, a Merge or a ShapeFromFile with one is at `i`; otherwise 0.
std::size_t file_name_after(const std::vector<GeoToken>& tokens, std::size_t i);

}  // namespace couplet::mesh
