// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/geo_check.hpp"

#include <cctype>

#include "common/base/error.hpp"
#include "common/mesh/gmsh/geo_words.hpp"

namespace couplet::mesh {
namespace {

using Tokens = std::vector<GeoToken>;
const GeoToken nothing{};

bool is_any(const GeoToken& token, std::initializer_list<std::string_view> of) {
  for (const std::string_view o : of)
    if (token.is(o)) return true;
  return false;
}

/// gmsh hands these texts to printf with numbers: %g and its kin alone, not wider than two digits.
bool is_harmless_format(std::string_view text) {
  for (std::size_t i = text.find('%'); i != std::string_view::npos; i = text.find('%', i + 1)) {
    const auto digits = [&] {
      std::size_t n = 0;
      while (i + 1 < text.size() && std::isdigit(static_cast<unsigned char>(text[i + 1])) != 0) ++i, ++n;
      return n;
    };
    if (i + 1 < text.size() && text[i + 1] == '%') {
      ++i;
      continue;
    }
    while (i + 1 < text.size() && std::string_view("+- ").find(text[i + 1]) != std::string_view::npos) ++i;
    if (digits() > 2) return false;
    if (i + 1 < text.size() && text[i + 1] == '.') {
      ++i;
      if (digits() > 2) return false;
    }
    if (i + 1 >= text.size() || std::string_view("gGeEf").find(text[i + 1]) == std::string_view::npos)
      return false;
  }
  return true;
}

bool is_harmless_formula(std::string_view text) {
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 &&
        std::string_view("_+-*/^()., <>=!&|?:").find(c) == std::string_view::npos)
      return false;
  return true;
}

class Check {
 public:
  explicit Check(const Tokens& tokens) : tokens_(tokens) {}

  GeoOffence run() {
    for (i_ = 0; i_ < tokens_.size() && found_.what.empty(); ++i_) {
      if (tokens_[i_].is_word())
        word();
      else if (tokens_[i_].is_text())
        text();
      else if (tokens_[i_].kind == GeoToken::Kind::symbol)
        symbol();
    }
    if (!open_.empty() && found_.what.empty())
      found_ = {fmt::format("an unclosed bracket '{}'", open_.back().symbol), open_.back().line};
    return found_;
  }

 private:
  struct Bracket {
    char symbol;
    std::string_view owner;  // the word before it
    bool texts;              // whether texts may stand in it
    bool constants;          // whether it is in DefineConstant
    bool begins;             // whether a name and this bracket begin a statement: list(3) = ...
    std::size_t line;
  };

  /// Neighbours: at(-1) is the piece before.
  const GeoToken& at(int ahead) const {
    const auto i = std::ptrdiff_t(i_) + ahead;
    return i >= 0 && i < std::ptrdiff_t(tokens_.size()) ? tokens_[std::size_t(i)] : nothing;
  }

  void offend(const std::string& what) {
    if (found_.what.empty()) found_ = {what, tokens_[i_].line};
  }
  void offend_by_word(const char* how) { offend(fmt::format("'{}'{}", tokens_[i_].text, how)); }

  bool in_constants() const { return !open_.empty() && open_.back().constants; }
  bool is_start() const {
    const GeoToken& p = at(-1);
    return p.kind == GeoToken::Kind::end || is_any(p, {";", "}", ")", "Else", "EndIf", "EndFor", "Return"}) ||
           is_any(at(-2), {"Macro", "Function"});
  }

  void word() {
    const std::string_view w = tokens_[i_].text;
    if (at(-1).is(".")) return;  // an option, see point()
    if (geo_words::is_refused(w)) return offend_by_word("");
    if (geo_words::is_control(w)) return control(w);
    if (w == "Field") return field();
    if (geo_words::gives_text(w) && !may_be_text()) return offend_by_word(" at this position");
    if (is_any(tokens_[i_], {"Printf", "Warning", "Error", "Sprintf"})) return printf();
    if (file_name_after(tokens_, i_) != 0) return;
    if (is_any(tokens_[i_], {"Include", "Merge", "ShapeFromFile"}))
      return offend_by_word(" with a computed name");
    for (const char* part : {"EndIf", "EndFor", "Else", "Return"})  // gmsh finds them inside a name, too
      if (w.find(part) != std::string_view::npos) return offend_by_word(" as a name");
    if (!geo_words::is_allowed(w)) name(w);
  }

