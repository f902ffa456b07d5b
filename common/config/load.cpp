// SPDX-License-Identifier: Apache-2.0
#include "common/config/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/config/document.hpp"
#include "common/config/missing_physics.hpp"
#include "common/config/values.hpp"

namespace couplet::config {
namespace {

/// Fills the members from a mapping and collects all errors.
class Loader final {
 public:
  explicit Loader(const Document::Content& content, CheckExpression check_expression = {})
      : content_(content), check_expression_(std::move(check_expression)) {}

  /// Reads a mapping. If `node` is undefined, defaults apply, and required keys are missing at `place`.
  void read_mapping(const YAML::Node& node, const Origin& place, const std::string& path,
                    const Section::Declare& declare);
  const std::vector<Message>& messages() const { return messages_; }
  /// Possible but implausible values.
  const std::vector<Message>& doubts() const { return doubts_; }

 private:
  /// Mapping that is being read.
  struct Frame {
    YAML::Node node;
    Origin place;
    std::string path;
    std::vector<std::string> known;
    std::vector<std::pair<std::string, std::string>> elsewhere;  ///< key and the variant case it belongs to
    std::size_t messages_before = 0;
    std::optional<int> dimension;  ///< value of the key `dimension`
    bool wrong_key = false;        ///< a key of this mapping could not be read
    /// Message about a mapping in place of a number, unless an optional section of that name is declared next.
    std::optional<Message> mapping{};
  };
  /// Processes one declaration, as visitor of the sections.
  void on(const Declaration& declaration);
  void key(const KeyFacts& facts, const Slot& slot);
  /// Reports the mapping of a number that may not be one.
  void report_mapping();
  /// Reads the contents of a section, optional, map or list.
  void below(const Declaration& declaration);
  void variant(const Declaration& declaration);
  MapEntry take(std::string_view name);
  Message message(const Origin& place, const std::string& path, const std::string& text) const;
  void report(const Origin& place, const std::string& path, const std::string& text);
  void report_key(const Origin& place, const std::string& path, const std::string& text);
  void report_unknown_keys();
  /// Sentence about missing physics that a key, or else a word of its value, asks for. Empty if there is none.
  std::string limit_named_by(const std::string& key, const YAML::Node& value) const;
  /// Text of a wrong value: `problem`, or the missing physics that it asks for.
  std::string wrong_value(const YAML::Node& value, const char* problem) const;
  /// Text " Its keys: a, b." for a value that should be a mapping.
  std::string keys_of(const Origin& place, const std::string& path, const Section::Declare& declare);
  /// Applies a rule across keys, unless a key that it may depend on is invalid.
  void apply_rule(const Declaration& declaration);
  /// Removes the message about a missing key, because a misspelled required key is one mistake.
  void forget_missing(const std::string& path);

  /// Problem of the expressions of a key. A list of them is a vector with the `dimension` of a surrounding
  /// mapping.
  std::string problem_of(const KeyFacts& facts, const Slot& slot) const;

