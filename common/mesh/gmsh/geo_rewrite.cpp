// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/geo_rewrite.hpp"

#include "common/mesh/gmsh/geo_check.hpp"

namespace couplet::mesh {
namespace {

constexpr std::size_t longest_line = 1000;

/// Whether gmsh goes on reading from behind this piece after a jump: the end of a For, an If, the name of a Macro.
class Heads {
 public:
  bool ends_with(const GeoToken& token, const GeoToken& before) {
    if (token.is("For") || token.is("If") || token.is("ElseIf")) {
      in_head_ = true;
      depth_ = 0;
      return false;
    }
    if (in_head_) {
      depth_ += token.is("(") || token.is("{") || token.is("[");
      const bool closes = token.is(")") || token.is("}") || token.is("]");
      depth_ -= closes;
      in_head_ = !closes || depth_ > 0;
      return !in_head_;
    }
    return token.is("Else") || token.is("EndIf") || token.is("EndFor") || token.is("Return") ||
           before.is("Macro") || before.is("Function");
  }

 private:
  bool in_head_ = false;
  int depth_ = 0;
};

}  // namespace

std::string rewrite_geo(const std::vector<GeoToken>& tokens,
                        const std::function<std::string(const std::string&)>& name_of) {
  std::string text;
  std::size_t line = 1, begin = 0, file = 0;
  GeoToken before;
  Heads heads;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const GeoToken& t = tokens[i];
    for (; line < t.line; ++line) text += '\n', begin = text.size();
    if (text.size() - begin + t.text.size() > longest_line) text += '\n', begin = text.size();
    if (const std::size_t name = file_name_after(tokens, i)) file = name;
    if (t.is_text()) {
      const std::string inside(t.text);
      text += '"' + (i == file && i > 0 ? name_of(inside) : inside) + '"';
    } else {
      text += t.text;
    }
    text += ' ';
    if (heads.ends_with(t, before)) text += '\n', begin = text.size(), ++line;
    before = t;
  }
  return text + '\n';
}

}  // namespace couplet::mesh
