// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/gmsh.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include "common/base/error.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t deepest = 16;  // nested includes
constexpr std::uintmax_t largest = 64 << 20;

enum class Kind { word, text, symbol, end };
struct Token {
  Kind kind = Kind::end;
  std::string_view text;  ///< of a quoted text without the quotes
  std::size_t line = 0;   ///< counts from 1

  bool is(std::string_view symbol_or_word) const { return kind != Kind::text && text == symbol_or_word; }
  bool is_word() const { return kind == Kind::word; }
  bool is_text() const { return kind == Kind::text; }
};
using Tokens = std::vector<Token>;

bool is_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Splits a text into views of words, quoted texts and other characters, without blanks and comments.
Tokens tokens_of(std::string_view all) {
  Tokens tokens;
  std::size_t line = 1;
  for (std::size_t at = 0; at < all.size();) {
    const char c = all[at];
    const std::string_view rest = all.substr(at);
    std::size_t length = 1;
    if (rest.starts_with("//")) {
      length = std::min(rest.find('\n'), rest.size());
    } else if (rest.starts_with("/*")) {
      length = std::min(rest.find("*/", 2), rest.size() - 2) + 2;
    } else if (c == '"' || c == '\'') {
      length = std::min(rest.find(c, 1), rest.size() - 1) + 1;
      tokens.push_back({Kind::text, rest.substr(1, std::max<std::size_t>(length, 2) - 2), line});
    } else if (is_of_word(c)) {
      while (length < rest.size() && is_of_word(rest[length])) ++length;
      const bool is_number = std::isdigit(static_cast<unsigned char>(c)) != 0;
      tokens.push_back({is_number ? Kind::symbol : Kind::word, rest.substr(0, length), line});
    } else if (std::isspace(static_cast<unsigned char>(c)) == 0) {
      tokens.push_back({Kind::symbol, rest.substr(0, 1), line});
    }
    line += std::size_t(std::ranges::count(rest.substr(0, length), '\n'));
    at += length;
  }
  return tokens;
}

std::string read_file(const fs::path& file) {
  std::error_code ignored;
  std::ifstream in;
  if (fs::is_regular_file(file, ignored)) in.open(file, std::ios::binary);
  if (!in.is_open())
    throw Error("Cannot open the geometry file '{}'. Check the path and the permissions.", file.string());
  if (fs::file_size(file, ignored) > largest)
    throw Error("The geometry file '{}' is larger than {} MB.", file.string(), largest >> 20);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Names and numbers of one file that must be known before gmsh reads it.
class ScriptFacts {
 public:
  ScriptFacts(GeoScript& script, Tokens tokens) : script_(script), tokens_(std::move(tokens)) {
    tokens_.insert(tokens_.end(), 4, Token{});
    for (std::size_t i = 0; i + 4 < tokens_.size(); ++i)
      if (tokens_[i].is_word()) statement(i);
  }

 private:
  bool ends(std::size_t i) const { return tokens_[i].kind == Kind::end; }

  void statement(std::size_t i) {
    const std::string_view word = tokens_[i].text;
    if (word == "DefineConstant" && tokens_[i + 1].is("[")) constants(i + 2);
    if (word == "Layers" && tokens_[i + 1].is("{")) count(i + 2, "}");
    if (word == "Transfinite" && (tokens_[i + 1].is("Curve") || tokens_[i + 1].is("Line"))) {
      for (i += 2; !ends(i) && !tokens_[i].is("=") && !tokens_[i].is(";");) ++i;
      if (tokens_[i].is("=")) count(i + 1, ";");
    }
    if (word == "Physical") group(i + 1);
  }

  /// Parses a number of cells up to `end` or 'Using': a name, possibly with numbers. If there are several
  /// names, one of them may be 0.
  void count(std::size_t i, std::string_view end) {
    std::vector<std::string> names;
    bool whole = true;
    for (; !ends(i) && !tokens_[i].is(end) && !tokens_[i].is("Using"); ++i) {
      if (tokens_[i].is_word()) names.emplace_back(tokens_[i].text);
      whole = whole && !tokens_[i].is("*") && !tokens_[i].is("/") && !tokens_[i].is("(");
    }
    if (names.size() != 1) return;
    const auto [known, is_new] = script_.counts.emplace(names.front(), whole);
    if (!is_new) known->second = known->second && whole;
  }

  void constants(std::size_t i) {
    int open = 0;
    for (bool expected = true; !ends(i); ++i) {
      const Token& t = tokens_[i];
      if (t.is_word() && open == 0 && expected) script_.constants.emplace_back(t.text);
      expected = t.is(",") && open == 0;
      if (t.is("]") && open == 0) return;
      open += t.is("{") || t.is("(") || t.is("[");
      open -= t.is("}") || t.is(")") || t.is("]");
    }
  }

  /// Parses Physical Curve("name") or ("name", 3). A number or a computed name cannot be listed.
  void group(std::size_t i) {
    static constexpr std::array<std::pair<std::string_view, int>, 5> kinds{
        {{"Point", 0}, {"Line", 1}, {"Curve", 1}, {"Surface", 2}, {"Volume", 3}}};
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return tokens_[i].is(k.first); });
    if (kind == kinds.end() || tokens_[i + 1].is("{")) return;
    auto& names = script_.groups[std::size_t(kind->second)];
    const bool is_plain = tokens_[i + 1].is("(") && tokens_[i + 2].is_text() &&
                          (tokens_[i + 3].is(")") || tokens_[i + 3].is(","));
    if (!is_plain)
      names.reset();
    else if (names)
      names->emplace_back(tokens_[i + 2].text);
  }

  GeoScript& script_;
  Tokens tokens_;
};

