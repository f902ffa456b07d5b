// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/mesh/gmsh/geo_lexer.hpp"

namespace couplet::mesh {

/// The pieces of a .geo one after the other as text that any lexer cuts in the same way: no comments, blanks between all
/// pieces, each in the line where it stood, but for lines longer than gmsh's buffer and for what follows a For, an If or a
/// Macro: gmsh jumps to the beginning of a line. `name_of`: the name to write for an included file.
std::string rewrite_geo(const std::vector<GeoToken>& tokens,
                        const std::function<std::string(const std::string&)>& name_of);

}  // namespace couplet::mesh
