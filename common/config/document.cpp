// SPDX-License-Identifier: Apache-2.0
#include "common/config/document.hpp"

#include <fmt/format.h>

#include <yaml-cpp/eventhandler.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"

namespace couplet::config {

namespace {

/// Finds the first control character of a text in UTF-8, which would corrupt messages, file names and terminals.
/// Values may have line breaks and tabs, unlike names.
std::size_t find_control(std::string_view text, bool is_name) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if ((c < 32 && (is_name || (c != '\n' && c != '\t'))) || c == 127) return i;
    if (c == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0) return i + 1;
  }
  return text.npos;
}

/// Throws Error for a byte that is not part of UTF-8, as in a file in Latin-1.
void require_utf8(std::string_view text, const std::string& name) {
  for (std::size_t i = 0, line = 1, begin = 0; i < text.size();) {
    const auto byte = [&](std::size_t at) {
      return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
    };
    const unsigned c = byte(i);
    const std::size_t n = c < 0x80 ? 1 : c < 0xC2 ? 0 : c < 0xE0 ? 2 : c < 0xF0 ? 3 : c < 0xF5 ? 4 : 0;
    bool good = n > 0;
    for (std::size_t k = 1; k < n; ++k) good = good && (byte(i + k) & 0xC0u) == 0x80;
    if (!good)
      throw Error("{}:{}:{}: the byte 0x{:02x} is not text in UTF-8; save the file in this encoding.", name,
                  line, i - begin + 1, c);
    i += n;
    if (c == '\n') ++line, begin = i;
  }
}

/// Finds content that yaml-cpp accepts but that later code cannot handle.
class Inspection {
 public:
  std::vector<Message> messages;

  void inspect(const YAML::Node& node, const std::string& path, int depth = 0) {
    if (messages.size() >= most_messages) return;
    // Nested anchors double the size with every line.
    if (++nodes_ > most_nodes)
      throw Error("{}: more than {} values up to here. Do anchors contain each other?", path.substr(0, 60),
                  most_nodes);
    if (depth > deepest)
      throw Error("{}: nested deeper than {} levels. Does an anchor contain itself?", path.substr(0, 60),
                  deepest);
    if (node.IsScalar()) check_text(node, path, false);
    if (node.IsSequence()) {
      std::size_t i = 0;
      for (const YAML::Node& entry : node) inspect(entry, fmt::format("{}[{}]", path, i++), depth + 1);
    }
    if (node.IsMap()) inspect_map(node, path, depth);
  }

 private:
  static constexpr int deepest = 50;
  static constexpr std::size_t most_messages = 50, most_nodes = 1'000'000, longest_name = 200;

  bool check_text(const YAML::Node& node, const std::string& path, bool is_name) {
    const std::string& text = node.Scalar();
    const std::size_t found = find_control(text, is_name);
    if (found == text.npos) return true;
    messages.push_back(
        {place_of(node), path,
         fmt::format("this {} contains a control character (code {}); remove it.", is_name ? "key" : "value",
                     int(static_cast<unsigned char>(text[found])))});
    return false;
  }

  void inspect_map(const YAML::Node& node, const std::string& path, int depth) {
    std::map<std::string, Origin> seen;
    for (const auto& item : node) {
      if (!item.first.IsScalar()) {
        messages.push_back({place_of(item.first), path, "a key must be a single word."});
        continue;
      }
      const std::string& name = item.first.Scalar();
      const Origin place = place_of(item.first);
      if (!check_text(item.first, path, true)) continue;
      if (name.size() > longest_name) {
        messages.push_back(
            {place, path,
             fmt::format("a key has {} characters; at most {} are allowed.", name.size(), longest_name)});
        continue;
      }
      const std::string here = join_path(path, name);
      const auto [first, is_new] = seen.emplace(name, place);
      if (!is_new)
        messages.push_back({place, here,
                            fmt::format("this key appears twice (first at {}:{}); remove one of the two.",
                                        first->second.line, first->second.column)});
      inspect(item.second, here, depth + 1);
    }
  }