/// Scans a .geo and all files it includes.
class Scan {
 public:
  explicit Scan(GeoScript& script) : script_(script) {}

  void geo(const fs::path& file) {
    const std::string text = add(file);
    find_lost(file, text);
    const Tokens tokens = tokens_of(text);
    ScriptFacts(script_, tokens);
    open_.push_back(fs::weakly_canonical(file));
    for (const Token& token : tokens) refuse_endless(token, file);
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
      if (!tokens[i].is("Include") && !tokens[i].is("Merge") && !tokens[i].is("ShapeFromFile")) continue;
      const Token& name = tokens[i + (tokens[i + 1].is("(") ? 2 : 1)];
      if (name.is_text())
        include(file.parent_path() / name.text);
      else if (script_.computed.empty())
        script_.computed = fmt::format("line {} of '{}'", tokens[i].line, file.string());
    }
    open_.pop_back();
  }

 private:
  /// Refuses what would let gmsh wait for ever: pauses, and names of devices and pipes.
  static void refuse_endless(const Token& token, const fs::path& file) {
    std::error_code ignored;
    const fs::path named = file.parent_path() / token.text;
    if (token.is("Sleep"))
      throw Error("The line {} of '{}' makes gmsh wait (Sleep). Remove it.", token.line, file.string());
    if (token.is_text() && fs::is_other(named, ignored))
      throw Error("The line {} of '{}' names '{}', which is a device or a pipe and may have no end.",
                  token.line, file.string(), named.string());
  }

  std::string add(const fs::path& file) {
    std::string text = read_file(file);
    script_.text += text;
    if (script_.text.size() > largest)
      throw Error("The geometry of '{}' is larger than {} MB.", file.string(), largest >> 20);
    return text;
  }

  /// Scans an included file once. gmsh reports a missing file if it gets there.
  void include(const fs::path& file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return;
    const fs::path real = fs::weakly_canonical(file, ignored);
    if (open_.size() >= deepest || std::ranges::find(open_, real) != open_.end())
      throw Error("The geometry file '{}' is included {} levels deep.", file.string(), open_.size());
    if (!known_.insert(real).second) return;
    if (file.extension() == ".geo")
      geo(real);
    else
      add(real);
  }

  /// Finds a last line without newline, of which gmsh reads only one statement.
  void find_lost(const fs::path& file, std::string_view text) {
    const std::string_view last = text.substr(text.find_last_of('\n') + 1);
    const std::size_t first = last.find(';');
    if (!script_.lost.empty() || first == std::string_view::npos) return;
    if (tokens_of(last.substr(first + 1)).empty()) return;
    script_.lost =
        fmt::format("line {} of '{}'", 1 + std::count(text.begin(), text.end(), '\n'), file.string());
  }

  GeoScript& script_;
  std::set<fs::path> known_;
  std::vector<fs::path> open_;
};

}  // namespace

GeoScript read_geo(const fs::path& file) {
  GeoScript script;
  script.groups.assign(4, std::vector<std::string>());
  Scan(script).geo(file);
  return script;
}

}  // namespace couplet::mesh
