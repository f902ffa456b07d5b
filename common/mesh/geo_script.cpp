// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/geo_script.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"

namespace couplet {
namespace {

namespace fs = std::filesystem;

constexpr int deepest = 16;  // files that include files
constexpr std::uintmax_t largest = 64 << 20;

struct Token {
  enum class Kind { word, text, symbol, end } kind = Kind::end;
  std::string_view text;  // of a quoted text: without the quotes
  std::size_t at = 0;
};

/// gmsh's language as far as it matters here: words, quoted texts (either quotation mark, no escapes), comments.
class Lexer {
 public:
  explicit Lexer(std::string_view all) : all_(all) {}

  Token next() {
    skip();
    if (at_ >= all_.size()) return {};
    const std::size_t first = at_;
    const char c = all_[at_++];
    if (c == '"' || c == '\'') {
      const std::size_t end = std::min(all_.find(c, at_), all_.size());
      at_ = std::min(end + 1, all_.size());
      return {Token::Kind::text, all_.substr(first + 1, end - first - 1), first};
    }
    if (!is_letter(c)) return {Token::Kind::symbol, all_.substr(first, 1), first};
    while (at_ < all_.size() && is_letter(all_[at_])) ++at_;
    return {Token::Kind::word, all_.substr(first, at_ - first), first};
  }