  std::size_t nodes_ = 0;
};

/// Translates yaml-cpp's messages about common mistakes into advice.
std::string explain(const std::string& message, std::string_view line) {
  static const std::pair<const char*, const char*> known[] = {
      {"illegal map value",
       "a ':' is not allowed here; check the indentation above, and quote text that contains ': '"},
      {"end of sequence flow not found", "a list opened with '[' before this position is not closed by ']'"},
      {"end of map flow not found", "a mapping opened with '{' before this position is not closed by '}'"},
      {"illegal flow end", "this bracket closes nothing; check '[', ']', '{' and '}'"},
      {"end of map not found",
       "this line does not match the mapping above; check its indentation and its "
       "':'"},
      {"end of sequence not found",
       "this line does not match the list above; check its indentation and its '- '"},
      {"the referenced anchor is not defined",
       "this '*name' refers to an anchor '&name' that does not exist"},
  };
  if (line.substr(0, line.find_first_not_of(" \t")).find('\t') != std::string_view::npos)
    return "tabs cannot be used for indentation; use spaces";
  for (const auto& [theirs, ours] : known)
    if (message.starts_with(theirs)) return ours;  // yaml-cpp 0.8 appends the name of an anchor
  return message;
}

/// Finds the start of the second document of a stream.
class SecondDocument final : public YAML::EventHandler {
 public:
  static std::optional<YAML::Mark> find(const std::string& text) {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    SecondDocument handler;
    // YAML::LoadAll does not terminate on some invalid files.
    if (!parser.HandleNextDocument(handler) || !parser.HandleNextDocument(handler)) return std::nullopt;
    return handler.start_;
  }

 private:
  void OnDocumentStart(const YAML::Mark& mark) override { start_ = mark; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}

  YAML::Mark start_;
};

YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  try {
    const YAML::Node root = YAML::Load(text);
    // yaml-cpp silently starts a second document at a line that is indented less than the first key.
    if (const auto second = SecondDocument::find(text))
      throw Error(
          "{}:{}:{}: this line does not belong to the mapping above; check its indentation (and remove "
          "'---').",
          name, second->line + 1, second->column + 1);
    return root;
  } catch (const YAML::Exception& error) {
    const std::vector<std::string> lines = base::split(text, '\n');
    const auto line = static_cast<std::size_t>(std::max(error.mark.line, 0));
    throw Error("{}:{}:{}: this is not valid YAML: {}.", name, line + 1, error.mark.column + 1,
                explain(error.msg, line < lines.size() ? lines[line] : ""));
  }
}

std::string describe(const std::string& path) {
  return path.empty() ? "the file" : fmt::format("'{}'", path);
}

/// Entry `part` of the node at `path`. Throws Error if part of a --set path does not exist.
YAML::Node step_into(const YAML::Node& node, const std::string& path, const std::string& part,
                     const std::string& option) {
  if (node.IsSequence()) {
    const bool is_number = !part.empty() && part.find_first_not_of("0123456789") == std::string::npos;
    if (!is_number || part.size() > 6 || std::stoul(part) >= node.size())
      throw Error(
          "{}: {} is a list of {} entries; expected an entry number, counted from 0, instead of "
          "'{}'.",
          option, describe(path), node.size(), part);
    return node[std::stoul(part)];
  }
  if (!node.IsMap())
    throw Error("{}: {} is a single value, so '{}' cannot be set below it.", option, describe(path), part);
  const MapEntry entry = find(node, part);
  if (!entry.found)
    throw Error(
        "{}: '{}' does not exist {}. {} (A missing mapping can be set as a whole: --set '{}={{key: "
        "value}}'.)",
        option, part, path.empty() ? std::string("at the top level") : fmt::format("in '{}'", path),
        base::did_you_mean(part, key_names(node), "keys"), join_path(path, part));
  return entry.node;
}

}  // namespace