  void control(std::string_view w) {
    if (!open_.empty() || !is_start()) return offend_by_word(" inside a statement");
    if (w == "If" || w == "ElseIf") {
      if (!at(1).is("(")) offend_by_word(" without a condition in brackets");
    } else if (w == "For") {
      if (!at(1).is("(") && !(is_own_name(at(1)) && at(2).is("In") && at(3).is("{")))
        offend_by_word(" of this form");
    } else if (w == "Call") {
      if (!is_own_name(at(1)) || !at(2).is(";")) offend_by_word(" with a computed name");
    } else if (w == "Macro" || w == "Function") {
      if (!is_own_name(at(1))) offend_by_word(" with a computed name");
    }
  }

  static bool is_own_name(const GeoToken& t) {
    return t.is_word() && !geo_words::is_allowed(t.text) && !geo_words::is_refused(t.text);
  }

  /// A word that is none of the grammar's: a name, or one of the words that have a meaning by their place.
  void name(std::string_view w) {
    const GeoToken& next = at(1);
    const bool attribute = in_constants() && geo_words::is_attribute(w);
    if (next.is_text()) {
      if (!attribute) offend_by_word(" and a text");
    } else if (next.kind == GeoToken::Kind::number) {
      if (!attribute && !geo_words::takes_a_number(w)) offend_by_word(" and a number");
    } else if (next.is_word()) {
      const bool pair = ((w == "Background" || w == "BoundaryLayer") && next.is("Field")) ||
                        geo_words::takes_a_number(w) || is_any(next, {"In", "Using"}) || attribute ||
                        is_any(at(-1), {"Macro", "Function"});
      if (!pair || (attribute && is_any(tokens_[i_], {"Name", "Label", "Help", "Kind"})))
        offend(fmt::format("'{} {}'", w, next.text));
    } else if (next.is("{")) {
      if (!attribute && !geo_words::takes_shapes(w)) offend_by_word(" and a brace");
    } else if (is_start() && !is_any(at(-1), {"Macro", "Function"}) && open_.empty() &&
               !geo_words::is_noun(w)) {
      if (!is_any(next, {"=", "+=", "-=", "*=", "/=", "++", "--", "(", "[", "~"}))
        offend_by_word(" as a statement");
    }
  }

  void field() {
    const bool whole = is_any(at(-1), {"Background", "BoundaryLayer"}) && at(1).is("=");
    if (!whole && !at(1).is("[")) offend_by_word(" of this form");
  }

  void printf() {
    const bool to_terminal = !tokens_[i_].is("Sprintf");
    if (!(at(1).is("(") || (!to_terminal && at(1).is("["))) || !at(2).is_text())
      return offend_by_word(" with a computed format");
    if (!is_harmless_format(at(2).text)) offend_by_word(" with a format other than %g, %e or %f");
  }

  /// Whether what stands here may be a text: it is assigned to a name, or stands in a bracket for texts.
  bool may_be_text() const {
    if (is_any(at(-1), {"=", "+="}) && open_.empty()) return !at(-3).is(".");
    return !open_.empty() && open_.back().texts && is_any(at(-1), {"(", "[", ",", "{", "=", "?", ":"});
  }

  void text() {
    const GeoToken& p = at(-1);
    const std::string_view t = tokens_[i_].text;
    if (in_constants() && t.starts_with("Gmsh/")) return offend(fmt::format("the name '{}'", t));
    if (may_be_text()) return;
    if (is_any(p, {"Include", "Merge"}) || (p.is("(") && at(-2).is("ShapeFromFile"))) return;
    if (t == "*" && is_any(p, {"Point", "Line", "Curve", "Surface", "Volume"})) return;
    if (in_constants() && p.is_word() && geo_words::is_attribute(p.text)) return;
    if (p.is("=") && at(-3).is(".") && at(-4).is("]") && geo_words::is_formula(at(-2).text) &&
        is_harmless_formula(t))
      return;
    offend(fmt::format("the text \"{}\" at this position", t));
  }