 private:
  static bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
  void skip() {
    while (at_ < all_.size()) {
      const std::string_view rest = all_.substr(at_);
      if (std::isspace(static_cast<unsigned char>(rest[0]))) {
        ++at_;
      } else if (rest.starts_with("//")) {
        at_ = std::min(all_.find('\n', at_), all_.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = all_.find("*/", at_ + 2);
        at_ = end == std::string_view::npos ? all_.size() : end + 2;
      } else {
        return;
      }
    }
  }
  std::string_view all_;
  std::size_t at_ = 0;
};

std::string read_file(const fs::path& file) {
  std::error_code ignored;
  std::ifstream in;
  if (fs::is_regular_file(file, ignored)) in.open(file, std::ios::binary);
  if (!in.is_open())
    throw Error("The geometry file '{}' cannot be opened. Check the path and the permissions.",
                file.string());
  if (fs::file_size(file, ignored) > largest)
    throw Error("The geometry file '{}' is larger than {} MB.", file.string(), largest >> 20);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

class Scanner {
 public:
  Scanner(GeoScript& script, fs::path file, const std::string& text, int depth)
      : script_(script), file_(std::move(file)), text_(text), depth_(depth) {}

  void scan() {
    find_lost();
    // Whatever the lexer makes of comments and quotes: these words stand nowhere.
    std::string small(text_);
    std::transform(small.begin(), small.end(), small.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    for (const char* word : {"systemcall", "onelabrun"})
      if (const std::size_t at = small.find(word); at != std::string::npos)
        danger(at, fmt::format("'{}'", text_.substr(at, std::string_view(word).size())));
    std::vector<Token> tokens;
    Lexer lexer(text_);
    for (Token t = lexer.next(); t.kind != Token::Kind::end; t = lexer.next()) tokens.push_back(t);
    tokens.insert(tokens.end(), 4, Token{});
    for (std::size_t i = 0; i + 4 < tokens.size(); ++i)
      if (tokens[i].kind == Token::Kind::word) statement(tokens, i);
  }

 private:
  /// Of a last line without a newline gmsh reads one statement and leaves out the others.
  void find_lost() {
    const std::string_view last = text_.substr(text_.find_last_of('\n') + 1);
    const std::size_t first = last.find(';');
    if (!script_.lost.empty() || first == std::string_view::npos) return;
    if (Lexer(last.substr(first + 1)).next().kind == Token::Kind::end) return;
    script_.lost =
        fmt::format("line {} of '{}'", 1 + std::count(text_.begin(), text_.end(), '\n'), file_.string());
  }

  void statement(const std::vector<Token>& tokens, std::size_t i) {
    const std::string_view word = tokens[i].text;
    if (word == "Save" || word == "Print" || word == "CreateDir")
      danger(tokens[i].at, fmt::format("'{}'", word));
    if (word == "Printf" && has_redirection(tokens, i + 1)) danger(tokens[i].at, "'Printf' into a file");
    if (word == "DefineConstant" && tokens[i + 1].text == "[") constants(tokens, i + 2);
    if (word == "Layers" && tokens[i + 1].text == "{") count(tokens, i + 2, "}");
    if (word == "Transfinite" && (tokens[i + 1].text == "Curve" || tokens[i + 1].text == "Line")) {
      for (i += 2; tokens[i].kind != Token::Kind::end && tokens[i].text != "=" && tokens[i].text != ";";) ++i;
      if (tokens[i].text == "=") count(tokens, i + 1, ";");
    }
    if (word == "Physical") group(tokens, i + 1);
    if (word == "Include" || word == "Merge" || word == "ShapeFromFile") include(tokens[i], tokens, i + 1);
  }

  /// A number of cells from here to `end` or 'Using': a name, perhaps with numbers around it. Of several names one
  /// may well be 0.
  void count(const std::vector<Token>& tokens, std::size_t i, std::string_view end) {
    std::vector<std::string> names;
    bool whole = true;
    for (; tokens[i].kind != Token::Kind::end && tokens[i].text != end && tokens[i].text != "Using"; ++i) {
      if (tokens[i].kind == Token::Kind::word && !std::isdigit(static_cast<unsigned char>(tokens[i].text[0])))
        names.emplace_back(tokens[i].text);
      whole = whole && tokens[i].text != "*" && tokens[i].text != "/" && tokens[i].text != "(";
    }
    if (names.size() != 1) return;
    const auto [known, is_new] = script_.counts.emplace(names.front(), whole);
    if (!is_new) known->second = known->second && whole;
  }

  /// After the bracket that closes: Printf("...", x) >> "file".
  static bool has_redirection(const std::vector<Token>& tokens, std::size_t i) {
    int open = 0;
    for (; tokens[i].kind != Token::Kind::end; ++i) {
      if (tokens[i].kind != Token::Kind::symbol) continue;
      if (tokens[i].text == "(") ++open;
      if (tokens[i].text == ")" && --open <= 0) return tokens[i + 1].text == ">";
      if (tokens[i].text == ";" && open <= 0) return false;
    }
    return false;
  }

  void constants(const std::vector<Token>& tokens, std::size_t i) {
    int open = 0;
    for (bool expected = true; tokens[i].kind != Token::Kind::end; ++i) {
      const Token& t = tokens[i];
      if (t.kind == Token::Kind::word && open == 0 && expected) script_.constants.emplace_back(t.text);
      expected = t.kind == Token::Kind::symbol && t.text == "," && open == 0;
      if (t.kind != Token::Kind::symbol) continue;
      if (t.text == "]" && open == 0) return;
      open += t.text == "{" || t.text == "(" || t.text == "[";
      open -= t.text == "}" || t.text == ")" || t.text == "]";
    }
  }

  /// Physical Curve("name") or Physical Curve("name", 3); a number or a computed name is none that could be listed.
  void group(const std::vector<Token>& tokens, std::size_t i) {
    static constexpr std::array<std::pair<std::string_view, int>, 5> kinds{
        {{"Point", 0}, {"Line", 1}, {"Curve", 1}, {"Surface", 2}, {"Volume", 3}}};
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == tokens[i].text; });
    if (kind == kinds.end()) return;
    auto& names = script_.groups[std::size_t(kind->second)];
    const bool is_plain = tokens[i + 1].text == "(" && tokens[i + 2].kind == Token::Kind::text &&
                          (tokens[i + 3].text == ")" || tokens[i + 3].text == ",");
    if (!is_plain)
      names.reset();
    else if (names)
      names->emplace_back(tokens[i + 2].text);
  }

  void include(const Token& what, const std::vector<Token>& tokens, std::size_t i) {
    if (tokens[i].kind != Token::Kind::text || tokens[i + 1].text != ";") {
      danger(what.at, fmt::format("'{}' of a computed name", what.text));
      return;
    }
    const fs::path file = file_.parent_path() / std::string(tokens[i].text);
    const std::string kind = file.extension().string();
    if (kind == ".py" || kind == ".m" || kind == ".exe") {
      danger(what.at, fmt::format("'{}' of a program", what.text));
      return;
    }
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return;  // gmsh will say it
    if (depth_ >= deepest)
      throw Error("The geometry file '{}' is included {} levels deep.", file.string(), depth_ + 1);
    const std::string text = read_file(file);
    script_.text += text;
    if (script_.text.size() > largest)
      throw Error("The geometry of '{}' is larger than {} MB.", file.string(), largest >> 20);
    Scanner(script_, file, text, depth_ + 1).scan();
  }

  void danger(std::size_t at, const std::string& what) {
    if (!script_.danger.empty()) return;
    const auto line = 1 + std::count(text_.begin(), text_.begin() + std::ptrdiff_t(at), '\n');
    script_.danger = fmt::format("{} in line {} of {}", what, line, file_.string());
  }

  GeoScript& script_;
  fs::path file_;
  std::string_view text_;
  int depth_;
};

}  // namespace

GeoScript read_geo(const fs::path& file) {
  GeoScript script;
  script.groups.assign(4, std::vector<std::string>());
  const std::string text = read_file(file);
  script.text = text;
  Scanner(script, file, text, 0).scan();
  return script;
}

}  // namespace couplet