Document::Document() : content_(std::make_unique<Content>()) {}
Document::~Document() = default;
Document::Document(Document&&) noexcept = default;

Document Document::read(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw Error("{}: this file does not exist. Give the path of the case's YAML file.", file.string());
  if (std::filesystem::is_directory(file, error))
    throw Error("{}: this is a folder; give the YAML file in it, for example {}.", file.string(),
                (file / "case.yaml").string());
  if (!std::filesystem::is_regular_file(file, error))
    throw Error("{}: this is not a regular file or a link to one (a pipe?); save the case in a file.",
                file.string());
  constexpr std::uintmax_t largest = 64 << 20;
  if (const auto size = std::filesystem::file_size(file, error); size > largest)
    throw Error("{}: this file has {} MB; a case may have at most {}.", file.string(), size >> 20,
                largest >> 20);
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw Error("{}: this file cannot be read.", file.string());
  return parse(text.str(), file.string());
}

Document Document::parse(const std::string& text, const std::string& name) {
  Document document;
  Content& content = *document.content_;
  content.name = name;
  content.text = text;
  require_utf8(text, name);
  content.root = parse_yaml(text, name);
  Inspection inspection;
  try {
    inspection.inspect(content.root, "");
  } catch (const Error& error) {
    throw Error("{}:1:1: {}", name, error.what());
  }
  if (!inspection.messages.empty()) throw Error(base::join(format_all(name, inspection.messages), "\n"));
  return document;
}

void Document::set(const std::string& assignment) {
  std::string option = "--set " + assignment;
  for (std::size_t at; (at = find_control(option, true)) != option.npos;) {
    if (option[at] < 0) option[at - 1] = '?';
    option[at] = '?';  // messages must not control a terminal
  }
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error("{}: expected key=value, for example --set simulation.end-time='2 s'.", option);
  require_utf8(assignment, "--set");
  const std::string path(base::trim(assignment.substr(0, equals)));
  if (find_control(path, true) != path.npos)
    throw Error("{}: the key contains a control character; remove it.", option);
  const std::vector<std::string> parts = base::split(path, '.');
  YAML::Node value;
  try {
    // An argument has no comments: ' #' is part of a name.
    const std::string text(base::trim(assignment.substr(equals + 1)));
    const bool is_plain = text.find_first_of("\"'[{") == text.npos;
    value = is_plain && text.find(" #") != text.npos ? YAML::Node(text) : YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error("{}: the value is not valid YAML: {}.", option, explain(error.msg, ""));
  }
  Inspection inspection;
  inspection.inspect(value, path);
  if (!inspection.messages.empty())
    throw Error("{}: {}: {}", option, inspection.messages[0].path, inspection.messages[0].text);
  if (std::find(parts.begin(), parts.end(), "") != parts.end())
    throw Error("{}: the path '{}' has an empty part.", option, path);
  std::string walked;
  YAML::Node node = content_->root;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool last = i + 1 == parts.size();
    if (last && node.IsMap()) {
      // operator[] does not find a key that YAML reads as a number or boolean.
      if (value.IsNull()) {
        if (!find(node, parts[i]).found)
          throw Error("{}: there is no '{}' to remove. {}", option, join_path(walked, parts[i]),
                      base::did_you_mean(parts[i], key_names(node), "keys"));
        node.remove(parts[i]);
      } else if (const MapEntry entry = find(node, parts[i]); entry.found) {
        YAML::Node target = entry.node;
        target = value;
      } else {
        node.force_insert(parts[i], value);
      }
    } else {
      // Creates a missing section; its declaration defines the valid keys. Participants and top-level
      // sections are not created, because a misspelled name would be a new one.
      if (node.IsMap() && !walked.empty() && walked != "participants" && !value.IsNull() &&
          !find(node, parts[i]).found)
        node.force_insert(parts[i], YAML::Node(YAML::NodeType::Map));
      YAML::Node next = step_into(node, walked, parts[i], option);
      if (last) next = value;
      node.reset(next);
    }
    walked = join_path(walked, parts[i]);
  }
  content_->overrides.emplace_back(path, option);
}

