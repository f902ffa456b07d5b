// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace couplet::mesh {

/// One piece of gmsh's .geo language.
struct GeoToken {
  enum class Kind { word, number, text, symbol, end } kind = Kind::end;
  std::string_view text;  ///< of a quoted text: without the quotes
  std::size_t line = 0;   ///< counts from 1

  bool is(std::string_view symbol_or_word) const { return kind != Kind::text && text == symbol_or_word; }
  bool is_word() const { return kind == Kind::word; }
  bool is_text() const { return kind == Kind::text; }
};

/// The pieces of a .geo as gmsh's own lexer cuts it (Parser/Gmsh.l), without comments.
struct GeoTokens {
  std::vector<GeoToken> tokens;
  /// What gmsh might cut in another way, an open comment, say, and its line; empty if there is nothing such.
  std::string doubt;
  std::size_t line = 0;
};

/// The tokens point into `text`.
GeoTokens cut_geo(std::string_view text);

}  // namespace couplet::mesh