  const Document::Content& content_;
  CheckExpression check_expression_;
  const Visitor visitor_ = [this](const Declaration& declaration) { on(declaration); };
  std::vector<Frame> frames_;
  std::vector<Message> messages_, doubts_;
};

constexpr const char* missing_key = "this required key is missing";

std::string one_of(const std::vector<std::string>& words) {
  return fmt::format("one of: {}", base::join(words));
}

/// Names of the keys that a declaration adds at its own level, without changing members.
std::vector<std::string> names_of(const Section::Declare& declare) {
  std::vector<std::string> names;
  const Visitor collect = [&](const Declaration& d) {
    if (d.rule) return;
    names.push_back(d.facts.name);
    Section section(collect);
    for (const auto& [word, keys] : d.cases) keys(section);
  };
  Section section(collect);
  declare(section);
  return names;
}

std::string kind_of(const YAML::Node& node) {
  if (node.IsSequence()) return "a list";
  if (!node.IsScalar()) return "nothing";
  // Shortens the text, which may be a whole file.
  constexpr std::size_t longest = 60;
  const std::string& text = node.Scalar();
  if (text.size() <= longest) return "'" + text + "'";
  return fmt::format("'{}' and {} characters more", text.substr(0, longest), text.size() - longest);
}

Message Loader::message(const Origin& place, const std::string& path, const std::string& text) const {
  Origin where = place;
  for (const auto& [changed, option] : content_.overrides)
    if (is_below(path, changed)) where.override_text = option;
  return {where, path, text};
}

void Loader::report(const Origin& place, const std::string& path, const std::string& text) {
  messages_.push_back(message(place, path, text));
}

void Loader::report_key(const Origin& place, const std::string& path, const std::string& text) {
  frames_.back().wrong_key = true;
  report(place, path, text);
}

void Loader::forget_missing(const std::string& path) {
  std::erase_if(messages_,
                [&](const Message& m) { return m.path == path && m.text.starts_with(missing_key); });
}

MapEntry Loader::take(std::string_view name) {
  Frame& frame = frames_.back();
  frame.known.emplace_back(name);
  return find(frame.node, name);
}

std::string Loader::keys_of(const Origin& place, const std::string& path, const Section::Declare& declare) {
  constexpr std::size_t most = 12;
  const std::vector<Message> kept = messages_, kept_doubts = doubts_;
  frames_.push_back({YAML::Node(YAML::NodeType::Map), place, path, {}, {}, messages_.size(), {}, false});
  Section section(visitor_);
  declare(section);
  std::vector<std::string> keys = frames_.back().known;
  frames_.pop_back();
  messages_ = kept;
  doubts_ = kept_doubts;
  if (keys.empty()) return "";
  const bool all = keys.size() <= most;
  keys.resize(std::min(keys.size(), most));
  return fmt::format(" Its keys: {}{}.", base::join(keys), all ? "" : ", ...");
}

void Loader::read_mapping(const YAML::Node& node, const Origin& place, const std::string& path,
                          const Section::Declare& declare) {
  const bool is_empty = !node.IsDefined() || node.IsNull();
  if (!is_empty && !node.IsMap()) {
    report(place, path,
           fmt::format("expected a mapping (keys with values), found {}.{}", kind_of(node),
                       keys_of(place, path, declare)));
    return;
  }
  frames_.push_back(
      {is_empty ? YAML::Node(YAML::NodeType::Map) : node, place, path, {}, {}, messages_.size(), {}, false});
  Section section(visitor_);
  declare(section);
  report_mapping();
  report_unknown_keys();
  frames_.pop_back();
}

void Loader::report_unknown_keys() {
  const Frame frame = frames_.back();
  constexpr int most = 20;  // per mapping, because suggestions for more are slow and unread
  int unknown = 0;
  for (const auto& item : frame.node) {
    const std::string& name = item.first.Scalar();
    if (std::find(frame.known.begin(), frame.known.end(), name) != frame.known.end()) continue;
    if (++unknown > most) continue;
    const std::string path = join_path(frame.path, name);
    std::vector<std::string> owners;
    for (const auto& [key, owner] : frame.elsewhere)
      if (key == name) owners.push_back(owner);
    if (!owners.empty()) {
      report(place_of(item.first), path,
             fmt::format("this key is not valid here; it requires {}.", base::join(owners, " or ")));
      continue;
    }
    std::vector<std::string> free;
    for (const std::string& known : frame.known)
      if (!find(frame.node, known).found) free.push_back(known);
    if (const std::string limit = limit_named_by(name, item.second); !limit.empty()) {
      report(place_of(item.first), path, "unknown key. " + limit);
      continue;
    }
    const auto meant = base::closest(name, free);
    if (meant) forget_missing(join_path(frame.path, *meant));
    // An existing key cannot be meant, but the message shows which keys are allowed.
    report(place_of(item.first), path, unknown_key(name, meant ? free : frame.known));
  }
  if (unknown > most)
    report(frame.place, frame.path, fmt::format("{} more unknown keys follow.", unknown - most));
}

std::string Loader::limit_named_by(const std::string& key, const YAML::Node& value) const {
  const MapEntry program = find(frames_.front().node, "program");
  const std::string name = program.found && program.node.IsScalar() ? program.node.Scalar() : "";
  if (const std::string limit = config::limit_named_by(key, name); !limit.empty() || !value.IsDefined())
    return limit;
  if (value.IsScalar()) return config::limit_named_by(value.Scalar(), name);
  for (const auto& item : value) {
    const bool is_map = value.IsMap();
    const std::string limit =
        limit_named_by(is_map ? item.first.Scalar() : "", is_map ? item.second : YAML::Node(item));
    if (!limit.empty()) return limit;
  }
  return "";
}

std::string Loader::wrong_value(const YAML::Node& value, const char* problem) const {
  const std::string limit = limit_named_by("", value);
  return limit.empty()
             ? problem
             : fmt::format("{} is not available. {}", value.IsMap() ? "a mapping" : kind_of(value), limit);
}

std::string Loader::problem_of(const KeyFacts& facts, const Slot& slot) const {
  if (!check_expression_) return "";
  if (const auto* text = std::get_if<ExpressionText*>(&slot)) return check_expression_(**text);
  if (const auto* text = std::get_if<std::optional<ExpressionText>*>(&slot))
    return **text ? check_expression_(***text) : "";
  const auto* texts = std::get_if<std::vector<ExpressionText>*>(&slot);
  if (texts == nullptr) return "";
  const auto around =
      std::find_if(frames_.rbegin(), frames_.rend(), [](const Frame& f) { return bool(f.dimension); });
  if (around != frames_.rend() && !facts.size && std::ssize(**texts) != *around->dimension)
    return fmt::format("{} components are given, but the {}-dimensional case needs {}.", (**texts).size(),
                       *around->dimension, *around->dimension);
  for (std::size_t i = 0; i < (**texts).size(); ++i)
    if (const std::string problem = check_expression_((**texts)[i]); !problem.empty())
      return fmt::format("entry {} of the list: {}", i + 1, problem);
  return "";
}

void Loader::key(const KeyFacts& facts, const Slot& slot) {
  Frame& frame = frames_.back();
  const std::string path = join_path(frame.path, facts.name);
  const MapEntry entry = take(facts.name);
  if (!entry.found) {
    if (!facts.required) return;
    const Word* word = std::get_if<Word>(&slot);
    const std::string expected =
        word != nullptr ? one_of(word->words)
                        : fmt::format("{}{}{}", facts.doc.empty() ? "" : facts.doc + ": ",
                                      describe_type(slot), facts.unit.empty() ? "" : " in " + facts.unit);
    report_key(frame.place, path, fmt::format("{} ({}).", missing_key, expected));
    return;
  }
  try {
    read_value(entry.node, facts, slot, std::filesystem::absolute(content_.name).parent_path());
    if (const auto* number = std::get_if<int*>(&slot); number && facts.name == "dimension")
      frame.dimension = **number;
    if (const std::string problem = problem_of(facts, slot); !problem.empty()) throw Error("{}", problem);
    if (const std::string doubt = check_magnitude(facts, slot); !doubt.empty())
      doubts_.push_back(message(entry.place, path, doubt));
  } catch (const Error& error) {
    if (std::holds_alternative<double*>(slot) && entry.node.IsMap())
      frame.mapping = message(entry.place, path, wrong_value(entry.node, error.what()));
    else
      report_key(entry.place, path, wrong_value(entry.node, error.what()));
  }
}

void Loader::below(const Declaration& d) {
  using Kind = Declaration::Kind;
  const Origin outside = frames_.back().place;
  const std::string path = join_path(frames_.back().path, d.facts.name);
  const MapEntry entry = take(d.facts.name);
  if (std::ranges::count(frames_.back().known, d.facts.name) > 1) {
    frames_.back().mapping.reset();
    if (!entry.node.IsMap()) return;  // a number, which has been read
  }
  const auto read = [&](const YAML::Node& node, const Origin& place, const std::string& at,
                        const std::string& name, std::size_t i) {
    read_mapping(node, place, at, [&](Section& s) { d.declare(s, name, i); });
  };
  if (d.kind == Kind::section || (d.kind == Kind::optional && entry.found))
    return read(entry.node, entry.found ? entry.place : outside, path, "", 0);
  if (!entry.found || entry.node.IsNull()) return;
  if (d.kind == Kind::map) {
    if (!entry.node.IsMap())
      return report(entry.place, path,
                    fmt::format("expected a mapping with one entry for each {}, found {}.", d.what,
                                kind_of(entry.node)));
    for (const auto& item : entry.node) {
      const std::string& name = item.first.Scalar();
      // Names of the mesh are not the user's to choose.
      if (d.what != "patch" && d.what != "zone" && name.find_first_of(",\"") != std::string::npos)
        report(place_of(item.first), join_path(path, name),
               "this name is used for columns in tables, so it must not contain a comma or a double quote.");
      read(item.second, place_of(item.first), join_path(path, name), name, 0);
    }
    return;
  }
  if (!entry.node.IsSequence())
    return report(entry.place, path,
                  fmt::format("expected a list of mappings, found {}.",
                              entry.node.IsMap() ? "a mapping" : kind_of(entry.node)));
  for (std::size_t i = 0; i < entry.node.size(); ++i)
    read(entry.node[i], place_of(entry.node[i]), fmt::format("{}[{}]", path, i), "", i);
}

void Loader::variant(const Declaration& d) {
  const KeyFacts& facts = d.facts;
  const std::string path = join_path(frames_.back().path, facts.name);
  const Word& declared = std::get<Word>(d.slot);
  const MapEntry entry = take(facts.name);
  std::string chosen = declared.current;
  if (entry.found || facts.required) {
    try {
      if (!entry.found) throw Error("{} ({}).", missing_key, one_of(declared.words));
      Word word = declared;
      word.set = [&](const std::string& text) {
        chosen = text;
        declared.set(text);
      };
      read_value(entry.node, {}, word);
    } catch (const Error& error) {
      report_key(entry.found ? entry.place : frames_.back().place, path,
                 entry.found ? wrong_value(entry.node, error.what()) : error.what());
      // The valid keys are unknown now, so all are treated as known, and only the actual mistake is reported.
      for (const auto& [text, declare] : d.cases)
        for (const std::string& key : names_of(declare)) frames_.back().known.push_back(key);
      return;
    }
  }
  Section section(visitor_);
  for (const auto& [text, declare] : d.cases) {
    if (text == chosen) {
      declare(section);
      continue;
    }
    for (const std::string& key : names_of(declare))
      frames_.back().elsewhere.emplace_back(key, fmt::format("{}: {}", facts.name, text));
  }
}

void Loader::apply_rule(const Declaration& d) {
  const Frame& frame = frames_.back();
  // The rule may depend on any key of the surrounding mappings.
  const bool wrong_key =
      std::any_of(frames_.begin(), frames_.end(), [](const Frame& f) { return f.wrong_key; });
  if (wrong_key || messages_.size() != frame.messages_before) return;
  std::string text = d.rule();
  if (text.empty()) return;
  if (text.back() != '.') text += '.';
  const std::string& key = d.facts.name;
  MapEntry entry{.found = true, .place = frame.place, .node = frame.node};
  for (const std::string& part : base::split(key, '.')) {
    const MapEntry next = find(entry.node, part);
    entry.found = next.found;
    if (!next.found) break;
    entry.place = next.place;
    entry.node.reset(next.node);
  }
  if (entry.found && entry.node.IsScalar()) text = wrong_value(entry.node, text.c_str());
  (d.kind == Declaration::Kind::check ? messages_ : doubts_)
      .push_back(message(entry.place, key.empty() ? frame.path : join_path(frame.path, key), text));
}

void Loader::report_mapping() {
  Frame& frame = frames_.back();
  if (!frame.mapping) return;
  frame.wrong_key = true;
  messages_.push_back(std::move(*frame.mapping));
  frame.mapping.reset();
}

void Loader::on(const Declaration& d) {
  const bool optional = d.kind == Declaration::Kind::optional;
  if (!optional || !std::ranges::count(frames_.back().known, d.facts.name)) report_mapping();
  switch (d.kind) {
    case Declaration::Kind::key:
      return key(d.facts, d.slot);
    case Declaration::Kind::variant:
      return variant(d);
    case Declaration::Kind::check:
    case Declaration::Kind::doubt:
      return apply_rule(d);
    default:
      return below(d);
  }
}

/// Node at a dotted path and the location of its key. If a part is missing, found is false, and the location
/// is that of the last existing mapping with path `reached`.
struct Located {
  MapEntry entry;
  std::string reached, missing;
  std::vector<std::string> present;
};

Located locate(const Document::Content& content, const std::string& path) {
  Located result;
  result.entry.found = true;
  result.entry.place.line = result.entry.place.column = 1;
  // Assigning one YAML::Node to another changes the tree, so reset() is required.
  result.entry.node.reset(content.root);
  if (path.empty()) return result;
  for (const std::string& part : base::split(path, '.')) {
    const MapEntry next = find(result.entry.node, part);
    result.entry.found = next.found;
    if (!next.found) {
      result.missing = part;
      result.present = key_names(result.entry.node);
      return result;
    }
    result.entry.place = next.place;
    result.entry.node.reset(next.node);
    result.reached = join_path(result.reached, part);
  }
  return result;
}

}  // namespace

std::vector<std::string> load(const Document& document, const std::string& path,
                              const Section::Declare& declare, const CheckExpression& check_expression,
                              std::vector<std::string>* doubts) {
  const Document::Content& content = document.content();
  if (content.root.IsNull()) return {fmt::format("{}:1:1: this file is empty.", content.name)};
  if (!content.root.IsMap())
    return {fmt::format("{}:1:1: expected a mapping (keys with values), found {}.", content.name,
                        content.root.IsSequence() ? "a list" : fmt::format("'{}'", content.root.Scalar()))};
  const Located located = locate(content, path);
  if (!located.entry.found) {
    const auto meant = base::closest(located.missing, located.present);
    const std::string text = meant ? fmt::format("this section is missing. Did you write '{}'?", *meant)
                                   : std::string("this section is missing.");
    return format_all(content.name,
                      {{located.entry.place, join_path(located.reached, located.missing), text}});
  }
  Loader reader(content, check_expression);
  reader.read_mapping(located.entry.node, located.entry.place, path, declare);
  if (doubts != nullptr) *doubts = format_all(content.name, reader.doubts());
  return format_all(content.name, reader.messages());
}

void load_or_throw(const Document& document, const std::string& path, const Section::Declare& declare) {
  const std::vector<std::string> messages = load(document, path, declare);
  if (!messages.empty()) throw Error(base::join(messages, "\n"));
}

std::vector<std::string> keys_of(const Document& document, const std::string& path) {
  const Located located = locate(document.content(), path);
  return located.entry.found ? key_names(located.entry.node) : std::vector<std::string>{};
}

std::optional<std::string> text_of(const Document& document, const std::string& path) {
  const Located located = locate(document.content(), path);
  if (!located.entry.found || !located.entry.node.IsScalar()) return std::nullopt;
  return located.entry.node.Scalar();
}

std::vector<std::string> texts_of(const Document& document, const std::string& path) {
  std::vector<std::string> texts;
  if (!document.content().root.IsMap()) return texts;
  const Located located = locate(document.content(), path);
  if (located.entry.found && located.entry.node.IsSequence())
    for (const YAML::Node& node : located.entry.node)
      if (node.IsScalar()) texts.push_back(node.Scalar());
  return texts;
}

std::string where(const Document& document, const std::string& path) {
  const Document::Content& content = document.content();
  Origin place = locate(content, path).entry.place;
  for (const auto& [changed, option] : content.overrides)
    if (is_below(path, changed)) place.override_text = option;
  std::string text = format(content.name, {place, path, ""});
  text.erase(text.size() - 2);
  return text;
}

}  // namespace couplet::config