const std::string& Document::name() const { return content_->name; }

std::size_t Document::hash() const {
  std::string all = content_->text;
  for (const auto& [path, option] : content_->overrides) all += '\0' + option;
  return base::stable_hash(all);
}

namespace {

void collect(const YAML::Node& node, const std::string& path, std::map<std::string, std::string>& found) {
  if (node.IsMap() && node.size() > 0) {
    for (const auto& item : node) collect(item.second, join_path(path, item.first.Scalar()), found);
  } else if (node.IsSequence() && node.size() > 0) {
    for (std::size_t i = 0; i < node.size(); ++i) collect(node[i], fmt::format("{}[{}]", path, i), found);
  } else {
    found[path] = node.IsMap() ? "{}" : node.IsSequence() ? "[]" : node.IsNull() ? "" : node.Scalar();
  }
}

struct Si {
  double value;
  std::optional<base::Unit::Dimension> dimension;  // of a number with a unit
};

std::optional<Si> in_si(const std::string& text) {
  const auto quantity = base::split_quantity(text);
  if (!quantity) return {};
  if (quantity->unit.empty()) return Si{quantity->number, {}};
  try {
    const base::Unit unit = base::parse_unit(quantity->unit);
    return Si{unit.factor * quantity->number + unit.offset, unit.dimension};
  } catch (const Error&) {
    return {};
  }
}

}  // namespace

std::map<std::string, std::string> leaves(const Document& document) {
  std::map<std::string, std::string> found;
  collect(document.content().root, "", found);
  return found;
}

bool same_value(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto x = in_si(a), y = in_si(b);
  if (!x || !y) return false;
  if (x->dimension && y->dimension && *x->dimension != *y->dimension) return false;
  return std::abs(x->value - y->value) <= 1e-14 * std::max(std::abs(x->value), std::abs(y->value));
}

Origin place_of(const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  if (mark.is_null()) return {};
  return {mark.line + 1, mark.column + 1, ""};
}

std::string join_path(const std::string& parent, std::string_view name) {
  return parent.empty() ? std::string(name) : fmt::format("{}.{}", parent, name);
}

bool is_below(std::string_view path, std::string_view above) {
  if (!path.starts_with(above)) return false;
  return path.size() == above.size() || path[above.size()] == '.' || path[above.size()] == '[';
}

std::vector<std::string> key_names(const YAML::Node& map) {
  std::vector<std::string> names;
  if (map.IsMap())
    for (const auto& item : map) names.push_back(item.first.Scalar());
  return names;
}

MapEntry find(const YAML::Node& map, std::string_view name) {
  if (map.IsMap())
    for (const auto& item : map)
      if (item.first.Scalar() == name) return {true, place_of(item.first), item.second};
  return {};
}

std::string format(const std::string& file, const Message& message) {
  const Origin& place = message.place;
  std::string where = file;
  if (!place.override_text.empty())
    where = place.override_text;
  else if (place.line > 0)
    where = fmt::format("{}:{}:{}", file, place.line, place.column);
  return message.path.empty() ? fmt::format("{}: {}", where, message.text)
                              : fmt::format("{}: {}: {}", where, message.path, message.text);
}

std::vector<std::string> format_all(const std::string& file, std::vector<Message> messages) {
  const auto order = [](const Message& m) {
    return std::make_tuple(!m.place.override_text.empty(), m.place.line, m.place.column);
  };
  std::stable_sort(messages.begin(), messages.end(),
                   [&](const Message& a, const Message& b) { return order(a) < order(b); });
  std::vector<std::string> lines;
  std::set<std::string> seen;
  for (const Message& message : messages) {
    std::string line = format(file, message);
    if (seen.insert(line).second) lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace couplet::config
