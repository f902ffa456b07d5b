// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/geo_lexer.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace couplet::mesh {
namespace {

constexpr std::size_t longest_text = 240;  // gmsh copies texts into buffers of 256 characters here and there

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Lexer {
 public:
  explicit Lexer(std::string_view all) : all_(all) {}

  GeoTokens run() {
    while (skip() && found_.doubt.empty()) token();
    return std::move(found_);
  }

 private:
  using Kind = GeoToken::Kind;

  char peek(std::size_t ahead = 0) const { return at_ + ahead < all_.size() ? all_[at_ + ahead] : '\0'; }

  void doubt(std::string what) {
    if (!found_.doubt.empty()) return;
    found_.doubt = std::move(what);
    found_.line = line_;
  }

  /// To the next token; whether there is one.
  bool skip() {
    while (at_ < all_.size() && found_.doubt.empty()) {
      const char c = peek();
      if (c == '\r' && peek(1) != '\n') {
        doubt("a carriage return in the middle of a line");
      } else if (c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f') {
        line_ += c == '\n';
        ++at_;
      } else if (c == '/' && peek(1) == '/') {
        comment(std::min(all_.find('\n', at_), all_.size()));
      } else if (c == '/' && peek(1) == '*') {
        const std::size_t end = all_.find("*/", at_ + 2);
        if (end == std::string_view::npos)
          doubt("an unterminated comment");
        else
          comment(end + 2);
      } else {
        return true;
      }
    }
    return false;
  }

  void comment(std::size_t end) {
    const std::string_view inside = all_.substr(at_, end - at_);
    if (inside.find('\0') != std::string_view::npos) doubt("a zero byte");
    for (std::size_t cr = inside.find('\r'); cr != std::string_view::npos; cr = inside.find('\r', cr + 1))
      if (cr + 1 < inside.size() ? inside[cr + 1] != '\n' : end < all_.size() && all_[end] != '\n')
        doubt("a carriage return in the middle of a line");
    line_ += std::size_t(std::count(inside.begin(), inside.end(), '\n'));
    at_ = end;
  }

  void token() {
    const char c = peek();
    if (c == '"' || c == '\'') return text(c);
    const std::size_t first = at_;
    Kind kind = Kind::symbol;
    if (is_letter(c)) {
      kind = Kind::word;
      while (is_letter(peek()) || is_digit(peek())) ++at_;
    } else if (is_digit(c) || (c == '.' && is_digit(peek(1)))) {
      kind = Kind::number;
      number();
    } else {
      symbol();
    }
    found_.tokens.push_back({kind, all_.substr(first, at_ - first), line_});
  }

  void number() {
    while (is_digit(peek())) ++at_;
    if (peek() == '.') ++at_;
    while (is_digit(peek())) ++at_;
    const std::size_t sign = peek(1) == '+' || peek(1) == '-' ? 1 : 0;
    if ((peek() != 'e' && peek() != 'E') || !is_digit(peek(1 + sign))) return;
    at_ += 1 + sign;
    while (is_digit(peek())) ++at_;
  }

  void symbol() {
    static constexpr std::array<std::string_view, 16> longer{"...", "+=", "-=", "*=", "/=", "::", "||", "&&",
                                                             "++",  "--", "==", "!=", "<=", ">=", ">>", "<<"};
    const std::string_view rest = all_.substr(at_);
    for (const std::string_view l : longer)
      if (rest.starts_with(l)) {
        at_ += l.size();
        return;
      }
    static constexpr std::string_view known = ";=+-*/^%<>!?:,()[]{}~#.&|";
    if (known.find(rest[0]) == std::string_view::npos)
      doubt(std::isprint(static_cast<unsigned char>(rest[0])) != 0
                ? "the character '" + std::string(1, rest[0]) + "'"
                : "a non-ASCII character");
    ++at_;
  }

  void text(char quote) {
    const std::size_t end = all_.find(quote, at_ + 1);
    if (end == std::string_view::npos) return doubt("a text with an unclosed quotation mark");
    const std::string_view inside = all_.substr(at_ + 1, end - at_ - 1);
    check(inside);
    found_.tokens.push_back({Kind::text, inside, line_});
    at_ = end + 1;
  }

  /// In a branch that is not taken gmsh looks for EndIf inside quotes, too, and takes a quoted // for a comment.
  void check(std::string_view inside) {
    if (inside.size() > longest_text) doubt("a text of more than 240 characters");
    for (const char c : inside)
      if (static_cast<unsigned char>(c) < ' ' || static_cast<unsigned char>(c) > 0xF4 || c == '"' ||
          c == '\'' || c == '\\' || c == '`' || c == '$')
        doubt(
            "a text with a line break, a quotation mark, a backslash, a dollar sign or a control character in it");
    for (const char* word : {"EndIf", "EndFor", "Else", "Return", "//", "/*", "*/"})
      if (inside.find(word) != std::string_view::npos) doubt(std::string("a text with '") + word + "' in it");
  }

  std::string_view all_;
  std::size_t at_ = 0, line_ = 1;
  GeoTokens found_;
};

}  // namespace

GeoTokens cut_geo(std::string_view text) { return Lexer(text).run(); }

}  // namespace couplet::mesh