  void symbol() {
    const std::string_view s = tokens_[i_].text;
    if (s == "(" || s == "[" || s == "{") {
      open(s[0]);
    } else if (s == ")" || s == "]" || s == "}") {
      close(s[0]);
    } else if (s == ";") {
      if (!open_.empty() && open_.back().symbol != '{') offend("a statement that ends inside brackets");
    } else if (s == ".") {
      point();
    } else if (s == "::" || s == "&" || s == "|") {
      offend_by_word("");
    }
  }

  void open(char s) {
    const GeoToken& p = at(-1);
    Bracket b{s, p.is_word() ? p.text : std::string_view(), false, in_constants(), false, tokens_[i_].line};
    const bool inherits = !p.is_word() || geo_words::is_attribute(p.text);
    const bool physical = p.is_word() && at(-2).is("Physical") && s == '(';
    b.texts = physical || (p.is_word() && geo_words::takes_texts(p.text)) ||
              (inherits && !open_.empty() && open_.back().texts);
    b.constants = b.constants || p.is("DefineConstant");
    if (p.is_word() && s != '{' && !geo_words::is_allowed(p.text)) {
      --i_;
      b.begins = is_start() && open_.empty() && !geo_words::is_noun(p.text);
      ++i_;
    }
    open_.push_back(b);
  }

  void close(char s) {
    static constexpr std::string_view opening = "([{", closing = ")]}";
    if (open_.empty() || opening.find(open_.back().symbol) != closing.find(s))
      return offend(fmt::format("a bracket '{}' without an opening one", s));
    const Bracket b = open_.back();
    open_.pop_back();
    const GeoToken& next = at(1);
    if ((b.owner == "Printf" || b.owner == "Warning" || b.owner == "Error") && !next.is(";"))
      offend(fmt::format("'{}' into a file", b.owner));
    if (b.owner == "Field" && s == ']') end_of_field(next);
    if (b.begins && !is_any(next, {"=", "+=", "-=", "*=", "/=", "++", "--"}))
      offend(fmt::format("'{}' as a statement", b.owner));
  }

  void end_of_field(const GeoToken& next) {
    if (next.is(".") || next.is(";")) return;  // of Delete Field [1]; see point()
    if (!next.is("=")) return offend("'Field' of this form");
    if (!at(2).is_word() || !geo_words::is_field(at(2).text) || !at(3).is(";"))
      offend(fmt::format("a Field of type '{}'", at(2).text));
  }

  /// Mesh.MeshSizeMin, Field[1].VIn
  void point() {
    const GeoToken& next = at(1);
    if (at(-1).is_word()) {
      if (!next.is_word() || !geo_words::is_option(at(-1).text, next.text))
        offend(fmt::format("the option '{}.{}'", at(-1).text, next.text));
    } else if (!at(-1).is("]") || !is_of_field() || !next.is_word() || !at(2).is("=")) {
      offend("a point at this position");
    }
  }

  /// Whether the bracket that closes before this piece is that of Field [...].
  bool is_of_field() const {
    int depth = 0;
    for (std::size_t k = i_; k-- > 0;) {
      depth += tokens_[k].is("]");
      depth -= tokens_[k].is("[");
      if (tokens_[k].is(";")) return false;
      if (depth == 0) return k > 0 && tokens_[k - 1].is("Field");
    }
    return false;
  }

  const Tokens& tokens_;
  std::size_t i_ = 0;
  std::vector<Bracket> open_;
  GeoOffence found_;
};

}  // namespace

GeoOffence find_offence(const GeoTokens& script) {
  GeoOffence found = Check(script.tokens).run();
  if (!script.doubt.empty() && (found.what.empty() || found.line >= script.line))
    found = {script.doubt, script.line};
  return found;
}

std::size_t file_name_after(const Tokens& tokens, std::size_t i) {
  const auto at = [&](std::size_t k) -> const GeoToken& {
    return i + k < tokens.size() ? tokens[i + k] : nothing;
  };
  if (is_any(tokens[i], {"Include", "Merge"}) && at(1).is_text() && at(2).is(";")) return i + 1;
  if (tokens[i].is("ShapeFromFile") && at(1).is("(") && at(2).is_text() && at(3).is(")")) return i + 2;
  return 0;
}

}  // namespace couplet::mesh
