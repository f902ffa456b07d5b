// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/geo_script.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/mesh/gmsh/geo_check.hpp"
#include "common/mesh/gmsh/geo_rewrite.hpp"
#include "common/mesh/gmsh/geo_words.hpp"

namespace couplet::mesh {
namespace {

namespace fs = std::filesystem;
using Tokens = std::vector<GeoToken>;

constexpr int deepest = 16;  // files that include files
constexpr std::uintmax_t largest = 64 << 20;

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

/// The names and numbers of one file that must be known before gmsh gets it.
class Facts {
 public:
  Facts(GeoScript& script, Tokens tokens) : script_(script), tokens_(std::move(tokens)) {
    tokens_.insert(tokens_.end(), 4, GeoToken{});
    for (std::size_t i = 0; i + 4 < tokens_.size(); ++i)
      if (tokens_[i].is_word()) statement(i);
  }

 private:
  bool ends(std::size_t i) const { return tokens_[i].kind == GeoToken::Kind::end; }

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

  /// A number of cells from here to `end` or 'Using': a name, perhaps with numbers around it. Of several names one
  /// may well be 0.
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
      const GeoToken& t = tokens_[i];
      if (t.is_word() && open == 0 && expected) script_.constants.emplace_back(t.text);
      expected = t.is(",") && open == 0;
      if (t.is("]") && open == 0) return;
      open += t.is("{") || t.is("(") || t.is("[");
      open -= t.is("}") || t.is(")") || t.is("]");
    }
  }

  /// Physical Curve("name") or Physical Curve("name", 3); a number or a computed name is none that could be listed.
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

/// Looks into a .geo and whatever it includes.
class Scan {
 public:
  explicit Scan(GeoScript& script) : script_(script) {}

  /// The name under which gmsh gets this file.
  std::string geo(const fs::path& file, int depth) {
    const std::size_t i = add(file, ".geo");
    const std::string text = script_.files[i].text;
    if (depth == 0) folder_ = fs::weakly_canonical(fs::absolute(file).parent_path());
    find_lost(file, text);
    const GeoTokens cut = cut_geo(text);
    const GeoOffence offence = find_offence(cut);
    if (!offence.what.empty()) danger(offence, file);
    Facts(script_, cut.tokens);
    open_.push_back(file);
    const std::string rewritten = rewrite_geo(cut.tokens, [&](const std::string& name) {
      return included(file.parent_path(), name, {{}, line_of(cut.tokens, name)}, depth);
    });
    open_.pop_back();
    script_.files[i].text = rewritten;
    return script_.files[i].name;
  }

 private:
  static std::size_t line_of(const Tokens& tokens, const std::string& name) {
    for (const GeoToken& t : tokens)
      if (t.is_text() && t.text == name) return t.line;
    return 0;
  }

  std::size_t add(const fs::path& file, const std::string& kind) {
    std::string text = read_file(file);
    script_.text += text;
    if (script_.text.size() > largest)
      throw Error("The geometry of '{}' is larger than {} MB.", file.string(), largest >> 20);
    script_.files.push_back({file, fmt::format("{}{}", script_.files.size(), kind), std::move(text)});
    return script_.files.size() - 1;
  }

  std::string included(const fs::path& folder, const std::string& name, GeoOffence where, int depth) {
    const fs::path file = folder / name;
    const auto refuse = [&](const char* why) {
      where.what = fmt::format("the file '{}' ({})", name, why);
      danger(where, open_.back());
      return std::string("refused.geo");
    };
    if (fs::path(name).is_absolute()) return refuse("an absolute path");
    std::error_code ignored;
    const fs::path real = fs::weakly_canonical(file, ignored);
    const auto [end, rest] = std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end());
    if (end != folder_.end()) return refuse("outside the folder of the case");
    if (!fs::exists(file, ignored)) {  // gmsh will say it if it gets there
      const std::string missing = fmt::format("{}.missing.geo", script_.files.size());
      script_.files.push_back({file, missing, {}, false});
      return missing;
    }
    if (!fs::is_regular_file(real, ignored)) return refuse("not a file");
    if (const auto known = names_.find(real); known != names_.end() && !is_open(real)) return known->second;
    if (depth >= deepest || is_open(real))
      throw Error("The geometry file '{}' is included {} levels deep.", file.string(), depth + 1);
    const std::string kind = file.extension().string();
    std::string found;
    if (kind == ".geo") {
      found = geo(real, depth + 1);
    } else if (is_mesh_or_shape(real, kind)) {
      found = script_.files[add(real, kind)].name;
    } else {
      return refuse(
          "not a .geo, .step, .stp, .brep, .iges, .igs, .stl or .unv file, nor a .msh that begins with "
          "$MeshFormat");
    }
    return names_[real] = found;
  }

  bool is_open(const fs::path& real) const {
    return std::any_of(open_.begin(), open_.end(), [&](const fs::path& o) {
      std::error_code ignored;
      return fs::weakly_canonical(o, ignored) == real;
    });
  }

  /// gmsh reads these by the end of their name, and takes anything else for a script, .msh that is none, too.
  static bool is_mesh_or_shape(const fs::path& file, const std::string& kind) {
    for (const char* known : {".step", ".stp", ".brep", ".iges", ".igs", ".stl", ".unv"})
      if (kind == known) return true;
    std::ifstream in(file, std::ios::binary);
    std::string head(12, '\0');
    in.read(head.data(), 12);
    return kind == ".msh" && (head == "$MeshFormat\n" || head == "$MeshFormat\r");
  }

  /// Of a last line without a newline gmsh reads one statement and leaves out the others.
  void find_lost(const fs::path& file, std::string_view text) {
    const std::string_view last = text.substr(text.find_last_of('\n') + 1);
    const std::size_t first = last.find(';');
    if (!script_.lost.empty() || first == std::string_view::npos) return;
    const GeoTokens rest = cut_geo(last.substr(first + 1));
    if (rest.tokens.empty() && rest.doubt.empty()) return;
    script_.lost =
        fmt::format("line {} of '{}'", 1 + std::count(text.begin(), text.end(), '\n'), file.string());
  }

  void danger(const GeoOffence& offence, const fs::path& file) {
    if (script_.danger.empty())
      script_.danger = fmt::format("{} in line {} of {}", offence.what, offence.line, file.string());
  }

  GeoScript& script_;
  fs::path folder_;  // of the case
  std::map<fs::path, std::string> names_;
  std::vector<fs::path> open_;
};

}  // namespace

std::string GeoScript::refusal() const {
  return fmt::format(
      "The geometry has {}, which is not passed to gmsh, because a .geo can run commands and write files "
      "with your permissions. {}. If you trust the case, start with --allow-commands.",
      danger, geo_words::sentence);
}

GeoScript read_geo(const fs::path& file) {
  GeoScript script;
  script.groups.assign(4, std::vector<std::string>());
  Scan(script).geo(file, 0);
  return script;
}

}  // namespace couplet::mesh
